"""Drawing of the spans around the analysis section, as curves and points for results.json."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.results.figure_data import DrawnCurve, DrawnDroppers, DrawnPoint, DrawnView, LineShape
from pantocheck.conformance.simulation.drawn_points import find_deflection, list_connections, list_element_marks
from pantocheck.model import DiscretisedLine

MOST_DRAWN_SPANS = 24
"""Largest number of spans that are drawn: a span is then 6 mm long on paper."""

THINNING_M = 0.0005
"""Largest distance of a wire from its drawn polygon per drawn span [m]: the more spans, the narrower is each of them.

At most 12 mm; a drawing of 2 m height has 28 mm per typographic point."""


@dataclass(frozen=True)
class _Window:
    """Number of spans of a line between two positions [m]."""

    line: DiscretisedLine
    spans: int
    start: float
    end: float

    def contains(self, position: float) -> bool:
        return self.start - 1e-6 <= position <= self.end + 1e-6


def build_line_shape(case: Case, line: DiscretisedLine) -> LineShape:
    """Shape of a line at rest over the spans of the analysis section and one span on either side.

    Args:
        case: Case of the line.
        line: Line at rest.
    """
    geometry, (first, last) = case.line.geometry, case.analysed_spans
    first = max(first - 1, 1)
    last = min(last + 1, geometry.spans, first + MOST_DRAWN_SPANS - 1)
    window = _Window(line, last - first + 1, *geometry.section(first, last))
    return LineShape(
        title=case.line.title,
        first_span=first,
        last_span=last,
        supports_m=[round(x, 2) for x in geometry.span_limits if window.contains(x)],
        side=_build_view(window, "z"),
        plan=_build_view(window, "y") if line.catenary.has_lateral_field else None,
    )


def _build_view(window: _Window, field: str) -> DrawnView:
    line = window.line
    connections = [part for part in list_connections(line.catenary) if window.contains(part.position)]
    return DrawnView(
        curves=list(_list_curves(window, field)),
        droppers=DrawnDroppers(
            x_m=[round(part.position, 2) for part in connections],
            lower_m=[_deflection(window, part.lower, field, part.position) for part in connections],
            upper_m=[_deflection(window, part.upper, field, part.position) for part in connections],
        ),
        points=list(_list_points(window, field)),
    )


def _list_curves(window: _Window, field: str) -> Iterator[DrawnCurve]:
    for wire in window.line.catenary.wires:
        start, end = max(wire.start, window.start), min(wire.end, window.end)
        position = window.line.mesh.position
        x = position[(position >= start - 1e-6) & (position <= end + 1e-6)]
        if x.size > 1:
            w = find_deflection(window.line, wire.name, field, x)
            kept = thin_curve(x, w, window.spans * THINNING_M)
            yield DrawnCurve(
                kind=wire.kind.value,
                x_m=[round(float(value), 2) for value in x[kept]],
                y_m=[round(float(value), 3) for value in w[kept]],
            )


def _list_points(window: _Window, field: str) -> Iterator[DrawnPoint]:
    for mark in list_element_marks(window.line.catenary):
        if window.contains(mark.position):
            y = _deflection(window, mark.wire, field, mark.position)
            yield DrawnPoint(symbol=mark.symbol, x_m=round(mark.position, 2), y_m=y, text=mark.text)


def _deflection(window: _Window, wire: str, field: str, position: float) -> float:
    return round(float(find_deflection(window.line, wire, field, position)), 3)


def thin_curve(x: RealArray, y: RealArray, tolerance: float) -> RealArray:
    """Indices of the corners of a polygon that leaves a curve by no more than a tolerance (Douglas and Peucker, 1973).

    Args:
        x, y: Points of the curve, with rising x.
        tolerance: Largest difference in y.
    """
    kept, parts = {0, x.size - 1}, [(0, x.size - 1)]
    while parts:
        start, end = parts.pop()
        chord = np.interp(x[start : end + 1], x[[start, end]], y[[start, end]])
        distance = np.abs(y[start : end + 1] - chord)
        corner = start + int(distance.argmax())
        if distance.max() > tolerance:
            kept.add(corner)
            parts += [(start, corner), (corner, end)]
    return np.array(sorted(kept))
