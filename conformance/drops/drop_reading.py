"""Reading of mass-drop records in any format of `TABLE_FORMATS`."""

from contextlib import suppress
from dataclasses import replace
from decimal import Decimal
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn, parse_direction, read_tables
from pantocheck.conformance.core.spreadsheet import read_spreadsheet
from pantocheck.conformance.core.table_sidecar import locate_table, read_sidecar
from pantocheck.conformance.core.toml_file import validate_model
from pantocheck.conformance.core.units import MotionQuantity, convert_unit
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord, find_sampling_rate
from pantocheck.conformance.drops.drop_sidecar import DropChannelTable, DropSidecar, describe_columns
from pantocheck.conformance.line.line_columns import read_typed_rows
from pantocheck.conformance.records.force_checks import find_clipping
from pantocheck.conformance.results.identified_modes import MeasuredLine

LARGEST_DROP = 30_000_000
"""Largest number of values in a record: 20 channels at 1 kHz for 25 minutes. Reading them takes about 1 GB."""


def read_drop_records(path: Path) -> tuple[DropRecord, ...]:
    """Read all runs of a file.

    Args:
        path: File in one of the formats of `TABLE_FORMATS`, with or without a sidecar of the same stem.

    Raises:
        InputError: The file cannot be read, is damaged, or does not describe its channels.
    """
    sidecar, table = _read_drop_sidecar(path) if path.with_suffix(".toml").is_file() else (None, path)
    names, layout = (sidecar.channel_names, sidecar.table) if sidecar else ((), None)
    tables = read_tables(table, names, LARGEST_DROP, layout=layout)
    file = str(table.resolve())
    return tuple(replace(assemble_drop_record(run.separate_time(), sidecar), file=file) for run in tables)


SENSOR_SHEET = "sensors"
"""Name of the table of channels in a workbook with several sheets."""


def _read_drop_sidecar(path: Path) -> tuple[DropSidecar, Path]:
    """Sidecar with its channels, those of `channel_file` included, and the table of the record."""
    sidecar, table = read_sidecar(path, DropSidecar)
    if sidecar.channel_file is None:
        return sidecar, table
    sheet = read_spreadsheet(locate_table(path.with_suffix(".toml"), sidecar.channel_file, None), SENSOR_SHEET)
    problems, channels = list[InputError](), list[DropChannelTable]()
    for row in read_typed_rows(sheet, tuple(DropChannelTable.model_fields), problems):
        tree = {key: float(value) if isinstance(value, Decimal) else value for key, value in row.values.items()}
        try:
            channels.append(validate_model(tree, DropChannelTable, row.place))
        except InputError as error:
            problems += error.problems
    if problems:
        raise join_errors(problems)
    return sidecar.model_copy(update={"channel": tuple(channels)}), table


# Mass-drop record from a measured table and its sidecar: contradictions are refused, signals are converted to SI.
FORCE_UNITS = {"N": 1.0, "kN": 1e3}
"""Units of a force channel, in newtons."""
LEAST_SAMPLES = 16
"""Smallest number of samples of a record."""
LARGEST_ACCELERATION = 500.0
"""Largest acceleration [m/s2]; a wire released from 40 kg stays an order of magnitude below."""


def assemble_drop_record(table: MeasuredTable, sidecar: DropSidecar | None) -> DropRecord:
    """Convert a measured table into a record in SI units; its sidecar adds data that the file lacks.

    Raises:
        InputError: File and sidecar contradict each other, a value is missing, or a unit or direction is not known.
    """
    n = table.values.shape[0]
    if n < LEAST_SAMPLES:
        raise InputError(
            table.where, f"holds only {n} samples", "Export the whole record, from rest to the end of the decay."
        )
    rate = find_sampling_rate(table, sidecar)
    described, force = _separate_force(describe_columns(table, sidecar), table, rate)
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
        shared_clock=None if (shared := attributes.get("shared_clock")) is None else bool(shared),
        force=force,
    )


def _separate_force(
    described: list[tuple[int, TableColumn]], table: MeasuredTable, rate: float
) -> tuple[list[tuple[int, TableColumn]], RealArray | None]:
    """Columns of motion, and the force of a hammer or shaker [N], positive upward; None without a column of force.

    Raises:
        InputError: There are several forces, or nothing but forces.
    """
    forces = [(number, column) for number, column in described if (column.unit or "").strip() in FORCE_UNITS]
    motions = [(number, column) for number, column in described if (number, column) not in forces]
    if len(forces) > 1 or not motions:
        fault = f"has {len(forces)} channels of force and {len(motions)} of motion"
        raise InputError(table.where, fault, "Give one force at most, and the motion of the line.")
    if not forces:
        return motions, None
    (number, column), where = forces[0], f"{table.where}, channel '{forces[0][1].name}'"
    values = table.values[:, number - 1]
    _check_finite(values, rate, where)
    _, sign = parse_direction(column.direction or "", where)
    return motions, values * (FORCE_UNITS[(column.unit or "").strip()] * sign)


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
        raise InputError(where, "is constant", "Leave this channel out; its sensor failed.")
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


# Mass drop and line of a record, from the attributes of the file and its sidecar.
Attributes = dict[str, Any]
"""Attributes of a record, as in `MeasuredTable.attributes`."""


def build_drop(attributes: Attributes, where: str, duration: float) -> DropDescription:
    """Build the description of the mass drop of a record of a duration [s]; `where` is its name in messages.

    Raises:
        InputError: An attribute is not a number, or the planned release is after the end of the record.
    """
    drop = DropDescription(
        _read_number(attributes, "drop_mass_kg", where),
        str(attributes.get("drop_wire", "")).upper(),
        _read_number(attributes, "drop_position_m", where),
        _read_number(attributes, "trigger_nominal_s", where),
    )
    if drop.trigger_nominal is not None and drop.trigger_nominal >= duration:
        raise InputError(
            where,
            f"the planned release at {drop.trigger_nominal:g} s is after the end of the record at {duration:g} s",
            "Export the whole record, or correct trigger_nominal_s.",
        )
    return drop


def build_line(attributes: Attributes, where: str) -> MeasuredLine:
    """Build the description of the line of a record; `where` is the name of the record in messages.

    Raises:
        InputError: An attribute is not a number.
    """
    spans = np.atleast_1d(attributes.get("spans_m", ()))
    return MeasuredLine(
        spans_m=tuple(_convert_number(span, "spans_m", where) for span in spans),
        contact_wire_tension_N=_read_number(attributes, "cw_tension_n", where),
        messenger_wire_tension_N=_read_number(attributes, "mw_tension_n", where),
    )


def _read_number(attributes: Attributes, name: str, where: str) -> float | None:
    value = attributes.get(name)
    return None if value is None else _convert_number(value, name, where)


def _convert_number(value: Any, name: str, where: str) -> float:
    with suppress(TypeError, ValueError):
        if isfinite(number := float(value)):
            return number
    raise InputError(
        f"{where}, attribute {name}", f"{str(value)[:40]!r} is not a number", "Write a number in file or sidecar."
    )
