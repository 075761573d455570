"""Catenary of the reference simulator from a line file."""

from pantocheck.conformance.line.elements.element_registry import ELEMENTS
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_layout import LineLayout
from pantocheck.model import Catenary


def build_catenary(line: LineFile) -> Catenary:
    """Catenary of a line file.

    Args:
        line: Content of the line file.

    Raises:
        NoInitialState: The varied line has no equilibrium.
    """
    layout = line.layout
    sections = [
        _build_section(line.section_file(place), layout.part(place.first, place.last)) for place in line.section_places
    ]
    catenary = line.join_line(sections)
    for element in ELEMENTS:
        catenary = element.add_to_line(line, catenary)
    for element in ELEMENTS:
        catenary = element.complete_line(line, catenary)
    return catenary


def _build_section(line: LineFile, layout: LineLayout) -> Catenary:
    """Tension section of a line between the first and the last span limit of a layout."""
    catenary = Catenary(wires=())
    for element in ELEMENTS:
        catenary = element.add_to_section(line, catenary, layout)
    return catenary
