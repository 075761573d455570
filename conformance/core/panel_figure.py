"""Figures of panels as SVG, written directly: importing and using a plotting package takes a second per certificate.

A panel draws lines, areas and texts at data coordinates, between ticks at round numbers. Its methods and arguments
bear the names of matplotlib, which draws the figures of the other reports in the same style.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import wraps
from typing import ParamSpec

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.drawn_data import DrawnData, DrawnFigure, name_panel
from pantocheck.conformance.core.figure_style import INK
from pantocheck.conformance.core.font_file import measure_text
from pantocheck.conformance.core.look import read_look
from pantocheck.conformance.core.panel_marks import (
    LineStyle,
    write_area,
    write_markers,
    write_number,
    write_path,
    write_text,
)
from pantocheck.conformance.core.panel_scale import MOST_INTERVALS, AxisScale

FRAME, GRID, PAPER = read_look()["figure"]["frame"], read_look()["figure"]["grid"], read_look()["light"]["paper"]
FRAME_WIDTH, GRID_WIDTH, TICK_WIDTH = 0.7, 0.6, 0.8
TICK, PAD, LABEL_PAD = 3.5, 3.5, 4.0
"""Length of a tick, its distance from its label, and the distance of this from the name of the axis [pt]."""
NAME_SIZE, TICK_SIZE = 8.0, 7.5
"""Font sizes of the names of axes, and of ticks and legends [pt]."""

PlottedValues = RealArray | Sequence[float]
Arguments = ParamSpec("Arguments")


@dataclass(frozen=True)
class DrawnLine:
    """Line, or points with markers."""

    x: RealArray
    y: RealArray
    style: LineStyle
    label: str | None
    is_clipped: bool


@dataclass(frozen=True)
class FilledArea:
    """Rectangle or closed polygon; infinity for an edge of the panel."""

    x: tuple[float, ...]
    y: tuple[float, ...]
    color: str
    edge: str = ""
    edge_width: float = 1.0
    opacity: float = 1.0
    label: str | None = None


@dataclass(frozen=True)
class Words:
    """Text at a place."""

    x: float
    y: float
    text: str
    size: float
    color: str
    ha: str
    va: str
    frame: tuple[str, str]
    """Unit of x and y: data, or share of the panel."""
    shift: tuple[float, float]
    """Shift to the right and upwards [pt]."""


@dataclass
class Panel:
    """Axes of a figure, with all that is drawn on them."""

    bounds: tuple[float, float, float, float]
    """Left, upper edge, width and height in the figure [pt]."""
    x_scale: AxisScale = field(default_factory=AxisScale)
    y_scale: AxisScale = field(default_factory=lambda: AxisScale(margin=0.05))
    has_axes: bool = True
    y_name_left: float | None = None
    """Distance of the name of the y axis left of the panel, as a share of its width; None: beside the ticks."""
    marks: list[tuple[float, DrawnLine | FilledArea | Words]] = field(default_factory=list)
    """Drawn parts with their levels."""
    legend: list[tuple[str, LineStyle | FilledArea]] = field(default_factory=list)
    legend_columns: int = 5
    legend_side: str = "left"

    def __post_init__(self) -> None:
        """Choose numbers of ticks that leave room for their labels."""
        _, _, width, height = self.bounds
        self.x_scale.intervals = min(max(int(width / (3 * TICK_SIZE)), 1), MOST_INTERVALS)
        self.y_scale.intervals = min(max(int(height / (2 * TICK_SIZE)), 1), MOST_INTERVALS)

    @property
    def curves(self) -> list[DrawnLine]:
        """Drawn curves."""
        return [mark for _, mark in self.marks if isinstance(mark, DrawnLine)]

    @property
    def areas(self) -> list[FilledArea]:
        """Drawn areas."""
        return [mark for _, mark in self.marks if isinstance(mark, FilledArea)]

    @property
    def texts(self) -> list[Words]:
        """Drawn texts."""
        return [mark for _, mark in self.marks if isinstance(mark, Words)]

    def plot(
        self,
        x: PlottedValues,
        y: PlottedValues,
        style: LineStyle,
        label: str | None = None,
        is_clipped: bool = True,
        level: float = 2.0,
    ) -> None:
        """Draw a curve or points."""
        curve = DrawnLine(np.asarray(x, np.float64), np.asarray(y, np.float64), style, label, is_clipped)
        self.x_scale.include(curve.x)
        self.y_scale.include(curve.y)
        self.marks.append((level, curve))

    def axhline(self, y: float, style: LineStyle, label: str | None = None) -> None:
        """Draw a line across the panel at a height."""
        self.y_scale.include([y])
        self.marks.append((2.0, DrawnLine(np.array([-np.inf, np.inf]), np.array([y, y]), style, label, True)))

    def axvline(self, x: float, style: LineStyle, label: str | None = None) -> None:
        """Draw an upright line through the panel at a place."""
        self.x_scale.include([x])
        self.marks.append((2.0, DrawnLine(np.array([x, x]), np.array([-np.inf, np.inf]), style, label, True)))

    def vlines(self, x: PlottedValues, low: PlottedValues, high: PlottedValues, style: LineStyle) -> None:
        """Draw upright lines between heights."""
        places = np.repeat(np.asarray(x, np.float64), 3)
        heights = np.column_stack((low, high, np.full(len(x), np.nan))).ravel() if len(x) else np.array([])
        self.plot(places, heights, style, level=1.0)

    def axhspan(self, low: float, high: float, color: str, level: float = 0.0, label: str | None = None) -> None:
        """Fill a band between two heights."""
        self.y_scale.include([low, high])
        self.marks.append(
            (level, FilledArea((-np.inf, np.inf, np.inf, -np.inf), (low, low, high, high), color, label=label))
        )

    def axvspan(self, low: float, high: float, color: str, opacity: float = 1.0, level: float = 0.0) -> None:
        """Fill a band between two places."""
        self.x_scale.include([low, high])
        self.marks.append(
            (level, FilledArea((low, high, high, low), (-np.inf, -np.inf, np.inf, np.inf), color, opacity=opacity))
        )

    def fill(self, x: PlottedValues, y: PlottedValues, color: str, edge: str = "", edge_width: float = 1.0) -> None:
        """Fill a polygon."""
        self.x_scale.include(x)
        self.y_scale.include(y)
        corners = tuple(map(float, x)), tuple(map(float, y))
        self.marks.append((1.0, FilledArea(*corners, color, edge, edge_width)))

    def stairs(self, heights: Sequence[float], edges: Sequence[float], color: str, edge: str, width: float) -> None:
        """Fill columns between neighbouring edges, from 0."""
        x = np.repeat(edges, 2)
        self.fill(x, [0.0, *np.repeat(heights, 2).tolist(), 0.0], color, edge, width)

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float = 7.0,
        color: str = INK,
        ha: str = "left",
        va: str = "baseline",
        frame: tuple[str, str] = ("data", "data"),
        shift: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Write a text at data coordinates or at shares of the panel."""
        self.marks.append((3.0, Words(x, y, text, size, color, ha, va, frame, shift)))

    def name_axes(self, x: str, y: str) -> None:
        """Write the names of both axes; empty: none."""
        self.x_scale.name, self.y_scale.name = x, y

    def add_legend(
        self, columns: int = 5, side: str = "left", entries: Sequence[tuple[str, LineStyle]] | None = None
    ) -> None:
        """Legend above the panel, where it cannot cover the data; by default of everything that has a label."""
        named = [mark for _, mark in self.marks if not isinstance(mark, Words) and mark.label]
        found = [(mark.label or "", mark.style if isinstance(mark, DrawnLine) else mark) for mark in named]
        self.legend, self.legend_columns, self.legend_side = [*(entries or found)], columns, side

    # From here on: writing.
    def _place(self, x: RealArray, y: RealArray) -> tuple[RealArray, RealArray]:
        """Points of the figure at data coordinates; infinite ones lie on the edges of the panel [pt]."""
        left, top, width, height = self.bounds
        shares = []
        for scale, values in ((self.x_scale, x), (self.y_scale, y)):
            low, high = scale.find_ends()
            inside = (values - low) / (high - low)
            shares.append(np.where(np.isinf(values), np.where(values > 0, 1.0, 0.0), inside))
        return left + width * shares[0], top + height * (1 - shares[1])

    def write(self, number: int) -> str:
        """SVG of the panel; `number` distinguishes it from the others of the figure."""
        left, top, width, height = self.bounds
        frame = f'x="{left:g}" y="{top:g}" width="{width:.6g}" height="{height:.6g}"'
        name = f"panel-{number}"
        parts = [f'<defs><clipPath id="{name}"><rect {frame}/></clipPath></defs>']
        if self.has_axes:
            parts.append(f'<rect {frame} fill="{PAPER}"/>')
        ordered = sorted(self.marks, key=lambda pair: pair[0])
        grid = self._write_grid() if self.has_axes else ""
        parts += [self._write_mark(mark, name) for level, mark in ordered if level < 0.5]
        parts += [grid, *(self._write_mark(mark, name) for level, mark in ordered if level >= 0.5)]
        if self.has_axes:
            parts.append(self._write_frame())
        return "".join([*parts, self._write_legend()])

    def _write_mark(self, mark: DrawnLine | FilledArea | Words, clip: str) -> str:
        match mark:
            case DrawnLine(style=style):
                x, y = self._place(mark.x, mark.y)
                line = f'<path d="{write_path(x, y)}" {style.describe()}/>' if style.linestyle else ""
                known = np.isfinite(x) & np.isfinite(y)
                points = zip(x[known].tolist(), y[known].tolist(), strict=True)
                drawn = line + (write_markers(points, style) if style.marker else "")
            case FilledArea():
                drawn = self._write_area(mark)
            case Words():
                return self._write_words(mark)
        clipped = not isinstance(mark, DrawnLine) or mark.is_clipped
        return f'<g clip-path="url(#{clip})">{drawn}</g>' if clipped else drawn

    def _write_area(self, area: FilledArea) -> str:
        x, y = self._place(np.array(area.x), np.array(area.y))
        return write_area(x.tolist(), y.tolist(), _describe_area(area))

    def _write_words(self, words: Words) -> str:
        left, top, width, height = self.bounds
        x, y = (part.item() for part in self._place(np.array([words.x]), np.array([words.y])))
        x = x if words.frame[0] == "data" else left + width * words.x
        y = y if words.frame[1] == "data" else top + height * (1 - words.y)
        place = x + words.shift[0], y - words.shift[1]
        return write_text(*place, words.text, words.size, words.color, words.ha, words.va)

    def _write_grid(self) -> str:
        left, _, width, _ = self.bounds
        places = [self._place(np.array([0.0]), np.array([tick]))[1].item() for tick in self.y_scale.list_ticks()[0]]
        path = "".join(f"M{left:g} {write_number(y)}h{width:.6g}" for y in places)
        return f'<path d="{path}" fill="none" stroke="{GRID}" stroke-width="{GRID_WIDTH}"/>' if path else ""

    def _write_frame(self) -> str:
        """Axes with ticks, labels and names."""
        left, top, width, height = self.bounds
        bottom = top + height
        (x_ticks, x_labels), (y_ticks, y_labels) = self.x_scale.list_ticks(), self.y_scale.list_ticks()
        places = [self._place(np.array([tick]), np.array([0.0]))[0].item() for tick in x_ticks]
        heights = [self._place(np.array([0.0]), np.array([tick]))[1].item() for tick in y_ticks]
        ticks = "".join(f"M{write_number(x)} {bottom:.6g}v{TICK}" for x in places)
        ticks += "".join(f"M{left:g} {write_number(y)}h{-TICK}" for y in heights)
        axes = f"M{left:g} {top:g}V{bottom:.6g}H{left + width:.6g}"
        style = f'fill="none" stroke="{FRAME}" stroke-linecap="square"'
        parts = [
            f'<path d="{ticks}" stroke="{FRAME}" stroke-width="{TICK_WIDTH}"/>',
            f'<path d="{axes}" {style} stroke-width="{FRAME_WIDTH}"/>',
        ]
        below, beside = bottom + TICK + PAD, left - TICK - PAD
        parts += [
            write_text(x, below, label, TICK_SIZE, INK, "center", "top")
            for x, label in zip(places, x_labels, strict=True)
            if label
        ]
        parts += [
            write_text(beside, y, label, TICK_SIZE, INK, "right", "center")
            for y, label in zip(heights, y_labels, strict=True)
            if label
        ]
        if self.x_scale.name:
            y = below + TICK_SIZE + LABEL_PAD
            parts.append(write_text(left + width / 2, y, self.x_scale.name, NAME_SIZE, INK, "center", "top"))
        if self.y_scale.name:
            x = beside - max([measure_text(label, TICK_SIZE) for label in y_labels], default=0.0) - LABEL_PAD
            x = x - 0.24 * NAME_SIZE if self.y_name_left is None else left - self.y_name_left * width
            parts.append(write_text(x, top + height / 2, self.y_scale.name, NAME_SIZE, INK, "center", turned=True))
        return "".join(parts)

    def _write_legend(self) -> str:
        """Entries above the panel, one column after the other."""
        left, top, width, _ = self.bounds
        count = len(self.legend)
        columns = min(self.legend_columns, count)
        if not columns:
            return ""
        size, handle, gap, between, row = TICK_SIZE, 2.2 * TICK_SIZE, 0.8 * TICK_SIZE, 1.4 * TICK_SIZE, 1.5 * TICK_SIZE
        lengths = [count // columns + (n < count % columns) for n in range(columns)]
        starts = [sum(lengths[:n]) for n in range(columns)]
        parts_of = [self.legend[start : start + length] for start, length in zip(starts, lengths, strict=True)]
        widths = [handle + gap + max(measure_text(label, size) for label, _ in part) for part in parts_of]
        x = left + 0.4 * size if self.legend_side == "left" else left + width - sum(widths) - between * (columns - 1)
        first = top - 0.02 * self.bounds[3] - 0.6 * size - row * (max(lengths) - 1)
        parts = []
        for part, taken in zip(parts_of, widths, strict=True):
            for number, (label, mark) in enumerate(part):
                y = first + number * row
                parts.append(_write_handle(mark, x, y - 0.35 * size, handle))
                parts.append(write_text(x + handle + gap, y, label, size, INK))
            x += taken + between
        return "".join(parts)


def _write_handle(mark: LineStyle | FilledArea, x: float, y: float, width: float) -> str:
    """Sample of a curve or an area in a legend."""
    if isinstance(mark, FilledArea):
        half = 0.35 * TICK_SIZE
        return write_area([x, x + width, x + width, x], [y - half, y - half, y + half, y + half], _describe_area(mark))
    line = f'<path d="M{write_number(x)} {write_number(y)}h{width:g}" {mark.describe()}/>' if mark.linestyle else ""
    return line + (write_markers([(x + width / 2, y)], mark) if mark.marker else "")


def _describe_area(area: FilledArea) -> str:
    edge = f' stroke="{area.edge}" stroke-width="{area.edge_width:g}"' if area.edge else ""
    return f'fill="{area.color}"{edge}' + (f' fill-opacity="{area.opacity:g}"' if area.opacity < 1 else "")


@dataclass
class PanelFigure:
    """Figure of panels."""

    width: float
    height: float
    """Size [in]."""
    axes: list[Panel] = field(default_factory=list)

    def add_axes(self, left: float, bottom: float, width: float, height: float) -> Panel:
        """Add a panel at a place of a size [in]."""
        panel = Panel(tuple(72 * part for part in (left, self.height - bottom - height, width, height)))  # type: ignore[arg-type]
        self.axes.append(panel)
        return panel

    def write(self) -> str:
        """SVG of the figure."""
        size = f"{72 * self.width:.6g}", f"{72 * self.height:.6g}"
        panels = "".join(panel.write(number) for number, panel in enumerate(self.axes, 1))
        root = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size[0]} {size[1]}" width="{size[0]}pt"'
        ground = f'<rect width="{size[0]}" height="{size[1]}" fill="{PAPER}"/>'
        return f'{root} height="{size[1]}pt" version="1.1">{ground}{panels}</svg>\n'

    def list_data(self) -> list[DrawnData]:
        """Curves and areas of all panels."""
        found = []
        for panel in self.axes:
            name = name_panel(panel.x_scale.name, panel.y_scale.name)
            found += [DrawnData(name, curve.label or "", curve.x, curve.y) for curve in panel.curves]
            found += [DrawnData(name, area.label or "", np.array(area.x), np.array(area.y)) for area in panel.areas]
        return found


def draw_symbol(panel: Panel, name: str, foot: tuple[float, float], half_width: float, length: float) -> None:
    """Draw the symbol of a mass, spring or damper from its foot upwards, in the units of the panel."""
    for line in read_look()["symbol"][name]:
        across, along = np.transpose(line)
        panel.plot(foot[0] + half_width * across, foot[1] + length * along, LineStyle(INK, 0.9))


def write_svg(paint: Callable[Arguments, PanelFigure]) -> Callable[Arguments, str]:
    """Turn a function that paints a figure of panels into a function that returns its SVG text."""

    @wraps(paint)
    def write(*args: Arguments.args, **kwargs: Arguments.kwargs) -> str:
        """Paint the figure; return its SVG text."""
        figure = paint(*args, **kwargs)
        return DrawnFigure(figure.write(), figure.list_data())

    return write
