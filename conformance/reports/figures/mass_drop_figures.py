"""Figures of the reports on mass drops, from plain data."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.identification.damping.observability import RATIO_NEEDED, SHARE_NEEDED
from pantocheck.conformance.reports.figures.force_figures import FULL, GREY, INK, LINES, SHADES, draw_box, render_svg


@render_svg
def draw_overlay(runs: list[dict[str, Any]], channel: str, unit: str) -> Figure:
    """Repeats of one drop laid over each other at the start and a minute later.

    Parameters
    ----------
    runs : list[dict[str, Any]]
        Each {"name", "windows": [{"time_s", "signal"}, ...]}.
    channel : str
        Name of the channel.
    unit : str
        Of the signal.
    """
    windows = max(len(run["windows"]) for run in runs)
    figure = Figure(figsize=(FULL, 2.4 * windows))
    axes = np.atleast_1d(figure.subplots(windows, 1))
    for w, at in enumerate(axes):
        for k, run in enumerate(runs):
            if w < len(run["windows"]):
                data = run["windows"][w]
                shade, style = SHADES[k % len(SHADES)], LINES[k % len(LINES)]
                at.plot(data["time_s"], data["signal"], style, color=shade, linewidth=1.0, label=run["name"])
        at.set_ylabel(f"{channel} [{unit}]")
    axes[-1].set_xlabel("time after the release [s]")
    _names(axes[0])
    return figure


@render_svg
def draw_spectra(data: dict[str, Any], unit: str) -> Figure:
    """Transforms of every sensor, the fit over them, what it leaves, and the identified modes."""
    n = len(data["channels"])
    figure = Figure(figsize=(FULL, 0.6 + 1.6 * n))
    axes = np.atleast_1d(figure.subplots(n, 1, sharex=True))
    for at, channel, measured, fitted, residual in zip(
        axes, data["channels"], data["measured"], data["fitted"], data["residual"], strict=True
    ):
        at.plot(data["frequency_Hz"], measured, color="#c3cad2", linewidth=2.4, label="measured")
        at.plot(data["frequency_Hz"], fitted, color=INK, linewidth=0.8, label="identified")
        at.plot(data["frequency_Hz"], residual, ":", color=GREY, linewidth=0.7, label="residual")
        at.set_yscale("log")
        ticks = np.full(len(data["poles_Hz"]), 1.0)
        at.plot(
            data["poles_Hz"], ticks, "|", color=INK, markersize=6, transform=at.get_xaxis_transform(), clip_on=False
        )
        at.set_ylabel(f"{channel} [{unit} s]")
    axes[-1].set_xlabel("frequency [Hz]; ticks: identified modes")
    _names(axes[0])
    return figure


@render_svg
def draw_responses(data: dict[str, Any]) -> Figure:
    """Accelerance of every sensor: magnitude and phase, measured and of the identified modes."""
    n = len(data["channels"])
    figure = Figure(figsize=(FULL, 0.6 + 2.2 * n))
    axes = np.atleast_2d(figure.subplots(2 * n, 1, sharex=True, height_ratios=(2, 1) * n)).reshape(n, 2)
    for (upper, lower), channel, measured, identified in zip(
        axes, data["channels"], data["measured"], data["identified"], strict=True
    ):
        upper.plot(data["frequency_Hz"], measured["abs"], color="#c3cad2", linewidth=2.4, label="measured")
        upper.plot(data["frequency_Hz"], identified["abs"], color=INK, linewidth=0.8, label="identified")
        upper.set_yscale("log")
        upper.set_ylabel(f"{channel}\n[m/s²/N]")
        lower.plot(data["frequency_Hz"], np.degrees(measured["phase_rad"]), ".", color="#c3cad2", markersize=2.5)
        lower.plot(data["frequency_Hz"], np.degrees(identified["phase_rad"]), color=INK, linewidth=0.6)
        lower.set_ylabel("phase [°]")
        lower.set_yticks([-180, 0, 180])
    axes[-1][1].set_xlabel("frequency [Hz]")
    _names(axes[0][0])
    return figure


@render_svg
def draw_boxes(modes: list[dict[str, Any]]) -> Figure:
    """Damping ratios per group of span modes: quartiles, median, every mode, outliers as crosses."""
    groups = sorted({mode["group"] for mode in modes if mode["group"] is not None})
    figure = Figure(figsize=(FULL, 2.8))
    axes = figure.subplots()
    for number in groups:
        members = [mode for mode in modes if mode["group"] == number and mode["certain"] and not mode["lateral"]]
        values = np.array([100 * mode["damping_ratio"] for mode in members])
        if not values.size:
            continue
        draw_box(axes, values, number)
        for mode, value in zip(members, values, strict=True):
            axes.plot(
                number + 0.36, value, "x" if mode["outlier"] else "o", color=INK, markersize=4, markerfacecolor="white"
            )
    axes.set_xlim(0.4, (groups[-1] if groups else 1) + 0.8)
    axes.set_xticks(groups, [str(number) for number in groups])
    axes.set_ylim(bottom=0)
    axes.set_xlabel("group of span modes (discs: modes; crosses: outliers)")
    axes.set_ylabel("damping ratio [%]")
    return figure


@render_svg
def draw_damping(modes: list[dict[str, Any]]) -> Figure:
    """Damping ratio against frequency with 95 % intervals; open where it is uncertain."""
    figure = Figure(figsize=(FULL, 2.8))
    axes = figure.subplots()
    kinds = (
        ("certain", "o", INK, [m for m in modes if m["certain"] and not m["lateral"]]),
        ("uncertain", "o", "white", [m for m in modes if not m["certain"] and not m["lateral"]]),
        ("lateral", "s", GREY, [m for m in modes if m["lateral"]]),
    )
    for label, marker, face, shown in kinds:
        if shown:
            axes.errorbar(
                [m["frequency_Hz"] for m in shown],
                [100 * m["damping_ratio"] for m in shown],
                yerr=[196 * m["damping_ratio_std"] for m in shown],
                fmt=marker,
                color=INK,
                markerfacecolor=face,
                markersize=4,
                elinewidth=0.8,
                capsize=2,
                label=label,
            )
    certain = [100 * m["damping_ratio"] for m in modes if m["certain"]]
    # One wild uncertain mode must not press all others flat.
    axes.set_ylim(0, 1.4 * max(certain) if certain else None)
    axes.margins(x=0.02)
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("damping ratio [%]")
    _names(axes)
    return figure


@render_svg
def draw_observability(rows: list[dict[str, Any]]) -> Figure:
    """For each coefficient: its largest share of a mode's damping, and its plausible value over its uncertainty."""
    names = [f"{row['kind'].replace('_', ' ')}, {row['matrix']}" for row in rows]
    places = np.arange(len(rows))
    figure = Figure(figsize=(FULL, 0.9 + 0.24 * len(rows)))
    left, right = figure.subplots(1, 2, sharey=True)
    fills = ["#6b747e" if row["observable"] else "white" for row in rows]
    left.barh(places, [100 * row["largest_share"] for row in rows], color=fills, edgecolor=INK, linewidth=0.7)
    left.axvline(100 * SHARE_NEEDED, color=INK, linestyle="--", linewidth=0.9)
    left.set_xlabel("largest share of a mode's damping [%]")
    left.set_yticks(places, names)
    left.invert_yaxis()
    right.barh(places, [row["plausible_over_std"] for row in rows], color=fills, edgecolor=INK, linewidth=0.7)
    right.axvline(RATIO_NEEDED, color=INK, linestyle="--", linewidth=0.9)
    right.set_xscale("symlog", linthresh=0.1)
    right.set_xlim(left=0)
    right.set_xlabel("plausible value / standard deviation [-]")
    return figure


@render_svg
def draw_comparison(data: dict[str, Any]) -> Figure:
    """Measured damping ratios and those of the models at the computed modes."""
    figure = Figure(figsize=(FULL, 3.2))
    axes = figure.subplots()
    measured = data["measured"]
    axes.errorbar(
        measured["frequency_Hz"],
        [100 * value for value in measured["damping_ratio"]],
        yerr=[196 * value for value in measured["std"]],
        fmt="o",
        color=INK,
        markersize=3.5,
        elinewidth=0.8,
        label="measured",
    )
    for (name, ratios), style, shade in zip(data["models"].items(), ("--", "-", ":"), (GREY, INK, INK), strict=False):
        axes.plot(
            data["frequency_Hz"], [100 * value for value in ratios], style, color=shade, linewidth=1.1, label=name
        )
    axes.set_ylim(0, 1.5 * max(100 * value for value in measured["damping_ratio"]))
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("damping ratio [%]")
    _names(axes)
    return figure


def _names(axes: Axes) -> None:
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.02), ncols=5, borderaxespad=0.2, columnspacing=1.4)
