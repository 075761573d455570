"""Points in the drawing of a line: those of its elements, sensors and dropped masses of a case."""

from pantocheck.conformance.line.elements.element import DrawnMark
from pantocheck.conformance.simulation.drawn_points import list_element_marks
from pantocheck.model import Catenary


def list_labelled_marks(catenary: Catenary) -> tuple[DrawnMark, ...]:
    """Points of the elements of a line that have a text."""
    return tuple(mark for mark in list_element_marks(catenary) if mark.text)
