"""Heights of the contact wire at rest at the supports, from the data of the line alone."""

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.line_layout import SpanLayout, SupportLayout
from pantocheck.conformance.input_files.units import STANDARD_GRAVITY
from pantocheck.conformance.line.elements.tension_section import SectionRise


def rest_heights(case: Case, supports: RealArray) -> RealArray:
    """Height of the contact wire at rest at supports (n,) [m], above the datum of the line.

    An arm that carries its share holds the wire at its height. Below another arm, the wire hangs between the nearest
    droppers: the sag of a string, q a b / 2T, at the distances a and b from them. In an overlap of tension sections it
    is the height of the lowest wire. The irregularity of the contact wire is added. Where the wire hangs in droppers
    with a tolerance of their lengths, its height is unknown: nan.

    Args:
        case: Case of a record.
        supports: Positions of supports, (n,) [m].
    """
    line, layout = case.line, case.line.layout
    tolerance = line.has_varied_droppers
    sag = STANDARD_GRAVITY * line.contact_wire.mass_kg_m / (2 * line.contact_wire.tension_N)
    rises = [(place, line.section_rise(place)) for place in line.section_places]
    heights = [
        min(
            np.nan if tolerance and not _is_level(support) else _rest_height(support, before, after, sag, rise)
            for place, rise in rises
            if place.first < support.limit.number < place.last
        )
        for support, before, after in zip(layout.supports, layout.spans[:-1], layout.spans[1:], strict=True)
    ]
    places = np.array([support.limit.position for support in layout.supports])
    rest = np.array(heights)[np.abs(places[:, None] - supports).argmin(axis=0)]
    return np.asarray(rest + line.irregularity_at(supports))


def _rest_height(support: SupportLayout, before: SpanLayout, after: SpanLayout, sag: float, rise: SectionRise) -> float:
    """Height of the contact wire of a section at one support [m]; `sag` is q / 2T [1/m]."""
    if _is_level(support):
        return support.limit.contact_wire_height + rise(support.limit.position)
    ends = np.array([before.dropper_position[-1], after.dropper_position[0]])
    a, b = np.abs(ends - support.limit.position)
    levels = (before.contact_wire_height[-1], after.contact_wire_height[0])
    heights = [level + rise(x) for level, x in zip(levels, ends, strict=True)]
    return float(np.interp(support.limit.position, ends, heights) - sag * a * b)


def _is_level(support: SupportLayout) -> bool:
    """Whether the arm of a support carries its share, so that it holds the wire at its height."""
    return support.steady_arm.static_share == "level"
