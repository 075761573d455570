"""Margin of a value drawn as a bar: its place between the limits.

  outside   |      inside      |   outside
------------|========+---O-----|------------
          lower    middle    upper

A filled disc is inside the limits, a cross is outside, an open ring does not count; the shapes differ without colour.
A value beyond the drawing is an arrow at its edge. The whisker is the error of the value.
"""

from collections.abc import Iterator, Sequence
from typing import TypeVar

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.look import read_look

WIDTH, HEIGHT = 100.0, 18.0
MIDDLE = HEIGHT / 2
_LOOK = read_look()
INK, PAPER = _LOOK["light"]["ink"], _LOOK["light"]["paper"]
GREY, LIMIT_FILL = _LOOK["figure"]["grey"], _LOOK["figure"]["limit"]
# Distance of a limit from the middle, as a share of half the width.
BAR_REACH = 0.56
# A value closer to an edge is drawn as an arrow.
EDGE = 6.0
# Width of a column of the strip of a sample.
STRIP_WIDTH = 2.0

_Real = TypeVar("_Real", float, RealArray)


def draw_margin_bar(
    value: float,
    lower: float | None,
    upper: float | None,
    error: float | None,
    verdict: str,
    draws: Sequence[float] = (),
) -> str:
    """SVG of the bar without text.

    Args:
        value: Graded value.
        lower, upper: Limits.
        error: Half of the length of the whisker.
        verdict: Verdict, which selects the marker.
        draws: Joint sample, whose strip lies under the bar.
    """
    centre, half = _scale(lower, upper)

    def across(x: _Real) -> _Real:
        place: _Real = WIDTH / 2 * (1 + BAR_REACH * (x - centre) / half)
        return place

    left = 0.0 if lower is None else across(lower)
    right = WIDTH if upper is None else across(upper)
    parts = [
        f'<line x1="0" y1="{MIDDLE:g}" x2="{WIDTH:g}" y2="{MIDDLE:g}" stroke="{GREY}" stroke-width="1"/>',
        f'<rect x="{left:.2f}" y="4" width="{max(right - left, 0):.2f}" height="{HEIGHT - 8:g}" fill="{LIMIT_FILL}"/>',
    ]
    parts += [
        f'<line x1="{x:.2f}" y1="1" x2="{x:.2f}" y2="{HEIGHT - 1:g}" stroke="{INK}" stroke-width="1.6"/>'
        for limit, x in ((lower, left), (upper, right))
        if limit is not None
    ]
    x = across(value)
    if error and EDGE <= x <= WIDTH - EDGE:
        low, high = max(across(value - error), 0), min(across(value + error), WIDTH)
        whisker = f"M{low:.2f} {MIDDLE:g}H{high:.2f}M{low:.2f} 6V12M{high:.2f} 6V12"
        parts.append(f'<path d="{whisker}" stroke="{INK}" stroke-width="1"/>')
    parts += _list_strip(across(np.array(draws)))
    parts.append(_marker(x, verdict))
    size = f'viewBox="0 0 {WIDTH:g} {HEIGHT:g}" width="{WIDTH:g}" height="{HEIGHT:g}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{"".join(parts)}</svg>'


def _list_strip(places: RealArray) -> Iterator[str]:
    """Strip of a sample under the bar: columns whose darkness is their share of the largest column."""
    columns, counts = np.unique(np.rint(np.clip(places, 0.0, WIDTH) / STRIP_WIDTH), return_counts=True)
    for column, count in zip(columns.tolist(), counts.tolist(), strict=True):
        x, shade = column * STRIP_WIDTH - STRIP_WIDTH / 2, max(count / counts.max(), 0.1)
        yield (
            f'<rect x="{x:g}" y="{HEIGHT - 3:g}" width="{STRIP_WIDTH:g}" height="3" fill="{INK}" '
            f'fill-opacity="{shade:.2f}"/>'
        )


def _scale(lower: float | None, upper: float | None) -> tuple[float, float]:
    """Middle of the drawing and the distance that fills `BAR_REACH` of its half, in the unit of the quantity."""
    if lower is not None and upper is not None:
        return (lower + upper) / 2, (upper - lower) / 2 or max(abs(lower), 1.0)
    if upper is not None:
        return upper - (abs(upper) or 1.0), abs(upper) or 1.0
    return (0.0, 1.0) if lower is None else (lower + (abs(lower) or 1.0), abs(lower) or 1.0)


def _marker(x: float, verdict: str) -> str:
    ink = read_look()["light-verdict"][verdict] if verdict in ("pass", "fail") else INK
    if x < EDGE:
        return f'<path d="M1 {MIDDLE:g}l9 -6v12z" fill="{ink}"/>'
    if x > WIDTH - EDGE:
        return f'<path d="M{WIDTH - 1:g} {MIDDLE:g}l-9 -6v12z" fill="{ink}"/>'
    if verdict == "fail":
        cross = f"M{x - 4.5:.2f} {MIDDLE - 4.5:g}l9 9m0 -9l-9 9"
        return f'<path d="{cross}" stroke="{ink}" stroke-width="2.6" fill="none"/>'
    fill, edge = (ink, PAPER) if verdict == "pass" else (PAPER, ink)
    return f'<circle cx="{x:.2f}" cy="{MIDDLE:g}" r="4.5" fill="{fill}" stroke="{edge}" stroke-width="1.4"/>'
