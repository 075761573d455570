"""Figures of an identification: spectra, frequency responses and damping ratios."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.identification.identification_format import RecordResponses, RecordSpectra
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.reports.figures.figure_style import (
    FULL,
    GREY,
    INK,
    SHADES,
    add_box,
    add_legend,
    render_svg,
    use_decades,
)
from pantocheck.conformance.reports.figures.fixed_panels import PanelGrid, add_panel, add_panels


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
    """Damping ratio over frequency with 95 % intervals; open markers: uncertain modes."""
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
