"""Error against process time for several elements and time steps; prints a table of docs/convergence.md.

    python -m verification.speed.accuracy_and_cost [--out docs/accuracy-and-cost.svg]

AC simple at 320 km/h with stagger, 18 spans, two pantographs. The errors are those of the trailing pantograph in the
spans 7 to 12, against elements of 0.125 m and a time step of 0.25 ms.
"""

import argparse
import math
import time
from dataclasses import replace
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from pantocheck.conformance.core.figure_style import HALF, LINES, SHADES, add_legend, render_svg
from pantocheck.model import discretise, simulate_passage
from verification.speed.passage_lines import QUANTITIES, ac_simple, figures, passage, staggered

SPANS, TRAILING = 18, 2
REFERENCE = (0.125, 0.25)
HALVED = ((2.0, 4.0), (1.0, 2.0), (0.5, 1.0), (0.25, 0.5))
"""Elements [m] and time steps [ms] that are halved together: the curves of the figure."""
OTHERS = ((1.0, 1.0), (0.5, 2.0), (0.5, 0.5), (0.25, 1.0))
"""Further settings of the table."""
DRAWN = QUANTITIES[:4]
"""Standard deviation and bands."""
KEPT_BEHIND = 82.5
"""Distance behind the train with known motion [m]: 1.5 spans, as in `pantocheck run`."""

Row = dict[str, float]


def simulate(element: float, step_ms: float) -> tuple[float, Row]:
    """Process time per simulated time, set-up included, and quantities of the trailing pantograph."""
    case = ac_simple(SPANS)
    geometry = case.line.geometry
    line = discretise(staggered(case), element)
    way = passage(case, line, 1e-3 * step_ms, 2, geometry.mid_span(SPANS - 1) - 200.0, math.inf)
    way = replace(way, kept_behind=KEPT_BEHIND)
    begin = time.process_time()
    history = simulate_passage(line, way)
    spent = time.process_time() - begin
    return spent / way.duration, figures(way, history, geometry.section(SPANS - 11, SPANS - 6), TRAILING)


@render_svg
def draw(costs: list[float], errors: list[Row]) -> Figure:
    """Absolute errors of the settings that are halved together, both axes logarithmic."""
    figure = Figure(figsize=(HALF, 2.8))
    axes = figure.add_subplot()
    for name, line, shade in zip(DRAWN, LINES, SHADES, strict=True):
        axes.loglog(costs, [abs(row[name]) for row in errors], line, color=shade, marker="o", markersize=3, label=name)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_locator(NullLocator())
    axes.set_xlabel("process time / simulated time")
    axes.set_ylabel("error [%]")
    add_legend(axes, columns=2)
    return figure


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, metavar="FILE", help="figure to write (SVG)")
    out = parser.parse_args().out
    simulate(2.0, 4.0)  # compile
    _, reference = simulate(*REFERENCE)
    rows: dict[tuple[float, float], tuple[float, Row]] = {}
    print(f"| setting | process time / simulated time | {' | '.join(f'{q} [%]' for q in QUANTITIES)} |")
    print(f"| :-- | --: |{' --: |' * len(QUANTITIES)}")
    for setting in sorted((*HALVED, *OTHERS), reverse=True):
        cost, values = simulate(*setting)
        errors = {q: 100 * (values[q] / reference[q] - 1) for q in QUANTITIES}
        rows[setting] = cost, errors
        cells = " | ".join(f"{error:+.2f}" for error in errors.values())
        print(f"| {setting[0]:g} m, {setting[1]:g} ms | {cost:.3f} | {cells} |", flush=True)
    if out is not None:
        out.write_text(draw([rows[s][0] for s in HALVED], [rows[s][1] for s in HALVED]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
