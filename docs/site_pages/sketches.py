"""Sketches of pages: steps with arrows, the screen of a terminal, and a sheet of a workbook."""

import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pantocheck.conformance.core.figure_style import FULL, GREY, INK, PALE, render_svg
from site_pages.page_run import build_environment

LINE_INCH = 0.145
"""Height of a line of a terminal [in]."""


def start_sketch(width: float, height: float, across: float, up: float) -> tuple[Any, Any]:
    """Figure of a size [in] with axes without frame, from 0 to `across` and `up`."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    figure.set_layout_engine("none")
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, across), ylim=(0, up))
    axes.set_axis_off()
    return figure, axes


@render_svg
def draw_steps(*steps: str, joined: bool = True) -> Any:
    """Steps from left to right, joined by arrows; a step has a title and, behind a vertical bar each, further lines."""
    figure, axes = start_sketch(FULL, 1.15, len(steps), 1)
    for number, step in enumerate(steps):
        title, *lines = step.split("|")
        box = {"boxstyle": "square,pad=0", "facecolor": PALE, "edgecolor": GREY}
        axes.add_patch(_rectangle(number + 0.05, 0.08, 0.8, 0.84, box))
        axes.text(number + 0.45, 0.74, title, ha="center", va="center", fontsize=8.5, weight="bold")
        axes.text(number + 0.45, 0.36, "\n".join(lines), ha="center", va="center", fontsize=7.5)
        if number and joined:
            style = {"arrowstyle": "-|>", "color": INK, "linewidth": 1}
            axes.annotate("", (number + 0.05, 0.5), (number - 0.15, 0.5), arrowprops=style)
    return figure


def _rectangle(x: float, y: float, width: float, height: float, box: dict[str, Any]) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((x, y), width, height, facecolor=box["facecolor"], edgecolor=box["edgecolor"], linewidth=0.8)


@render_svg
def draw_screen(lines: Sequence[str]) -> Any:
    """Screen of a terminal of 80 columns."""
    figure, axes = start_sketch(FULL, LINE_INCH * (len(lines) + 1), 1, len(lines) + 1)
    axes.add_patch(_rectangle(0, 0, 1, len(lines) + 1, {"facecolor": PALE, "edgecolor": GREY}))
    for number, line in enumerate(lines, 1):
        weight = "bold" if line.startswith("$ ") else "normal"
        place = (0.015, len(lines) + 0.75 - number)
        axes.text(*place, line[:96].replace(" ", "\u00a0"), family="DejaVu Sans Mono", fontsize=7.3, weight=weight)
    return figure


def draw_commands(folder: Path, *commands: str, most: int = 16) -> str:
    """Screen with the output of commands that run in a folder; long output is cut."""
    lines: list[str] = []
    for command in commands:
        printed = list_output(folder, command)
        lines += [f"$ {command}", *printed[:most], *(["..."] if len(printed) > most else [])]
    return draw_screen(lines)


def list_output(folder: Path, command: str) -> list[str]:
    """Lines that a command prints; exit codes of verdicts are no failure."""
    arguments = ["bash", "-c", command]
    done = subprocess.run(arguments, cwd=folder, env=build_environment(), capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1, 3) or not done.stdout:
        raise RuntimeError(f"{command} ended with exit code {done.returncode}: {done.stderr}")
    return [line for line in done.stdout.splitlines() if line.strip()]


@render_svg
def draw_sheet(rows: Sequence[Sequence[str]], note: str) -> Any:
    """Part of a sheet of a workbook, with the note that its selected cell shows."""
    columns = len(rows[0])
    figure, axes = start_sketch(FULL, 0.2 * (len(rows) + 2), columns + 0.4, len(rows) + 2)
    for number, row in enumerate(rows):
        below = len(rows) - number - 0.3 + 1
        axes.text(0.2, below + 0.3, str(number + 1), ha="center", fontsize=7, color=GREY)
        for column, text in enumerate(row):
            fill = PALE if number == 0 else "white"
            axes.add_patch(_rectangle(column + 0.4, below, 1, 1, {"facecolor": fill, "edgecolor": GREY}))
            weight = "bold" if number == 0 else "normal"
            axes.text(column + 0.9, below + 0.32, text, ha="center", fontsize=7, weight=weight)
    axes.text(0.4, 0.3, note, fontsize=6.5, style="italic")
    return figure
