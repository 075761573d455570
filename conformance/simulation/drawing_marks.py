"""Points in the drawing of a line: those of its elements, sensors and dropped masses of a case."""

from collections.abc import Iterator

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.drop_test import MassDrop
from pantocheck.conformance.line.elements.element import KINDS, DrawnMark
from pantocheck.conformance.simulation.drawn_points import list_element_marks
from pantocheck.model import Catenary


def list_labelled_marks(catenary: Catenary) -> tuple[DrawnMark, ...]:
    """Points of the elements of a line that have a text."""
    return tuple(mark for mark in list_element_marks(catenary) if mark.text)


def list_marks(case: Case, catenary: Catenary) -> tuple[DrawnMark, ...]:
    """Masses of a line, and sensors and dropped masses of its case, numbered from 1 as in its file."""
    drops = case.file.mass_drop
    return (*list_labelled_marks(catenary), *(() if drops is None else _list_drop_marks(drops, catenary)))


def _list_drop_marks(drops: MassDrop, catenary: Catenary) -> Iterator[DrawnMark]:
    for number, sensor in enumerate(drops.sensor, 1):
        yield DrawnMark("sensor", _find_wire(catenary, sensor.wire, sensor.x_m), sensor.x_m, f"S{number}")
    for number, drop in enumerate(drops.drop, 1):
        text = f"drop {number}: {drop.mass_kg:g} kg"
        yield DrawnMark("mass", _find_wire(catenary, drop.wire, drop.x_m), drop.x_m, text)


def _find_wire(catenary: Catenary, name: str, position: float) -> str:
    """First wire of a kind, named as in a case file, at a position."""
    return next(w.name for w in catenary.wires if w.kind is KINDS[name] and w.start <= position <= w.end)
