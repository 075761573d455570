"""Shape of a line at rest between two positions, for its drawings; the elements name their points and lines."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import (
    DrawnCurve,
    DrawnDroppers,
    DrawnPoint,
    DrawnSymbol,
    DrawnView,
    LineShape,
)
from pantocheck.conformance.line.elements.element import DrawnConnection, DrawnMark
from pantocheck.conformance.line.elements.element_registry import ELEMENTS
from pantocheck.conformance.line.elements.wire import Wires
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import Catenary, DiscretisedLine, Wire

POSITION_TOLERANCE_M = 1e-6
"""Rounding of positions [m]."""

MOST_DRAWN_SPANS = 24
"""Largest number of spans that are stored: a span is then 6 mm long on paper."""

THINNING_M = 0.0005
"""Largest distance of a wire from its drawn polygon per drawn span [m]: the more spans, the narrower is each of them.

At most 12 mm; a drawing of 2 m height has 28 mm per typographic point."""


def find_deflection(line: DiscretisedLine, wire: str, field: str, position: RealArray | float) -> RealArray:
    """Height (`z`) or lateral position (`y`) of a wire at rest.

    Args:
        line: Line at rest.
        wire: Name of the wire.
        field: `z` or `y`.
        position: Positions along the line [m].

    Returns:
        Deflection at every position [m].
    """
    row = line.mesh.row_of[wire, field]
    return np.asarray(np.interp(np.asarray(position), line.mesh.position, line.state.deflection[row, :, 0]))


def list_element_marks(catenary: Catenary) -> list[DrawnMark]:
    """Points of all elements of a line: ends of the wires, points without a text, and those with one."""
    marks = (mark for element in ELEMENTS[::-1] for mark in element.mark(catenary))
    return sorted(marks, key=lambda mark: (mark.text != "", mark.symbol != Wires.symbol))


def list_symbols(marks: Iterable[DrawnMark]) -> list[DrawnSymbol]:
    """Symbols of points in the order of a legend: that of the points, but the ends of the wires follow the supports."""
    ordered = sorted(marks, key=lambda mark: (mark.text != "", mark.symbol == Wires.symbol))
    return list(dict.fromkeys(mark.symbol for mark in ordered))


def list_connections(catenary: Catenary) -> list[DrawnConnection]:
    """Lines between two wires of all elements of a line."""
    return [connection for element in ELEMENTS for connection in element.connect(catenary)]


@dataclass(frozen=True)
class LineView:
    """Side view (`z`) or plan view (`y`) of a line at rest between two positions [m]."""

    line: DiscretisedLine
    field: str
    start: float
    end: float

    def contains(self, position: float) -> bool:
        """Whether a position [m] is drawn."""
        return self.start - POSITION_TOLERANCE_M <= position <= self.end + POSITION_TOLERANCE_M

    def deflection(self, wire: str, position: float) -> float:
        """Deflection of a wire at a position [m]."""
        return float(find_deflection(self.line, wire, self.field, position))

    def wires(self) -> Iterator[tuple[Wire, RealArray, RealArray]]:
        """Wires with the positions and deflections of their stations [m]; none for a wire outside."""
        x = self.line.mesh.position
        for wire in self.line.catenary.wires:
            start, end = max(wire.start, self.start), min(wire.end, self.end)
            inside = (x >= start - POSITION_TOLERANCE_M) & (x <= end + POSITION_TOLERANCE_M)
            row = self.line.mesh.row_of[wire.name, self.field]
            yield wire, x[inside], self.line.state.deflection[row, inside, 0]

    def connections(self) -> Iterator[tuple[float, float, float]]:
        """Position, lower and upper end of every line between two wires [m]."""
        for part in list_connections(self.line.catenary):
            if self.contains(part.position):
                x = part.position
                yield x, self.deflection(part.lower, x), self.deflection(part.upper, x)

    def marks(self) -> Iterator[tuple[DrawnMark, float]]:
        """Points of the elements with their deflections [m]."""
        for mark in list_element_marks(self.line.catenary):
            if self.contains(mark.position):
                yield mark, self.deflection(mark.wire, mark.position)


def build_line_shape(file: LineFile, analysed_spans: tuple[int, int], line: DiscretisedLine) -> LineShape:
    """Shape of a line at rest over the spans of the analysis section and one span on either side, for results.json.

    Args:
        file: Content of the line file.
        analysed_spans: First and last span of the analysis section, from 1.
        line: Line at rest.
    """
    geometry, (first, last) = file.geometry, analysed_spans
    first = max(first - 1, 1)
    last = min(last + 1, geometry.spans, first + MOST_DRAWN_SPANS - 1)
    limits, tolerance = geometry.section(first, last), (last - first + 1) * THINNING_M
    side = LineView(line, "z", *limits)
    return LineShape(
        title=file.title,
        first_span=first,
        last_span=last,
        supports_m=[round(x, 2) for x in geometry.span_limits if side.contains(x)],
        side=_store_view(side, tolerance),
        plan=_store_view(LineView(line, "y", *limits), tolerance) if line.catenary.has_lateral_field else None,
        symbols=list_symbols(mark for mark, _ in side.marks()),
    )


def _store_view(view: LineView, tolerance: float) -> DrawnView:
    """Curves and points of a view; positions to a centimetre, deflections to a millimetre."""
    connections = list(view.connections())
    curves = []
    for wire, x, w in view.wires():
        if x.size > 1:
            kept = thin_curve(x, w, tolerance)
            curves.append(DrawnCurve(kind=wire.kind.value, x_m=_round_all(x[kept], 2), y_m=_round_all(w[kept], 3)))
    return DrawnView(
        curves=curves,
        droppers=DrawnDroppers(
            x_m=[round(x, 2) for x, _, _ in connections],
            lower_m=[round(lower, 3) for _, lower, _ in connections],
            upper_m=[round(upper, 3) for _, _, upper in connections],
        ),
        points=[
            DrawnPoint(symbol=mark.symbol.name, x_m=round(mark.position, 2), y_m=round(w, 3), text=mark.text)
            for mark, w in view.marks()
        ],
    )


def _round_all(values: RealArray, decimals: int) -> list[float]:
    return [round(float(value), decimals) for value in values]


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
