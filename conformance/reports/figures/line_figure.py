"""Line at rest around the analysis section: side view and, of a line with stagger, plan view."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pantocheck.conformance.reports.figures.figure_style import FULL, GREY, INK, PALE, PlotStyle, render_svg
from pantocheck.conformance.reports.figures.fixed_panels import PanelGrid, add_panels
from pantocheck.conformance.results.figure_data import DrawnView, LineShape

WIRE_WIDTHS = {"contact_wire": 1.4, "messenger_wire": 0.9, "stitch_wire": 0.6}
POINT_SYMBOLS = {"messenger support": "^", "steady arm": "o", "anchor": "D", "mass": "v"}
"""Marker of each part that is drawn as a point."""

MOST_LABELLED = 14
"""Largest number of supports whose positions have room below the axis; of more, every second one is written."""


@render_svg
def draw_line_shape(shape: LineShape, section: tuple[float, float] | None) -> Figure:
    """Draw a line at rest, with the analysis section [m] on a grey ground."""
    views = [("height [m]", shape.side)] + ([] if shape.plan is None else [("y [m]", shape.plan)])
    figure, panels = add_panels(PanelGrid(FULL, 1.0, rows=len(views), right=0.2, between_rows=0.12))
    for (axes,), (name, view) in zip(panels, views, strict=True):
        if section is not None:
            axes.axvspan(*section, color=PALE, zorder=0)
        _draw_view(axes, view)
        supports = shape.supports_m
        axes.set(xlim=(supports[0], supports[-1]), ylabel=name)
        axes.margins(y=0.12)
        axes.yaxis.set_label_coords(-0.065, 0.5)
        axes.set_xticks(supports[:: 1 if len(supports) <= MOST_LABELLED else 2])
        axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
        axes.tick_params(labelbottom=axes is panels[-1][0])
    panels[-1][0].set_xlabel("position along the line [m]")
    _add_symbols(panels[0][0], shape.side)
    return figure


def _draw_view(axes: Axes, view: DrawnView) -> None:
    droppers = view.droppers
    axes.vlines(droppers.x_m, droppers.lower_m, droppers.upper_m, color=GREY, linewidth=0.6)
    for curve in view.curves:
        axes.plot(curve.x_m, curve.y_m, color=INK, linewidth=WIRE_WIDTHS[curve.kind])
    for point in view.points:
        axes.plot(point.x_m, point.y_m, clip_on=False, **_style(point.symbol))
        if point.text:
            place = (point.x_m, point.y_m)
            axes.annotate(
                point.text, place, xytext=(0, -5), textcoords="offset points", fontsize=6, ha="center", va="top"
            )


def _style(symbol: str) -> PlotStyle:
    ground = "white" if symbol == "steady arm" else INK
    return {"marker": POINT_SYMBOLS[symbol], "linestyle": "", "color": INK, "markersize": 3, "markerfacecolor": ground}


def _add_symbols(axes: Axes, view: DrawnView) -> None:
    """Names of the symbols that the drawing has."""
    shown = {point.symbol for point in view.points}
    handles = [Line2D([], [], label=symbol, **_style(symbol)) for symbol in POINT_SYMBOLS if symbol in shown]
    axes.legend(handles=handles, loc="lower right", bbox_to_anchor=(1, 1.0), ncols=len(handles) or 1, borderaxespad=0.1)
