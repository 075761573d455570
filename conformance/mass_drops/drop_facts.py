"""Facts about a mass drop and its line, from the attributes of the file and the sidecar."""

from typing import Any

import numpy as np

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable
from pantocheck.conformance.mass_drops.drop_record import DropDescription, DropLine, DropRecord
from pantocheck.conformance.mass_drops.drop_sidecar import DropSidecar

Attributes = dict[str, Any]


def merge_attributes(table: MeasuredTable, sidecar: DropSidecar | None) -> Attributes:
    """Attributes of the file, replaced by those of the sidecar where it has them."""
    return table.attributes | (sidecar.attributes if sidecar else {})


def build_drop(attributes: Attributes, where: str, duration: float) -> DropDescription:
    """Mass drop of a record of a duration [s].

    Raises
    ------
    InputError
        An attribute is not a number, or the trigger lies behind the end of the record.
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
            f"the trigger is at {drop.trigger_nominal:g} s, the record ends at {duration:g} s",
            "The record is cut short, or the trigger time belongs to another one.",
        )
    return drop


def build_line(attributes: Attributes, where: str) -> DropLine:
    """Line of a record.

    Raises
    ------
    InputError
        An attribute is not a number.
    """
    spans = np.atleast_1d(attributes.get("spans_m", ()))
    return DropLine(
        tuple(_convert_number(span, "spans_m", where) for span in spans),
        _read_number(attributes, "cw_tension_n", where),
        _read_number(attributes, "mw_tension_n", where),
    )


def list_attributes(record: DropRecord) -> Attributes:
    """Attributes of a record, those that are known."""
    attributes = {
        "test": record.name,
        "quantity": record.quantity,
        "sampling_rate_hz": record.rate,
        "drop_mass_kg": record.drop.mass,
        "drop_wire": record.drop.wire,
        "drop_position_m": record.drop.position,
        "trigger_nominal_s": record.drop.trigger_nominal,
        "spans_m": list(record.line.spans) or None,
        "cw_tension_n": record.line.contact_wire_tension,
        "mw_tension_n": record.line.messenger_wire_tension,
    }
    return {name: value for name, value in attributes.items() if value is not None}


def _read_number(attributes: Attributes, name: str, where: str) -> float | None:
    value = attributes.get(name)
    return None if value is None else _convert_number(value, name, where)


def _convert_number(value: Any, name: str, where: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(
            f"{where}, attribute {name}", f"{str(value)[:40]!r} is not a number", "Correct it in the file or a sidecar."
        ) from None
