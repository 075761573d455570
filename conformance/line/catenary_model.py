"""Catenary of the reference simulator from a line file, its finite elements, and its derived values at rest."""

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Annotated, Any

from pydantic import Field, create_model

from pantocheck.conformance.core.sourced_table import InputTable, is_absent
from pantocheck.conformance.line.elements.derived_numbers import Numbers, round_positions
from pantocheck.conformance.line.elements.element import BuiltSection
from pantocheck.conformance.line.elements.element_registry import ELEMENTS
from pantocheck.conformance.line.elements.line_layout import LineLayout
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import Catenary, DiscretisedLine, discretise
from pantocheck.model.description.catenary import GRAVITY


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


# Derived values of a line at rest, from its fine finite elements; the elements define and compute them.
class SectionLimits(InputTable):
    """Anchors and supports of a tension section; the keys of the elements follow."""

    span_limits_m: Numbers
    """Positions of both anchors, and of the supports between them [m]."""


_KEYS: dict[str, Any] = {key: content for element in ELEMENTS for key, content in element.derived.items()}
DerivedSection: Any = create_model(
    "DerivedSection",
    __base__=SectionLimits,
    __doc__="Tension section at rest: its wires and the parts on them.",
    **_KEYS,
)


class DerivedLine(DerivedSection):
    """Line at rest: x counts from the first anchor, y from the centre line, z from the datum of the line."""

    gravity_m_s2: float
    """Acceleration of gravity [m/s2]."""
    origin_x_m: float = 0.0
    """Position of the first anchor of the line [m]."""
    zero_height_m: float = 0.0
    """Datum of all heights [m]; on a level line the height of the contact wire at anchors, and at supports whose arm
    keeps it level.
    """
    further_sections: Annotated[tuple[DerivedSection, ...], Field(strict=False, exclude_if=is_absent)] = ()
    """Every tension section behind the first one, in running order; the tables beside this key hold for the first.
    Absent: one section.
    """


def build_derived_line(file: LineFile, line: DiscretisedLine) -> DerivedLine:
    """Derived values of a line.

    Args:
        file: Content of the line file.
        line: Its finite elements.
    """
    first, *further = (_derive_section(part, section) for part, section in file.divide_line(line))
    return DerivedLine(**dict(first), gravity_m_s2=GRAVITY, further_sections=tuple(further))


def _derive_section(part: LineFile, section: BuiltSection) -> Any:
    """Derived values of one tension section, for the line file with its wires."""
    values: dict[str, Any] = {"span_limits_m": round_positions(section.limits)}
    for element in ELEMENTS:
        values |= element.derive(part, section)
    return DerivedSection(**values)
