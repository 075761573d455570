"""Drawing of a whole line at rest: side view and plan view in rows of a few spans, at one scale."""

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pantocheck.conformance.core.figure_style import GREY, INK, PALE, marker_style, render_pdf_pages, render_svg
from pantocheck.conformance.line.elements.element import DrawnMark
from pantocheck.conformance.line.elements.tension_section import SectionPlace
from pantocheck.conformance.line.geometry import Geometry
from pantocheck.conformance.line.line_shape import LineView, list_element_marks, list_symbols
from pantocheck.model import Catenary, DiscretisedLine, Kind

# Rows and pages of the drawing of a line: spans that stand side by side, at one scale.
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


def drawing_row_height(plan_view: bool) -> float:
    """Height of a row with or without a plan view [in]."""
    return SIDE_VIEW + BETWEEN_ROWS + (PLAN_VIEW if plan_view else 0.0)


def divide_into_pages(rows: tuple[DrawingRow, ...], plan_view: bool) -> list[tuple[DrawingRow, ...]]:
    """Rows of each page of `SHEET`."""
    fit = max(1, int((SHEET[1] - HEADING) / drawing_row_height(plan_view)))
    return [rows[i : i + fit] for i in range(0, len(rows), fit)]


WIDTHS = {Kind.CONTACT_WIRE: 1.6, Kind.MESSENGER_WIRE: 1.0, Kind.STITCH_WIRE: 0.7}
LABEL_OFFSET = 0.42
"""Distance of the names of the vertical axes from the axes [in]."""
LABEL_LENGTH = 0.22
"""Length of the text of a dropper, which stands above a shorter dropper [in]."""
MARK_SPACE = 0.3
"""Distance below which two marks of a wire share one text [in]."""
LABEL_SPACE = 0.085
"""Smallest distance between the lengths of two droppers [in]."""


@dataclass(frozen=True)
class LineDrawing:
    """Content of a drawing."""

    line: DiscretisedLine
    """Line at rest."""
    title: str
    """Title of the line."""
    geometry: Geometry
    """Spans of the line."""
    marks: tuple[DrawnMark, ...] = ()
    """Sensors and masses."""
    sections: tuple[SectionPlace, ...] = ()
    """Tension sections; empty: one section."""

    @property
    def rows(self) -> tuple[DrawingRow, ...]:
        """Rows of the whole line."""
        return divide_into_rows(self.geometry)

    @property
    def scale(self) -> float:
        """Inches per metre along the track, the same in all rows."""
        return (SHEET[0] - LEFT - RIGHT) / max(row.end - row.start for row in self.rows)

    def view(self, field: str, row: DrawingRow) -> LineView:
        """Side view (`z`) or plan view (`y`) of a row."""
        return LineView(self.line, field, row.start, row.end)

    def extent(self, field: str, row: DrawingRow) -> tuple[float, float]:
        """Lowest and highest deflection of a view of a row, with margins; the height is the same in all rows [m]."""
        lowest, highest = np.transpose([self._span_wires(field, other) for other in self.rows])
        size = max(float(np.max(highest - lowest)), 0.1)
        bottom = self._span_wires(field, row)[0] - 0.4 * size
        return bottom, bottom + 1.55 * size

    def arms(self, row: DrawingRow) -> tuple[tuple[float, float, float], ...]:
        """Position, and lateral position of claw and hinge, of every steady arm with a length in a row [m]."""
        arms, view = [], self.view("y", row)
        for arm, force in zip(self.line.catenary.steady_arms, self.line.state.arm_force, strict=True):
            if view.contains(arm.position) and force[0] != 0.0 and arm.length is not None:
                claw = view.deflection(arm.wire, arm.position)
                # An arm that pulls has its hinge on the side of its force; an arm that pushes, on the other side.
                towards = float(np.sign(force[0])) * (1 if arm.acts == "pull" else -1)
                arms.append((arm.position, claw, claw + towards * arm.length))
        return tuple(arms)

    def _span_wires(self, field: str, row: DrawingRow) -> tuple[float, float]:
        """Lowest and highest deflection of the wires in a row, and of the hinges of its arms [m]."""
        wires = [w for _, _, w in self.view(field, row).wires()]
        hinges = [[hinge for _, _, hinge in self.arms(row)]] if field == "y" else []
        values = np.concatenate([*wires, *hinges])
        return float(values.min()), float(values.max())


def draw_line_svg(drawing: LineDrawing) -> str:
    """SVG text of a drawing with all rows below each other."""
    height = HEADING + len(drawing.rows) * drawing_row_height(drawing.line.catenary.has_lateral_field)
    return render_svg(paint_rows)(drawing, drawing.rows, height)


def draw_line_pdf(drawing: LineDrawing) -> bytes:
    """PDF of a drawing on pages of A4 in landscape."""
    pages = divide_into_pages(drawing.rows, drawing.line.catenary.has_lateral_field)
    return render_pdf_pages(lambda rows: paint_rows(drawing, rows, SHEET[1]), pages)


def paint_rows(drawing: LineDrawing, rows: tuple[DrawingRow, ...], height: float) -> Figure:
    """Paint rows of a drawing below each other.

    Args:
        drawing: The drawing.
        rows: Rows of this sheet.
        height: Height of the sheet [in].
    """
    lateral = drawing.line.catenary.has_lateral_field
    figure = Figure(figsize=(SHEET[0], height))
    figure.set_layout_engine("none")  # the place of every view is given
    _write_heading(figure, drawing, height)
    for n, row in enumerate(rows):
        top = height - HEADING - n * drawing_row_height(lateral)
        side = _add_view(figure, drawing, row, "z", top - SIDE_VIEW)
        _name_spans(side, drawing, row)
        _write_dropper_lengths(side, drawing, row)
        _draw_marks(side, drawing, row)
        if lateral:
            side.tick_params(labelbottom=False)
            plan = _add_view(figure, drawing, row, "y", top - SIDE_VIEW - PLAN_VIEW)
            _draw_arms(plan, drawing, row)
    return figure


def _write_heading(figure: Figure, drawing: LineDrawing, height: float) -> None:
    """Title, scales and symbols."""
    views = {"z": (SIDE_VIEW, "heights")}
    if drawing.line.catenary.has_lateral_field:
        views["y"] = (PLAN_VIEW, "lateral positions")
    scales = [
        f"{name} {FILLED * size / np.ptp(drawing.extent(field, drawing.rows[0])) / drawing.scale:.0f} times"
        for field, (size, name) in views.items()
    ]
    place = LEFT / SHEET[0]
    figure.text(place, 1 - 0.2 / height, drawing.title, fontsize=9, va="center")
    text = f"side view{' and plan view' if len(views) > 1 else ''}; along the track [m]; {', '.join(scales)} enlarged"
    figure.text(place, 1 - 0.4 / height, text, fontsize=7, color=GREY, va="center")
    marks = (*list_element_marks(drawing.line.catenary), *drawing.marks)
    handles = [
        Line2D([], [], markersize=4, label=symbol.name, **marker_style(symbol))
        for symbol in list_symbols(mark for mark in marks if mark in drawing.marks or not mark.text)
    ]
    figure.legend(
        handles=handles, loc="upper right", bbox_to_anchor=(1 - RIGHT / SHEET[0], 1 - 0.05 / height),
        ncols=len(handles), borderaxespad=0.0,
    )  # fmt: skip


def _add_view(figure: Figure, drawing: LineDrawing, row: DrawingRow, field: str, bottom: float) -> Axes:
    """Axes of one view of a row, with wires, droppers and supports; `bottom` is the lower edge [in]."""
    width, height = figure.get_size_inches()
    size = drawing.scale * (row.end - row.start)
    room = SIDE_VIEW if field == "z" else PLAN_VIEW
    axes = figure.add_axes((LEFT / width, bottom / height, size / width, FILLED * room / height))
    axes.set(
        xlim=(row.start, row.end), ylim=drawing.extent(field, row), ylabel="height [m]" if field == "z" else "y [m]"
    )
    axes.yaxis.set_label_coords(-LABEL_OFFSET / size, 0.5)
    axes.set_xticks([x for x in drawing.geometry.span_limits if row.start <= x <= row.end])
    axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    axes.grid(axis="x", color=PALE)
    view = drawing.view(field, row)
    for wire, x, w in view.wires():
        if x.size > 1:
            axes.plot(x, w, color=INK, linewidth=WIDTHS[wire.kind], solid_capstyle="butt")
    for position, lower, upper in view.connections():
        axes.plot([position] * 2, [lower, upper], color=GREY, linewidth=0.7)
    for mark, height in view.marks():
        if not mark.text:
            axes.plot(mark.position, height, markersize=3, clip_on=False, **marker_style(mark.symbol))
    return axes


def _name_spans(axes: Axes, drawing: LineDrawing, row: DrawingRow) -> None:
    """Number and length of each span below its contact wire, and the number of each support above it."""
    limits = drawing.geometry.span_limits
    for number in range(row.first, row.last + 1):
        start, end = drawing.geometry.span(number)
        sections = [str(place.number) for place in drawing.sections if place.first < number <= place.last]
        section = f", section {' and '.join(sections)}" if len(drawing.sections) > 1 else ""
        axes.annotate(
            f"span {number}: {end - start:g} m{section}", ((start + end) / 2, 0), xycoords=("data", "axes fraction"),
            xytext=(0, 2), textcoords="offset points", ha="center", fontsize=6, color=INK,
        )  # fmt: skip
    for number, x in enumerate(limits):
        if row.start <= x <= row.end:
            text = "end" if number in (0, len(limits) - 1) else f"support {number}"
            axes.annotate(
                text, (x, 1), xycoords=("data", "axes fraction"), xytext=(0, 2), textcoords="offset points",
                ha="center", fontsize=5.5, color=GREY, annotation_clip=False,
            )  # fmt: skip


def _write_dropper_lengths(axes: Axes, drawing: LineDrawing, row: DrawingRow) -> None:
    """Lengths of the droppers [m] beside them, or above short ones, as far as there is room."""
    last, view = -np.inf, drawing.view("z", row)
    droppers = zip(drawing.line.catenary.droppers, drawing.line.state.dropper_length, strict=True)
    for dropper, length in sorted(droppers, key=lambda item: item[0].position):
        if not view.contains(dropper.position) or drawing.scale * (dropper.position - last) < LABEL_SPACE:
            continue
        last = dropper.position
        lower, upper = (view.deflection(name, last) for name in (dropper.lower, dropper.upper))
        fits = FILLED * SIDE_VIEW * (upper - lower) / np.ptp(axes.get_ylim()) >= LABEL_LENGTH
        axes.annotate(
            f"{length:.3f}", (last, (lower + upper) / 2 if fits else upper), xytext=(-1, 0 if fits else 2),
            textcoords="offset points", fontsize=4.5, rotation=90, ha="right", va="center" if fits else "bottom",
            color=INK,
        )  # fmt: skip


def _draw_marks(axes: Axes, drawing: LineDrawing, row: DrawingRow) -> None:
    """Sensors and masses; neighbouring texts stand together, below the contact wire or above another wire."""
    view = drawing.view("z", row)
    inside = (mark for mark in drawing.marks if view.contains(mark.position))
    marks = sorted(inside, key=lambda mark: (mark.wire, mark.position))
    labels: list[tuple[DrawnMark, list[str]]] = []
    for mark in marks:
        height = view.deflection(mark.wire, mark.position)
        axes.plot(mark.position, height, markersize=4, clip_on=False, zorder=5, **marker_style(mark.symbol))
        last = labels[-1][0] if labels else None
        if last and last.wire == mark.wire and drawing.scale * (mark.position - last.position) < MARK_SPACE:
            labels[-1][1].append(mark.text)
        else:
            labels.append((mark, [mark.text]))
    contact_wires = {wire.name for wire in drawing.line.catenary.contact_wires}
    for mark, texts in labels:
        below = mark.wire in contact_wires
        axes.annotate(
            ", ".join(texts), (mark.position, view.deflection(mark.wire, mark.position)),
            xytext=(0, -5 if below else 5), textcoords="offset points", fontsize=5.5, ha="center",
            va="top" if below else "bottom", color=INK, bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.3},
        )  # fmt: skip


def _draw_arms(axes: Axes, drawing: LineDrawing, row: DrawingRow) -> None:
    """Steady arms in the plan view, from the claw to the hinge."""
    for position, claw, hinge in drawing.arms(row):
        axes.plot([position] * 2, [claw, hinge], color=INK, linewidth=1.0)


def list_labelled_marks(catenary: Catenary) -> tuple[DrawnMark, ...]:
    """Points of the elements of a line that have a text."""
    return tuple(mark for mark in list_element_marks(catenary) if mark.text)
