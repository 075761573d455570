"""Mass-drop record from a measured table and its sidecar: contradictions are refused, signals are converted to SI."""

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable, parse_direction
from pantocheck.conformance.input_files.units import MotionQuantity, convert_unit
from pantocheck.conformance.mass_drops.clipping import find_clipping
from pantocheck.conformance.mass_drops.column_descriptions import describe_columns
from pantocheck.conformance.mass_drops.drop_facts import build_drop, build_line
from pantocheck.conformance.mass_drops.drop_record import DropChannel, DropRecord
from pantocheck.conformance.mass_drops.drop_sidecar import DropSidecar
from pantocheck.conformance.mass_drops.sampling_rate import find_sampling_rate

LEAST_SAMPLES = 16
"""Smallest number of samples of a record."""
LARGEST_ACCELERATION = 500.0
"""Largest acceleration [m/s2]; a wire released from 40 kg stays an order of magnitude below."""


def assemble_drop_record(table: MeasuredTable, sidecar: DropSidecar | None) -> DropRecord:
    """Convert a measured table into a record in SI units.

    Args:
        table: One run.
        sidecar: Sidecar of the file; it adds data that the file lacks.

    Returns:
        Record with its warnings.

    Raises:
        InputError: File and sidecar contradict each other, a value is missing, or a unit or direction is not known.
    """
    n = table.values.shape[0]
    if n < LEAST_SAMPLES:
        raise InputError(
            table.where, f"holds only {n} samples", "Export the whole record, from rest to the end of the decay."
        )
    described = describe_columns(table, sidecar)
    rate = find_sampling_rate(table, sidecar)
    signals = np.empty((n, len(described)))
    channels, quantities, warnings = [], set[MotionQuantity](), list[str]()
    for c, (number, column) in enumerate(described):
        where = f"{table.where}, channel '{column.name}'"
        values = table.values[:, number - 1]
        _check_finite(values, rate, where)
        quantity, factor = convert_unit(column.unit or "", where)
        axis, sign = parse_direction(column.direction or "", where)
        signals[:, c] = values * (factor * sign)
        quantities.add(quantity)
        channels.append(DropChannel(column.name or "", column.sensor or 0, axis, column.wire.upper(), column.position))
        warnings += _check_signal(signals[:, c], quantity, rate, where)
    attributes = table.attributes | (sidecar.attributes if sidecar else {})
    name = str(attributes.get("test", "")) or table.source
    return DropRecord(
        name=f"{name} run {table.run}" if table.run else name,
        source=table.source,
        rate=rate,
        signals=signals,
        channels=tuple(channels),
        quantity=_find_quantity(quantities, sidecar, table.where),
        drop=build_drop(attributes, table.where, n / rate),
        line=build_line(attributes, table.where),
        warnings=tuple(warnings),
    )


def _check_finite(values: RealArray, rate: float, where: str) -> None:
    """Refuse missing values, because an identification needs every sample."""
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise InputError(
            where,
            f"has {bad.size} values that are not finite, the first at {bad[0] / rate:g} s",
            "Export the record again, or leave this channel out.",
        )


def _check_signal(signal: RealArray, quantity: MotionQuantity, rate: float, where: str) -> list[str]:
    """Refuse a constant signal; warn of clipping and of implausible accelerations."""
    if np.ptp(signal) == 0:
        raise InputError(where, "is constant", "Leave this channel out; its sensor did not work.")
    warnings = []
    tops = find_clipping(signal)
    if tops:
        warnings.append(
            f"{where}: clipped {len(tops)} times between {tops[0][0] / rate:.2f} s and {tops[-1][1] / rate:.2f} s"
        )
    if quantity == "acceleration" and float(np.abs(signal - np.median(signal)).max()) > LARGEST_ACCELERATION:
        warnings.append(f"{where}: implausible peak of {np.abs(signal).max():.3g} m/s2; check the unit")
    return warnings


def _find_quantity(quantities: set[MotionQuantity], sidecar: DropSidecar | None, where: str) -> MotionQuantity:
    """Common quantity of all channels, which must be that of the sidecar."""
    if len(quantities) > 1:
        raise InputError(
            where, f"holds channels of {' and '.join(sorted(quantities))}", "Write one file per measured quantity."
        )
    (quantity,) = quantities
    if sidecar is not None and sidecar.record.quantity not in (None, quantity):
        raise InputError(
            f"sidecar of {where}, key record.quantity",
            f"found '{sidecar.record.quantity}', but the units are those of {quantity}",
            "Correct the quantity, or the units of the channels.",
        )
    return quantity
