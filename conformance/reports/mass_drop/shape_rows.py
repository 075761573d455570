"""Rows of a figure of mode shapes."""

from collections.abc import Iterable, Sequence
from itertools import accumulate

from pantocheck.conformance.identification.damping.damping_format import MeasuredDeflection, PairedShape
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.reports.figures.shape_figure import ShapeColumn, ShapeRow
from pantocheck.conformance.reports.page_text import format_value

DRAWN_GROUPS = 2
"""Number of groups of span modes whose shapes are drawn."""

DRAWN_MODES = 12
"""Largest number of drawn modes of a group."""


def list_measured_shapes(modes: Sequence[Mode]) -> list[ShapeColumn]:
    """Groups of modes with the real parts of their shapes at the sensors, for `draw_shapes`.

    Uncertain modes and sensors without a position are left out, and shapes at fewer than two sensors.
    """
    columns = []
    for group in range(1, DRAWN_GROUPS + 1):
        rows = []
        for mode in (mode for mode in modes if mode.group == group and mode.certain and not mode.lateral):
            sensors = [
                MeasuredDeflection(wire=part.wire, position_m=part.position_m, value=part.re)
                for part in mode.sensor_shape
                if part.position_m is not None
            ]
            if len(sensors) > 1:
                rows.append(ShapeRow(f"{format_value(mode.frequency_Hz, 4)} Hz", sensors))
        if rows:
            columns.append(ShapeColumn(f"group {group}", rows[:DRAWN_MODES]))
    return columns


def list_paired_rows(shapes: Sequence[PairedShape]) -> list[ShapeColumn]:
    """Groups of measured and computed shapes, the `shapes.modes` of damping.json, for `draw_shapes`."""
    groups: dict[int, list[ShapeRow]] = {}
    for shape in shapes:
        label = f"{format_value(shape.measured_Hz, 4)} Hz\nMAC {shape.mac:.3f}"
        groups.setdefault(shape.group, []).append(ShapeRow(label, shape.sensors, shape.curves))
    return [ShapeColumn(f"group {group}", groups[group]) for group in sorted(groups)]


def list_supports(spans: Iterable[float]) -> list[float]:
    """Positions of the supports [m] by the lengths of the spans [m]; empty if these are unknown."""
    lengths = list(spans)
    return [*accumulate(lengths, initial=0.0)] if lengths else []
