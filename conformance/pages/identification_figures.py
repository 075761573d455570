"""Figures of an identification: spectra, frequency responses and damping ratios."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter

from pantocheck.conformance.core.figure_style import (
    FULL,
    GREY,
    INK,
    LIMIT_LINE,
    SHADES,
    add_box,
    add_legend,
    render_svg,
    use_decades,
)
from pantocheck.conformance.pages.fixed_panels import PanelGrid, add_panel, add_panels
from pantocheck.conformance.results.identification_format import (
    BandOrders,
    IdentifiedRecord,
    OrderSearch,
    RecordResponses,
    RecordSpectra,
    SearchStep,
)
from pantocheck.conformance.results.identified_modes import Mode


@render_svg
def draw_spectra(data: RecordSpectra, unit: str) -> Figure:
    """Spectrum of every sensor with the identified fit, its residual and the frequencies of the modes."""
    figure, panels = add_panels(PanelGrid(FULL, 1.25, rows=len(data.channels), top=0.35))
    for (axes,), channel, measured, fitted, residual in zip(
        panels, data.channels, data.measured, data.fitted, data.residual, strict=True
    ):
        axes.plot(data.frequency_Hz, measured, color=SHADES[3], linewidth=2.4, label="measured")
        axes.plot(data.frequency_Hz, fitted, color=INK, linewidth=0.8, label="identified")
        axes.plot(data.frequency_Hz, residual, ":", color=GREY, linewidth=0.7, label="residual")
        use_decades(axes)
        ticks, top = np.ones(len(data.poles_Hz)), axes.get_xaxis_transform()
        axes.plot(data.poles_Hz, ticks, "|", color=INK, markersize=6, transform=top, clip_on=False)
        axes.set_ylabel(f"{channel} [{unit} s]")
        axes.tick_params(labelbottom=axes is panels[-1][0])
    panels[-1][0].set_xlabel("frequency [Hz]; ticks: identified modes")
    add_legend(panels[0][0])
    return figure


@render_svg
def draw_stretch(record: IdentifiedRecord) -> Figure:
    """Residual over the motion at rest through a record; the used part is shaded, and dashed: equal to the rest."""
    figure, axes = add_panel(FULL, 1.6)
    start, end = (time - record.release_s for time in (record.used_from_s, record.used_to_s))
    axes.axvspan(start, end, color=SHADES[3], alpha=0.4, linewidth=0, label="used")
    axes.plot(record.residual_time_s, record.residual_over_rest, color=INK, linewidth=1.0, label="residual")
    axes.axhline(1, color=INK, linestyle=LIMIT_LINE, linewidth=0.9)
    axes.set_yscale("log")
    for set_formatter in (axes.yaxis.set_major_formatter, axes.yaxis.set_minor_formatter):
        set_formatter(LogFormatter())  # plain letters: the style reads no text as a formula
    axes.set(xlabel="time after the release [s]", ylabel="residual over rest")
    add_legend(axes)
    return figure


@render_svg
def draw_responses(data: RecordResponses) -> Figure:
    """Accelerance of every sensor: magnitude and phase, measured and of the identified modes."""
    grid = PanelGrid(FULL, 1.85, rows=len(data.channels), left=0.8, top=0.25, between_rows=0.12)
    figure, panels = add_panels(grid)
    for (lower,), channel, measured, identified in zip(
        panels, data.channels, data.measured, data.identified, strict=True
    ):
        upper = _split_panel(figure, lower)
        upper.plot(data.frequency_Hz, measured.magnitude, color=SHADES[3], linewidth=2.4, label="measured")
        upper.plot(data.frequency_Hz, identified.magnitude, color=INK, linewidth=0.8, label="identified")
        use_decades(upper)
        upper.set_ylabel(f"{channel}\n[m/s²/N]")
        upper.tick_params(labelbottom=False)
        lower.plot(data.frequency_Hz, np.degrees(measured.phase_rad), ".", color=SHADES[3], markersize=2.5)
        lower.plot(data.frequency_Hz, np.degrees(identified.phase_rad), color=INK, linewidth=0.6)
        lower.set_ylabel("phase [°]")
        lower.set_yticks([-180, 0, 180])
        lower.tick_params(labelbottom=lower is panels[-1][0])
    panels[-1][0].set_xlabel("frequency [Hz]")
    add_legend(figure.axes[grid.rows])
    return figure


def _split_panel(figure: Figure, axes: Axes) -> Axes:
    """Leave the lower third of a panel to its axes, and add new axes above it."""
    left, bottom, width, height = axes.get_position().bounds
    axes.set_position((left, bottom, width, 0.3 * height))
    return figure.add_axes((left, bottom + 0.37 * height, width, 0.63 * height))


@render_svg
def draw_boxes(modes: Sequence[Mode]) -> Figure:
    """Damping ratios per group of span modes: quartiles, median, every mode, outliers as crosses."""
    groups = sorted({mode.group for mode in modes if mode.group is not None})
    figure, axes = add_panel(FULL, 2.2)
    for number in groups:
        members = [mode for mode in modes if mode.group == number and mode.certain and not mode.lateral]
        if members:
            add_box(axes, np.array([100 * mode.damping_ratio for mode in members]), number)
        for mode in members:
            marker = "x" if mode.outlier else "o"
            ratio = 100 * mode.damping_ratio
            axes.plot(number + 0.36, ratio, marker, color=INK, markerfacecolor="white")
    axes.set_xlim(0.4, (groups[-1] if groups else 1) + 0.8)
    axes.set_xticks(groups, [str(number) for number in groups])
    axes.set_ylim(bottom=0)
    axes.set(xlabel="group of span modes (circles: modes; crosses: outliers)", ylabel="damping ratio [%]")
    return figure


@render_svg
def draw_damping(modes: Sequence[Mode]) -> Figure:
    """Damping ratio over frequency with nominal 95 % intervals; open markers: uncertain modes."""
    figure, axes = add_panel(FULL, 2.2)
    kinds = (
        ("certain", "o", INK, [mode for mode in modes if mode.certain and not mode.lateral]),
        ("uncertain", "o", "white", [mode for mode in modes if not mode.certain and not mode.lateral]),
        ("lateral", "s", GREY, [mode for mode in modes if mode.lateral]),
    )
    for label, marker, face, shown in kinds:
        if shown:
            axes.errorbar(
                [mode.frequency_Hz for mode in shown],
                [100 * mode.damping_ratio for mode in shown],
                yerr=[196 * mode.damping_ratio_std for mode in shown],
                fmt=marker,
                color=INK,
                markerfacecolor=face,
                elinewidth=0.8,
                capsize=2,
                label=label,
            )
    certain = [100 * mode.damping_ratio for mode in modes if mode.certain]
    # The scale follows the certain modes: one uncertain mode with a large ratio would flatten all others.
    axes.set_ylim(0, 1.4 * max(certain) if certain else None)
    axes.margins(x=0.02)
    axes.set(xlabel="frequency [Hz]", ylabel="damping ratio [%]")
    add_legend(axes)
    return figure


# Model order: poles of each order of the search, and poles after each step.
STEPS_SHARE = 0.28
"""Share of the upper panel, which shows the steps, in the height of both."""

LEGEND_SHARE = 0.1
"""Share of the legend between the panels."""


@render_svg
def draw_order_search(search: OrderSearch) -> Figure:
    """Steps of the search above the stabilisation diagram; `order_search` of a line with bands."""
    grid = PanelGrid(FULL, 2.4, left=1.35, top=0.1)
    figure, panels = add_panels(grid)
    lower = panels[0][0]
    left, bottom, width, height = lower.get_position().bounds
    lower.set_position((left, bottom, width, (1 - LEGEND_SHARE - STEPS_SHARE) * height))
    upper = figure.add_axes((left, bottom + (1 - STEPS_SHARE) * height, width, STEPS_SHARE * height))
    _draw_steps(upper, search.steps)
    _draw_orders(lower, search.bands)
    upper.set_xlim(lower.get_xlim())
    return figure


def _draw_steps(axes: Axes, steps: Sequence[SearchStep]) -> None:
    """One row of ticks per step, from the top."""
    for row, step in enumerate(steps):
        frequency = step.frequency_Hz
        axes.plot(frequency, np.full(len(frequency), -row), "|", color=INK, markersize=7, markeredgewidth=0.8)
    axes.set_yticks([-row for row in range(len(steps))], [f"{step.name}: {len(step.frequency_Hz)}" for step in steps])
    axes.set_ylim(0.6 - len(steps), 0.6)
    axes.tick_params(labelbottom=False, length=0)
    axes.grid(visible=False)


def _draw_orders(axes: Axes, bands: Sequence[BandOrders]) -> None:
    """Poles over frequency and order, and the selected order of each band."""
    order = np.concatenate([np.array(band.order) for band in bands])
    frequency = np.concatenate([np.array(band.frequency_Hz) for band in bands])
    chosen = np.concatenate([np.array(band.stable) for band in bands]).astype(bool)
    axes.plot(frequency[~chosen], order[~chosen], ".", color=SHADES[3], markersize=3, label="unstable pole")
    axes.plot(frequency[chosen], order[chosen], ".", color=INK, markersize=3, label="stable pole")
    axes.hlines(
        [band.selected_order for band in bands],
        [band.from_Hz for band in bands],
        [band.to_Hz for band in bands],
        color=SHADES[2],
        linewidth=4.0,
        zorder=1,
        label="selected order",
    )
    axes.set(xlabel="frequency [Hz]", ylabel="order")
    axes.set_xlim(bands[0].from_Hz, bands[-1].to_Hz)
    axes.set_ylim(0, max(order.max(initial=1), 1) + 1)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3, borderaxespad=0.1)


# Spectral lines in the half-power band of each mode over frequency.
@render_svg
def draw_half_power(modes: Sequence[Mode], recommended: int) -> Figure:
    """Number of spectral lines over frequency; open markers: uncertain or lateral modes; dashed: recommended number."""
    figure, axes = add_panel(FULL, 1.7)
    for reliable, face in ((True, SHADES[1]), (False, "white")):
        shown = [mode for mode in modes if (mode.certain and not mode.lateral) == reliable]
        points = [(mode.frequency_Hz, mode.half_power_points) for mode in shown if mode.half_power_points]
        if points:
            label = "certain mode" if reliable else "uncertain or lateral mode"
            axes.plot(*zip(*points, strict=True), "o", color=INK, markerfacecolor=face, markersize=3.5, label=label)
    axes.axhline(recommended, color=INK, linestyle=LIMIT_LINE, linewidth=0.9)
    axes.set(xlabel="frequency [Hz]", ylabel="lines in the half-power band")
    axes.set_ylim(bottom=0)
    axes.margins(x=0.03)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=2, borderaxespad=0.2)
    return figure


# Magnitude of the frequency responses in the range of the first two groups of span modes.
@render_svg
def draw_response_zoom(data: RecordResponses, modes_Hz: list[float], zoom: tuple[float, float]) -> Figure:
    """Magnitude of the accelerance of every sensor in a range of frequencies [Hz], with ticks at the modes."""
    n, low, high = len(data.channels), *zoom
    columns = min(n, 2)
    grid = PanelGrid(
        FULL, 1.35, rows=-(-n // columns), columns=columns, left=0.65, top=0.35, between_rows=0.22, between_columns=0.75
    )
    figure, panels = add_panels(grid)
    frequency = np.array(data.frequency_Hz)
    shown = (frequency >= low) & (frequency <= high)
    ticks = [mode for mode in modes_Hz if low <= mode <= high]
    flat = [axes for row in panels for axes in row]
    for axes, channel, measured, identified in zip(flat, data.channels, data.measured, data.identified, strict=False):
        axes.plot(
            frequency[shown], np.array(measured.magnitude)[shown], color=SHADES[3], linewidth=2.4, label="measured"
        )
        axes.plot(frequency[shown], np.array(identified.magnitude)[shown], color=INK, linewidth=0.8, label="identified")
        use_decades(axes)
        axes.plot(
            ticks, np.ones(len(ticks)), "|", color=INK, markersize=6, transform=axes.get_xaxis_transform(),
            clip_on=False,
        )  # fmt: skip
        axes.set_xlim(low, high)
        axes.set_ylabel(f"{channel} [m/s²/N]")
    for axes in flat[: -len(panels[-1])]:
        axes.tick_params(labelbottom=False)
    for axes in panels[-1]:
        axes.set_xlabel("frequency [Hz]; ticks: identified modes")
    for axes in flat[n:]:
        axes.set_axis_off()
    flat[0].legend(loc="lower left", bbox_to_anchor=(0, 1.04), ncols=2, borderaxespad=0.2)
    return figure
