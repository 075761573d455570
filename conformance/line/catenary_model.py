"""Catenary of the reference simulator from a line file, and its finite elements."""

from dataclasses import dataclass, field
from functools import lru_cache

from pantocheck.conformance.line.elements.element_registry import ELEMENTS
from pantocheck.conformance.line.elements.line_layout import LineLayout
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import Catenary, DiscretisedLine, discretise


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


# Cases on one line share its finite elements, with everything that does not depend on the train.
KEPT_LINES = 4
"""Lines kept in memory: one line on the three meshes of a case, and its shortened copy for the natural frequencies."""


@dataclass(frozen=True)
class _Content:
    """Line file that equals another one with the same content."""

    text: str
    line: LineFile = field(compare=False)


def discretise_line(line: LineFile, element: float) -> DiscretisedLine:
    """Discretise a line; the last lines are kept.

    Args:
        line: Content of the line file.
        element: Largest length of an element [m].

    Returns:
        Line at rest.

    Raises:
        NoInitialState: The prescribed geometry has no equilibrium.
    """
    return _discretise(_Content(line.model_dump_json(), line), element)


@lru_cache(KEPT_LINES)
def _discretise(content: _Content, element: float) -> DiscretisedLine:
    return discretise(build_catenary(content.line), element)
