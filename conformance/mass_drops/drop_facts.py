"""Mass drop and line of a record, from the attributes of the file and its sidecar."""

from typing import Any

import numpy as np

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_record import DropDescription, DropLine

Attributes = dict[str, Any]
"""Attributes of a record, as in `MeasuredTable.attributes`."""


def build_drop(attributes: Attributes, where: str, duration: float) -> DropDescription:
    """Build the description of the mass drop of a record.

    Args:
        attributes: Attributes of the record.
        where: Name of the record in messages.
        duration: Duration of the record [s].

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


def build_line(attributes: Attributes, where: str) -> DropLine:
    """Build the description of the line of a record; `where` is the name of the record in messages.

    Raises:
        InputError: An attribute is not a number.
    """
    spans = np.atleast_1d(attributes.get("spans_m", ()))
    return DropLine(
        tuple(_convert_number(span, "spans_m", where) for span in spans),
        _read_number(attributes, "cw_tension_n", where),
        _read_number(attributes, "mw_tension_n", where),
    )


def _read_number(attributes: Attributes, name: str, where: str) -> float | None:
    value = attributes.get(name)
    return None if value is None else _convert_number(value, name, where)


def _convert_number(value: Any, name: str, where: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(
            f"{where}, attribute {name}", f"{str(value)[:40]!r} is not a number", "Write a number in file or sidecar."
        ) from None
