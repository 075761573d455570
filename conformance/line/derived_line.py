"""Derived values of a line at rest, from its fine finite elements; the elements define and compute them."""

from typing import Annotated, Any

from pydantic import Field, create_model

from pantocheck.conformance.core.sourced_table import InputTable, is_absent
from pantocheck.conformance.line.elements.derived_numbers import Numbers, round_positions
from pantocheck.conformance.line.elements.element import BuiltSection
from pantocheck.conformance.line.elements.element_registry import ELEMENTS
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import DiscretisedLine
from pantocheck.model.description.catenary import GRAVITY


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
