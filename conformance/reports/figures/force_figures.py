"""Figures of a certificate as SVG: matplotlib's object API, letters as paths, no dates, the same bytes every time."""

import io
from collections.abc import Callable
from functools import cache, wraps
from importlib.resources import as_file
from typing import Any, ParamSpec

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.reports.page_text import format_value
from pantocheck.conformance.reports.words import TEMPLATES

INK, GREY, PALE = "#1a1d21", "#8a929b", "#e9edf1"
SHADES = (INK, "#6b747e", "#9aa3ac", "#c3cad2")
FULL, HALF = 6.9, 3.4  # widths of a figure [in]: across an A4 page's text, and two beside each other
# Force limits drawn beside the force, in this order, under short names.
FORCE_LIMITS = {
    "mean_force_N": "mean",
    "statistical_max_N": "+3σ",
    "statistical_min_N": "−3σ",
    "max_force_N": "max",
    "min_force_N": "min",
}
LINES = ("-", "--", "-.", ":")

P = ParamSpec("P")

MOST_NAMED = 4
"""Supports that are told apart by their lines; of more, the largest uplift stands out."""


@cache
def _style() -> Any:
    with as_file(TEMPLATES / "figure.mplstyle") as path:
        settings = dict(matplotlib.rc_params_from_file(path, use_default_template=True))
    # The backend belongs to whoever imported matplotlib; a canvas is named here directly.
    return {key: value for key, value in settings.items() if not key.startswith("backend")}


def render_svg(paint: Callable[P, Figure]) -> Callable[P, str]:
    """Make a function that paints a figure one that returns its SVG text, in the house's style."""

    @wraps(paint)
    def svg(*args: P.args, **kwargs: P.kwargs) -> str:
        with matplotlib.rc_context(_style()):
            buffer = io.StringIO()
            # No metadata: it would hold the date and matplotlib's version.
            nothing = dict.fromkeys(("Date", "Creator", "Format", "Type"))
            canvas: Any = FigureCanvasSVG(paint(*args, **kwargs))
            canvas.print_svg(buffer, metadata=nothing)
        text = buffer.getvalue()
        return text[text.index("<svg") :]

    return svg


@render_svg
def draw_force(trace: dict[str, Any], limited: list[dict[str, Any]]) -> Figure:
    """Contact force over the evaluated stretch; on the right, where its statistics lie between their limits.

    Parameters
    ----------
    trace : dict[str, Any]
        One pantograph's entry of a case's `traces`.
    limited : list[dict[str, Any]]
        What `limited_rows` leaves of the criteria of that pantograph.
    """
    figure = Figure(figsize=(FULL, 2.6))
    if limited:
        left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1, 0.062 * (len(limited) + 1)))
        _limit_strip(right, limited)
    else:
        left = figure.subplots()
    position = trace["position_m"]
    if trace.get("force_N"):
        left.plot(position, trace["force_N"], color=GREY, linewidth=0.6, label="unfiltered")
    if trace.get("force_20_N"):
        left.plot(position, trace["force_20_N"], color=INK, linewidth=1.2, label="0–20 Hz")
    mean, std = trace.get("mean_N"), trace.get("std_N")
    if mean is not None and std is not None:
        left.axhline(mean, color=INK, linewidth=0.9, linestyle="-.", label="mean")
        for level, label in ((mean + 3 * std, "mean ± 3 σ"), (mean - 3 * std, None)):
            left.axhline(level, color=INK, linewidth=0.9, linestyle="--", label=label)
    for at, support in enumerate(trace.get("supports_m") or []):
        left.axvline(support, color=INK, linewidth=0.8, linestyle=":", label=None if at else "support")
    left.set_xlim(position[0], position[-1])
    left.set_xlabel("position along the track [m]")
    left.set_ylabel("contact force [N]")
    _legend(left)
    return figure


def limited_rows(criteria: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Criteria of a pantograph whose limits are drawn beside its force, in the order of `FORCE_LIMITS`."""
    return [row for name in FORCE_LIMITS for row in criteria if row["quantity"] == name and _has_limits(row)]


def _has_limits(row: dict[str, Any]) -> bool:
    return row["lower"] is not None or row["upper"] is not None


def _limit_strip(axes: Axes, rows: list[dict[str, Any]]) -> None:
    """One column per statistic: its limits as a bar, its value as a disc, cross or ring."""
    for column, row in enumerate(rows):
        lower, upper = row["lower"], row["upper"]
        bounds = [limit for limit in (lower, upper) if limit is not None]
        if len(bounds) == 2:
            axes.fill_between([column - 0.32, column + 0.32], lower, upper, color="#d5dbe1", linewidth=0)
        axes.hlines(bounds, column - 0.36, column + 0.36, color=INK, linewidth=1.2)
        if len(bounds) == 1:  # an arrow from the only limit into the permitted side
            arrow = {"arrowstyle": "<-", "color": INK, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0}
            tip = (0, 16 if upper is None else -16)
            axes.annotate("", (column, bounds[0]), xytext=tip, textcoords="offset points", arrowprops=arrow)
        if row["value"] is not None:
            marker, face = {"pass": ("o", INK), "fail": ("X", INK)}.get(row["verdict"], ("o", "white"))
            axes.plot(column, row["value"], marker, color=INK, markerfacecolor=face, markersize=5)
    axes.set_xlim(-0.7, len(rows) - 0.3)
    axes.set_xticks(range(len(rows)), [FORCE_LIMITS[row["quantity"]] for row in rows])
    axes.tick_params(axis="both", length=0, labelleft=False)
    axes.set_xlabel("limits")
    axes.spines["left"].set_visible(False)


@render_svg
def draw_spectrum(trace: dict[str, Any], quantities: dict[str, Any]) -> Figure:
    """Single-sided amplitude spectrum of the unfiltered force with the three bands and their RMS."""
    frequency, amplitude = trace["spectrum"]["frequency_Hz"], trace["spectrum"]["amplitude_N"]
    figure = Figure(figsize=(HALF, 2.3))
    axes = figure.subplots()
    axes.plot(frequency, amplitude, color=INK, linewidth=0.9)
    for at, (low, high, name) in enumerate(BANDS):
        axes.axvspan(low, high, color=PALE if at % 2 == 0 else "white", zorder=0)
        axes.axvline(high, color=GREY, linewidth=0.8, linestyle="--")
        rms = quantities.get(name)
        text = f"{low}–{high}" + (f"\n{format_value(rms, 3)}" if rms is not None else "")
        axes.text(
            (low + high) / 2, 1.02, text, ha="center", va="bottom", fontsize=7, transform=axes.get_xaxis_transform()
        )
    axes.text(-0.02, 1.02, "Hz\nrms [N]", ha="right", va="bottom", fontsize=7, transform=axes.transAxes)
    axes.set_xlim(0, 50)
    axes.set_ylim(bottom=0)
    axes.set_xticks([0, 5, 10, 20, 30, 40, 50])
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("amplitude [N]")
    return figure


@render_svg
def draw_histogram(trace: dict[str, Any]) -> Figure:
    """Histogram of the 20 Hz force with its mean and mean plus and minus three standard deviations."""
    edges, share = trace["histogram"]["edges_N"], trace["histogram"]["share_pct"]
    figure = Figure(figsize=(HALF, 2.3))
    axes = figure.subplots()
    axes.set_ylim(0, 1.08 * max(share))
    axes.stairs(share, edges, fill=True, facecolor="#c3cad2", edgecolor=INK, linewidth=0.6)
    mean, std = trace.get("mean_N"), trace.get("std_N")
    if mean is not None and std is not None:
        axes.axvline(mean, color=INK, linewidth=0.9, linestyle="-.", label="mean")
        axes.axvline(mean - 3 * std, color=INK, linewidth=0.9, linestyle="--", label="mean ± 3 σ")
        axes.axvline(mean + 3 * std, color=INK, linewidth=0.9, linestyle="--")
        axes.margins(x=0.04)
        _legend(axes)
    axes.set_xlabel("contact force, 0–20 Hz [N]")
    axes.set_ylabel("share of samples [%]")
    return figure


@render_svg
def draw_uplift(supports: list[dict[str, Any]], criteria: list[dict[str, Any]]) -> Figure:
    """Uplift at each support over time, with the limits of the maximum where it is graded."""
    figure = Figure(figsize=(FULL, 2.1))
    axes = figure.subplots()
    if len(supports) <= MOST_NAMED:
        for at, support in enumerate(supports):
            shade = ("#1a1d21", "#6b747e", "#9aa3ac")[at % 3]
            name = f"support at {support['support_m']:g} m"
            style = LINES[at % len(LINES)]
            axes.plot(support["time_s"], support["uplift_mm"], style, color=shade, linewidth=1.1, label=name)
    else:
        _many_supports(axes, supports)
    limits = {(row["lower"], row["upper"]) for row in criteria if row["quantity"] == "max_uplift_at_support_mm"}
    for lower, upper in sorted(limits, key=str):
        if lower is not None and upper is not None:
            axes.axhspan(lower, upper, color="#d5dbe1", zorder=0, label="limits of the maximum")
        else:
            for level in (lower, upper):
                if level is not None:
                    axes.axhline(level, color=INK, linewidth=1.2, linestyle=(0, (6, 2)), label="limit of the maximum")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("uplift [mm]")
    _legend(axes)
    return figure


def _many_supports(axes: Axes, supports: list[dict[str, Any]]) -> None:
    """All supports in grey, and the one with the largest uplift drawn over them: names of all would fill the figure."""
    largest = max(supports, key=lambda support: max(support["uplift_mm"]))
    others = [support for support in supports if support is not largest]
    for support in others:
        name = "other supports" if support is others[0] else None
        axes.plot(support["time_s"], support["uplift_mm"], color="#9aa3ac", linewidth=0.8, label=name)
    name = f"largest: support at {largest['support_m']:g} m"
    axes.plot(largest["time_s"], largest["uplift_mm"], color="#1a1d21", linewidth=1.3, label=name)


def _legend(axes: Axes) -> None:
    """Names above the axes, so that they never cover the data."""
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=5, borderaxespad=0.2, columnspacing=1.4)


def draw_box(axes: Axes, values: RealArray, at: float) -> None:
    """Quartiles and median of some values as a box at a place of the other axis, which keeps its ticks."""
    axes.boxplot(
        values,
        positions=[at],
        widths=0.5,
        showfliers=False,
        boxprops={"color": INK},
        medianprops={"color": INK, "linewidth": 1.6},
        whiskerprops={"color": GREY},
        capprops={"color": GREY},
        manage_ticks=False,
    )
