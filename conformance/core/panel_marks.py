"""Parts of a figure as SVG: curves, areas and texts, placed in points from the upper left corner."""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from pantocheck.conformance.core.array_types import RealArray

FONT = "'DejaVu Sans'"
FLATNESS = 0.02
"""Largest distance of a left out point of a curve from its neighbours' chord, in each of three passes [pt]."""

DASHES = {"-": (), "--": (3.7, 1.6), "-.": (6.4, 1.6, 1.0, 1.6), ":": (1.0, 1.65)}
"""Dashes and gaps of a line style, in line widths."""

BASELINES = {"top": 0.76, "center": 0.38, "baseline": 0.0, "bottom": -0.24}
"""Distance of the baseline below the place of a text, as a share of the font size."""

LINE_DISTANCE = 1.16
"""Distance of two lines of a text, as a share of the font size."""

_END_ZEROS = re.compile(r"(?:\.00|(?<=\.\d)0)(?!\d)")
"""Zeros that `write_number` leaves out, in numbers with two decimals."""

Dash = str | tuple[float, tuple[float, ...]]
"""Line style: a key of `DASHES`, or an offset with dashes and gaps, in line widths."""


@dataclass(frozen=True)
class LineStyle:
    """Appearance of a curve and of its markers."""

    color: str
    linewidth: float = 1.0
    linestyle: Dash = "-"
    marker: str = ""
    markersize: float = 4.0
    markerfacecolor: str = ""
    """Empty: the colour of the curve."""

    def describe(self, opacity: float = 1.0) -> str:
        """Presentation attributes of the curve."""
        pattern = DASHES[self.linestyle] if isinstance(self.linestyle, str) else self.linestyle[1]
        dashes = ",".join(f"{part * self.linewidth:.4g}" for part in pattern)
        attributes = {"stroke-dasharray": dashes, "stroke-opacity": f"{opacity:g}" if opacity < 1 else ""}
        stated = "".join(f' {name}="{value}"' for name, value in attributes.items() if value)
        # Long caps would close the gaps of dashes.
        cap = "" if dashes else ' stroke-linecap="square"'
        return f'fill="none" stroke="{self.color}" stroke-width="{self.linewidth:g}"{stated}{cap}'


def write_number(value: float) -> str:
    """Coordinate [pt], to a hundredth of a point."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def write_path(x: RealArray, y: RealArray) -> str:
    """Path through points, thinned to the resolution of paper and broken where a value is not finite."""
    known = np.isfinite(x) & np.isfinite(y)
    breaks = np.flatnonzero(np.diff(known.astype(np.int8))) + 1
    parts = []
    for part in np.split(np.arange(x.size), breaks):
        if part.size and known[part[0]]:
            shown = thin_path(np.column_stack((x[part], y[part])))
            parts.append("M" + "L".join([f"{px:.2f} {py:.2f}" for px, py in shown.tolist()]))
    return _END_ZEROS.sub("", "".join(parts))


def thin_path(points: RealArray) -> RealArray:
    """Curve without points that lie on the chord of their neighbours within `FLATNESS`."""
    for _ in range(3):
        if len(points) < 3:
            break
        before, inner, after = points[:-2:2], points[1:-1:2], points[2::2]
        count = min(len(before), len(inner), len(after))
        before, inner, after = before[:count], inner[:count], after[:count]
        chord, offset = after - before, inner - before
        length = np.hypot(*chord.T)
        distance = np.abs(chord[:, 0] * offset[:, 1] - chord[:, 1] * offset[:, 0])
        share = np.einsum("ij,ij->i", chord, offset)
        flat = (distance <= FLATNESS * length) & (share >= 0) & (share <= length**2)
        kept = np.ones(len(points), dtype=bool)
        kept[1 : 2 * count : 2] = ~flat
        points = points[kept]
    return points


def write_area(x: Sequence[float], y: Sequence[float], style: str) -> str:
    """Closed area."""
    places = (f"{write_number(px)} {write_number(py)}" for px, py in zip(x, y, strict=True))
    return f'<path d="M{"L".join(places)}z" {style}/>'


def write_text(
    x: float,
    y: float,
    text: str,
    size: float,
    color: str,
    side: str = "left",
    level: str = "baseline",
    turned: bool = False,
) -> str:
    """Text at a place.

    Args:
        x, y: Place [pt].
        text: Text, whose lines are separated by line breaks.
        size: Font size [pt].
        color: Colour.
        side: Side of the text at the place: left, center or right.
        level: Level of the text at the place, a key of `BASELINES`.
        turned: Whether the text runs upwards; the place is that of its baseline.
    """
    anchor = {"left": "", "center": ' text-anchor="middle"', "right": ' text-anchor="end"'}[side]
    lines = text.split("\n")
    above = {"top": 0.0, "center": 0.5, "baseline": 0.0, "bottom": 1.0}[level] * (len(lines) - 1)
    first = y + size * (BASELINES[level] - LINE_DISTANCE * above)
    style = f'font-size="{size:g}px" font-family="{FONT}"{anchor} fill="{color}"'
    parts = []
    for number, line in enumerate(lines):
        place = write_number(x), write_number(first + number * LINE_DISTANCE * size)
        turn = f' transform="rotate(-90 {place[0]} {place[1]})"' if turned else ""
        parts.append(f'<text {style} x="{place[0]}" y="{place[1]}"{turn}>{escape(line, quote=False)}</text>')
    return "".join(parts)


def _list_corners(count: int, turn: float = 0.0, inner: float = 1.0) -> list[tuple[float, float]]:
    """Corners of a polygon on the unit circle from its top; every second one at the inner radius."""
    angles = [2 * math.pi * n / count + turn for n in range(count)]
    radii = [inner if n % 2 else 1.0 for n in range(count)] if inner < 1 else count * [1.0]
    return [(r * math.sin(a), -r * math.cos(a)) for a, r in zip(angles, radii, strict=True)]


_TRIANGLE = [(0.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
_PLUS = [(-1, -3), (1, -3), (1, -1), (3, -1), (3, 1), (1, 1), (1, 3), (-1, 3), (-1, 1), (-3, 1), (-3, -1), (-1, -1)]
MARKER_CORNERS: dict[str, list[tuple[float, float]]] = {
    "^": _TRIANGLE,
    "v": [(x, -y) for x, y in _TRIANGLE],
    "<": [(y, x) for x, y in _TRIANGLE],
    ">": [(-y, x) for x, y in _TRIANGLE],
    "s": [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)],
    "D": [(0.0, -1.414), (1.414, 0.0), (0.0, 1.414), (-1.414, 0.0)],
    "d": [(0.0, -1.414), (0.85, 0.0), (0.0, 1.414), (-0.85, 0.0)],
    "p": _list_corners(5),
    "h": _list_corners(6),
    "P": [(x / 3, y / 3) for x, y in _PLUS],
    "X": [((x - y) / 4, (x + y) / 4) for x, y in _PLUS],
    "*": _list_corners(10, inner=0.382),
}
"""Corners of the markers with corners, for a size of 2; the names are those of matplotlib."""


def write_markers(places: Iterable[tuple[float, float]], style: LineStyle) -> str:
    """Markers at places [pt]."""
    face, half = style.markerfacecolor or style.color, style.markersize / 2
    look = f'fill="{face}" stroke="{style.color}" stroke-width="1"'
    parts = []
    for x, y in places:
        if style.marker == "o":
            parts.append(f'<circle cx="{write_number(x)}" cy="{write_number(y)}" r="{half:g}" {look}/>')
        else:
            corners = MARKER_CORNERS[style.marker]
            parts.append(write_area([x + half * a for a, _ in corners], [y + half * b for _, b in corners], look))
    return "".join(parts)
