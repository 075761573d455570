"""Figure of the resolving power of the library cases.

python -m verification.tables.resolving_figure [--out docs/resolving-power.svg]
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from pantocheck.conformance.cases.input_studies import ResolvingPowerFile, find_resolving_power
from pantocheck.conformance.core.figure_style import FULL, INK, SHADES, render_svg
from verification.tables.resolving_power import CASES

OUT = Path("docs/resolving-power.svg")
MARKERS = "os^Dv<>p"
DIRECTIONS = {"down": "smaller values: error [%]", "up": "larger values: error [%]"}


def select_rows(files: Sequence[ResolvingPowerFile]) -> list[str]:
    """Inputs with relative errors that at least one case supports, in the order of the list."""
    rows = [row for file in files for row in file.input if row.unit == "%" and row.not_applicable is None]
    return list(dict.fromkeys(row.name for row in rows))


@render_svg
def draw_power(files: Sequence[ResolvingPowerFile]) -> Figure:
    """Smallest noticed error of every input by case; an open mark is the largest tried error, which passes."""
    names = select_rows(files)
    figure = Figure(figsize=(FULL, 0.2 * len(names) + 1.1))
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (key, title) in zip(panels, DIRECTIONS.items(), strict=True):
        for number, file in enumerate(files):
            bounds = {row.name: bound for row in file.input if (bound := getattr(row, key)) is not None}
            offset = 0.18 * (number - (len(files) - 1) / 2)
            colour = SHADES[number % len(SHADES)]
            axes.plot([], [], MARKERS[number], color=colour, label=file.case)
            for place, name in enumerate(names):
                if (bound := bounds.get(name)) is not None:
                    error = bound.noticed or bound.passed
                    fill = "white" if bound.noticed is None else colour
                    axes.plot(error, place + offset, MARKERS[number], ms=3.5, color=colour, markerfacecolor=fill)
        axes.set_xscale("log")
        axes.set_xticks([0.1, 1, 10, 100], ["0.1", "1", "10", "100"])
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set(xlabel=title, xlim=(0.1, 1000) if key == "up" else (0.1, 130))
        axes.grid(visible=True, axis="both", linewidth=0.3, color=INK, alpha=0.2)
    panels[0].set_yticks(range(len(names)), names)
    panels[0].set_ylim(len(names) - 0.5, -0.5)
    panels[0].invert_xaxis()
    panels[1].legend(loc="lower right", bbox_to_anchor=(1, 1.01), ncols=2)
    return figure


def main() -> None:
    """Draw the stored files."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--out", type=Path, default=OUT, help="figure to write")
    files = [file for name in CASES if (file := find_resolving_power(name)) is not None]
    options.parse_args().out.write_text(draw_power(files), encoding="utf-8")


if __name__ == "__main__":
    main()
