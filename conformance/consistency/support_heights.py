"""Heights of the contact wire at rest at the supports, from the data of the line alone."""

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.line_layout import SpanLayout, SupportLayout
from pantocheck.conformance.input_files.units import STANDARD_GRAVITY


def rest_heights(case: Case, supports: RealArray) -> RealArray:
    """Height of the contact wire at rest at supports (n,) [m], above the datum of the line.

    An arm that carries its share holds the wire at its height. Below another arm, the wire hangs between the nearest
    droppers: the sag of a string, q a b / 2T, at the distances a and b from them.

    Parameters
    ----------
    case : Case
        Case of a record.
    supports : (n,) ndarray
        Positions of supports [m].
    """
    layout = case.line.layout
    sag = STANDARD_GRAVITY * case.line.contact_wire.mass_kg_m / (2 * case.line.contact_wire.tension_N)
    spans = zip(layout.supports, layout.spans[:-1], layout.spans[1:], strict=True)
    heights = np.array([_rest_height(*span, sag) for span in spans])
    places = np.array([support.limit.position for support in layout.supports])
    return np.asarray(heights[np.abs(places[:, None] - supports).argmin(axis=0)])


def _rest_height(support: SupportLayout, before: SpanLayout, after: SpanLayout, sag: float) -> float:
    """Height of the contact wire at one support [m]; `sag` is q / 2T [1/m]."""
    if support.steady_arm.static_share == "level":
        return support.limit.contact_wire_height
    ends = np.array([before.dropper_position[-1], after.dropper_position[0]])
    a, b = np.abs(ends - support.limit.position)
    heights = [before.contact_wire_height[-1], after.contact_wire_height[0]]
    return float(np.interp(support.limit.position, ends, heights) - sag * a * b)
