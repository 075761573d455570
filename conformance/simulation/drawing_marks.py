"""Points in the drawing of a line: point masses of the line, sensors and dropped masses of a case."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.drop_test import MassDrop
from pantocheck.model import Catenary, Kind


@dataclass(frozen=True)
class DrawnMark:
    """Point on a wire with a text beside it.

    Parameters
    ----------
    symbol : {"sensor", "mass"}
        Kind of the point.
    wire : str
        Name of the wire.
    position : float
        Position along the line [m].
    text : str
        Text beside the point.
    """

    symbol: Literal["sensor", "mass"]
    wire: str
    position: float
    text: str


def list_point_masses(catenary: Catenary) -> tuple[DrawnMark, ...]:
    """Point masses of a line."""
    return tuple(DrawnMark("mass", part.wire, part.position, f"{part.mass:g} kg") for part in catenary.point_masses)


def list_marks(case: Case, catenary: Catenary) -> tuple[DrawnMark, ...]:
    """Point masses of a line, and sensors and dropped masses of its case, numbered from 1 as in its file."""
    fixed = list_point_masses(catenary)
    return (*fixed, *(_list_drop_marks(case.file.mass_drop, catenary) if case.file.mass_drop is not None else ()))


def _list_drop_marks(drops: MassDrop, catenary: Catenary) -> Iterator[DrawnMark]:
    for number, sensor in enumerate(drops.sensor, 1):
        yield DrawnMark("sensor", _find_wire(catenary, sensor.wire, sensor.x_m), sensor.x_m, f"S{number}")
    for number, drop in enumerate(drops.drop, 1):
        text = f"drop {number}: {drop.mass_kg:g} kg"
        yield DrawnMark("mass", _find_wire(catenary, drop.wire, drop.x_m), drop.x_m, text)


def _find_wire(catenary: Catenary, name: str, position: float) -> str:
    """First wire of a kind, named as in a case file, at a position."""
    kind = Kind.CONTACT_WIRE if name == "contact_wire" else Kind.MESSENGER_WIRE
    return next(w.name for w in catenary.wires if w.kind is kind and w.start <= position <= w.end)
