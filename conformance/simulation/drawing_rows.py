"""Rows and pages of the drawing of a line: spans that stand side by side, at one scale."""

import math
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.cases.geometry import Geometry

ROW_LENGTH = 400.0
"""Length of line in one row, about six spans [m]: the lengths of all droppers are legible."""
SHEET = (11.69, 8.27)
"""Width and height of a page, A4 in landscape [in]."""
LEFT, RIGHT, HEADING = 0.65, 0.25, 0.65
"""Margins beside the rows, and height of the heading [in]."""
SIDE_VIEW, PLAN_VIEW, BETWEEN_ROWS = 1.4, 0.6, 0.5
"""Heights of the two views of a row, and of the space for its numbers [in]."""

FILLED = 0.94
"""Height of the axes of a view over the height of the view; the rest separates the views."""


@dataclass(frozen=True)
class DrawingRow:
    """Spans of one row."""

    first: int
    last: int
    """First and last span, from 1."""
    start: float
    end: float
    """Positions of both ends [m]."""


def divide_into_rows(geometry: Geometry) -> tuple[DrawingRow, ...]:
    """Divide a line into rows with nearly equal numbers of spans."""
    spans = np.arange(1, geometry.spans + 1)
    parts = np.array_split(spans, min(geometry.spans, math.ceil(geometry.length / ROW_LENGTH)))
    limits = [(int(part[0]), int(part[-1])) for part in parts]
    return tuple(DrawingRow(first, last, *geometry.section(first, last)) for first, last in limits)


def row_height(plan_view: bool) -> float:
    """Height of a row with or without a plan view [in]."""
    return SIDE_VIEW + BETWEEN_ROWS + (PLAN_VIEW if plan_view else 0.0)


def divide_into_pages(rows: tuple[DrawingRow, ...], plan_view: bool) -> list[tuple[DrawingRow, ...]]:
    """Rows of each page of `SHEET`."""
    fit = max(1, int((SHEET[1] - HEADING) / row_height(plan_view)))
    return [rows[i : i + fit] for i in range(0, len(rows), fit)]
