"""Recorded mass drop: its mass, wire and position on a line, and its vertical channels."""

from dataclasses import dataclass

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_record import DropChannel, DropRecord
from pantocheck.conformance.drops.line_comparison import compare_record_line, list_differences
from pantocheck.conformance.drops.mode_matching import KIND_OF_WIRE, find_wire
from pantocheck.conformance.results.damping_format import LineComparison
from pantocheck.model import Catenary


@dataclass(frozen=True)
class RecordedDrop:
    """Record of a drop whose line is that of a model."""

    record: DropRecord
    columns: tuple[int, ...]
    """Indices of the vertical channels."""
    mass: float
    """Dropped mass [kg]."""
    wire: str
    """Wire with the mass, as in the record."""
    position: float
    """Position of the mass [m]."""
    line: LineComparison
    """Line of the record beside the line of the model."""
    places: tuple[tuple[str, float], ...]
    """Wire of the model and position of each vertical channel, then of the mass [-, m]."""

    @property
    def channels(self) -> tuple[DropChannel, ...]:
        """Vertical channels."""
        return tuple(self.record.channels[c] for c in self.columns)


def locate_drop(record: DropRecord, catenary: Catenary) -> RecordedDrop:
    """Find mass and sensors of a record on a line.

    Args:
        record: The record.
        catenary: Line of the model.

    Returns:
        Drop on this line.

    Raises:
        InputError: Mass, wire or position is missing or not on the line, no channel is vertical, or the line of the
            record is another one.
    """
    where, drop = f"record '{record.source}'", record.drop
    columns = record.along("z")
    if not columns:
        raise InputError(where, "has no vertical channel", "Give the direction +z or -z to the vertical channels.")
    if drop.mass is None or drop.mass <= 0:
        raise InputError(f"{where}, key drop.mass_kg", _describe_missing(drop.mass), "Give the dropped mass [kg].")
    if drop.position is None:
        raise InputError(
            f"{where}, key drop.position_m", "missing", "Give the position of the mass from the first support [m]."
        )
    channels = [record.channels[c] for c in columns]
    line = compare_record_line(record.line, [(c.sensor, c.wire, c.position) for c in channels], catenary)
    if line.differences:
        raise InputError(
            where,
            f"the line of the record is not that of --line: {list_differences(line.differences)}",
            "Name the line of the record with --line, or correct the sidecar of the record.",
        )
    places = [_find_place(f"{where}, channel '{c.name}'", "position_m", c.wire, c.position, catenary) for c in channels]
    places.append(_find_place(where, "drop.position_m", drop.wire, drop.position, catenary))
    return RecordedDrop(record, columns, drop.mass, drop.wire, drop.position, line, tuple(places))


def _describe_missing(value: float | None) -> str:
    return "missing" if value is None else f"{value:g} is not positive"


def _find_place(where: str, key: str, wire: str, position: float | None, catenary: Catenary) -> tuple[str, float]:
    """Wire of the model and position of a sensor or mass; `key` is that of the position in the sidecar."""
    if wire not in KIND_OF_WIRE:
        raise InputError(
            f"{where}, key {key.replace('position_m', 'wire')}",
            f"found {wire[:40]!r}" if wire else "missing",
            "Give CW (contact wire) or MW (messenger wire).",
        )
    if position is None:
        raise InputError(f"{where}, key {key}", "missing", "Give the position from the first support [m].")
    found = find_wire(catenary, KIND_OF_WIRE[wire], position)
    if found is None:
        raise InputError(
            f"{where}, key {key}", f"no wire {wire} at {position:g} m", "Give the position from the first support [m]."
        )
    return found.name, position
