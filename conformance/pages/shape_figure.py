"""Mode shapes: a row per mode with the values at the sensors and, if known, the computed shape; moving pictures."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pantocheck.conformance.core.figure_data import (
    DrawnCurve,
    DrawnDroppers,
    DrawnPoint,
    DrawnSymbol,
    DrawnView,
    LineShape,
)
from pantocheck.conformance.core.figure_style import FULL, INK, SHADES, PlotStyle, render_svg
from pantocheck.conformance.pages.fixed_panels import PanelGrid, add_panels
from pantocheck.conformance.pages.words import format_percent, format_value
from pantocheck.conformance.results.damping_format import MeasuredDeflection, PairedShape, WireShape
from pantocheck.conformance.results.identification_format import IdentifiedLine
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.results.motion_format import LineScene, MovingWire, PassageMotion, code_field

DRAWN_AMPLITUDE = 0.42
"""Height of the largest component of a shape; the distance of two rows is 1."""

ROW_HEIGHT = 0.42
"""Distance of two rows [in]."""

SENSOR_MARKERS = {"MW": "s"}
"""Marker of a sensor by its wire; other wires have a circle."""

CURVE_STYLES: dict[str, tuple[Any, str, float]] = {"MW": ("--", SHADES[1], 0.8), "CW": ("-", INK, 1.0)}
"""Line style, colour and width of a computed shape by its wire."""


@dataclass(frozen=True)
class ShapeRow:
    """Shape of one mode, whose largest value is 1."""

    label: str
    sensors: Sequence[MeasuredDeflection]
    curves: Sequence[WireShape] = ()


@dataclass(frozen=True)
class ShapeColumn:
    """Shapes of one group of modes."""

    title: str
    rows: Sequence[ShapeRow]


@render_svg
def draw_shapes(columns: Sequence[ShapeColumn], supports: Sequence[float]) -> Figure:
    """Mode shapes of several groups of modes side by side, with the supports [m] if they are known."""
    count = max(len(column.rows) for column in columns)
    grid = PanelGrid(
        FULL, ROW_HEIGHT * count, columns=len(columns), left=0.75, right=0.15, top=0.45, between_columns=0.9
    )
    figure, panels = add_panels(grid)
    for axes, column in zip(panels[0], columns, strict=True):
        _draw_column(axes, column, count, supports)
    figure.legend(
        handles=_list_handles(columns), loc="upper left", bbox_to_anchor=(grid.left / grid.width, 1.0), ncols=4,
        borderaxespad=0.0,
    )  # fmt: skip
    return figure


def _draw_column(axes: Axes, column: ShapeColumn, count: int, supports: Sequence[float]) -> None:
    rows = column.rows
    for level, row in zip(_list_levels(rows), rows, strict=True):
        for curve in row.curves:
            style, shade, width = CURVE_STYLES.get(curve.wire, CURVE_STYLES["CW"])
            values = level + DRAWN_AMPLITUDE * np.array(curve.value)
            axes.plot(curve.position_m, values, style, color=shade, linewidth=width)
    for wire in sorted({sensor.wire for row in rows for sensor in row.sensors}):
        _draw_sensors(axes, rows, wire)
    axes.set_yticks(_list_levels(rows), [row.label for row in rows])
    axes.set_ylim(-count + 0.45, 0.55)
    axes.tick_params(axis="y", length=0)
    if supports:
        axes.vlines(supports, -count + 0.45, 0.55, color=SHADES[3], linewidth=0.7, zorder=0)
        axes.set_xlim(supports[0], supports[-1])
    else:
        axes.margins(x=0.05)
    axes.grid(color=SHADES[2])
    axes.set_title(column.title, fontsize=8, loc="left", pad=3)
    axes.set_xlabel("position along the line [m]")


def _list_levels(rows: Sequence[ShapeRow]) -> list[int]:
    """Heights of the rows in the drawing, from the top."""
    return [-number for number in range(len(rows))]


def _draw_sensors(axes: Axes, rows: Sequence[ShapeRow], wire: str) -> None:
    """Values at the sensors of one wire in all rows, with stems."""
    points = [
        (sensor.position_m, level, level + DRAWN_AMPLITUDE * sensor.value)
        for level, row in zip(_list_levels(rows), rows, strict=True)
        for sensor in row.sensors
        if sensor.wire == wire
    ]
    places, levels, values = np.transpose(points)
    axes.vlines(places, levels, values, color=INK, linewidth=0.8)
    axes.plot(places, values, **_choose_marker(wire))


def _choose_marker(wire: str) -> PlotStyle:
    """Properties of the marker of a sensor."""
    marker = SENSOR_MARKERS.get(wire, "o")
    face = "white" if marker == "s" else INK
    return {"linestyle": "", "marker": marker, "color": INK, "markerfacecolor": face, "markersize": 4}


def _list_handles(columns: Sequence[ShapeColumn]) -> list[Line2D]:
    """Entries of the legend for the wires that occur."""
    rows = [row for column in columns for row in column.rows]
    sensors = {sensor.wire for row in rows for sensor in row.sensors}
    curves = {curve.wire for row in rows for curve in row.curves}
    handles = [
        Line2D([], [], linestyle=style, color=shade, linewidth=width, label=f"computed, {wire}")
        for wire, (style, shade, width) in reversed(CURVE_STYLES.items())
        if wire in curves
    ]
    for wire in sorted(sensors):
        marker: PlotStyle = {"label": f"measured, {wire}" if wire else "measured", **_choose_marker(wire)}
        handles.append(Line2D([], [], **marker))
    return handles


# Rows of a figure of mode shapes.
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


# Moving pictures of identified mode shapes at the sensors, each with its own frequency and decay.
PERIODS, FRAMES_PER_PERIOD = 10, 24
"""Length of a picture, and its frames in a period."""

MOST_SHAPES = 60
"""Largest number of mode shapes of a line, by frequency."""

LARGEST_MM = 100.0
"""Drawn rise of the largest component of a shape at the start: the sensors read it in percent."""

HEIGHTS = {"MW": ("messenger_wire", 1.2), "CW": ("contact_wire", 0.0)}
"""Kind and drawn height of a wire [m]; the heights are schematic."""

LONE_M = 2.0
"""Half the drawn length of a wire with a single sensor."""


def build_mode_scene(line: IdentifiedLine) -> LineScene | None:
    """Moving pictures of the certain vertical modes of a line at the sensors with a position; None: there are none.

    The wires are straight between the sensors: a record knows no more of them.
    """
    modes = [mode for mode in line.modes if mode.certain and not mode.lateral and _list_wires(mode)][:MOST_SHAPES]
    places = sorted({(wire, x) for mode in modes for wire, rows in _list_wires(mode).items() for x, _ in rows})
    supports = list_supports(line.spans_m)
    if not modes or len(supports) < 2:
        return None
    ends = (supports[0], supports[-1])
    wires = [wire for wire in HEIGHTS if any(wire == known for known, _ in places)]
    curves = [DrawnCurve(kind=HEIGHTS[wire][0], x_m=[*ends], y_m=[HEIGHTS[wire][1]] * 2) for wire in wires]
    points = [DrawnPoint(symbol="sensor", x_m=x, y_m=HEIGHTS[wire][1], text=f"{wire} {x:g} m") for wire, x in places]
    none = DrawnDroppers(x_m=[], lower_m=[], upper_m=[])
    shape = LineShape(
        title="",
        first_span=1,
        last_span=len(supports) - 1,
        supports_m=supports,
        side=DrawnView(curves=curves, droppers=none, points=points),
        plan=None,
        symbols=[DrawnSymbol(name="sensor", marker="s")],
    )
    return LineScene(
        id=line.records[0].name,
        label="shape [%]",
        line_shape=shape,
        names=[_name_mode(mode) for mode in modes],
        motions=[_move_mode(mode, wires) for mode in modes],
        speed=1,
        gain=5,
    )


def _name_mode(mode: Mode) -> str:
    group = "" if mode.group is None else f", group {mode.group}"
    return f"{format_value(mode.frequency_Hz, 4)} Hz, ζ {format_percent(mode.damping_ratio)} %{group}"


def _list_wires(mode: Mode) -> dict[str, list[tuple[float, complex]]]:
    """Positions [m] and components of a shape on each wire with a known position, along the line."""
    found: dict[str, dict[float, complex]] = {}
    for part in mode.sensor_shape:
        if part.position_m is not None and part.wire in HEIGHTS:
            found.setdefault(part.wire, {}).setdefault(part.position_m, complex(part.re, part.im))
    return {wire: sorted(rows.items()) for wire, rows in found.items()}


def _move_mode(mode: Mode, wires: Sequence[str]) -> PassageMotion:
    """Free decay of a mode from its largest component, at its sensors."""
    step = 1 / (FRAMES_PER_PERIOD * mode.frequency_Hz)
    phase = 2 * np.pi * np.arange(PERIODS * FRAMES_PER_PERIOD + 1) / FRAMES_PER_PERIOD
    decay = np.exp((1j * np.sqrt(1 - mode.damping_ratio**2) - mode.damping_ratio) * phase)
    moving = []
    for wire, rows in _list_wires(mode).items():
        x, value = [place for place, _ in rows], np.array([part for _, part in rows])
        if len(x) == 1:
            x, value = [x[0] - LONE_M, x[0] + LONE_M], np.repeat(value, 2)
        rise = LARGEST_MM * np.real(decay[:, None] * value)
        moving.append(MovingWire(curve=wires.index(wire), x_m=x, rise_mm=code_field(rise, 0.1)))
    return PassageMotion(
        start_s=0,
        step_s=float(f"{step:.6g}"),
        speed_m_s=0,
        wires=moving,
        dropper_m=[],
        slack=None,
        pantographs=[],
        error_mm=None,
    )
