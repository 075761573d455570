"""Convergence in mesh and time on AC simple at 320 km/h; prints the tables of docs/convergence.md.

python -m verification.tables.convergence [--spans 18]
"""

import argparse
import math
import time

from pantocheck.conformance.cases.case import Case
from pantocheck.model import Catenary, discretise, simulate_passage
from verification.speed.passage_lines import ALLOWED_PCT, QUANTITIES, ac_simple, figures, passage, staggered, vertical

DEFAULT = (0.5, 1e-3)


def run_figures(case: Case, built: Catenary, element: float, step: float) -> dict[str, float]:
    """Quantities of one simulation; the analysis section is eight spans and ends two spans before the end."""
    geometry, spans = case.line.geometry, case.line.geometry.spans
    line = discretise(built, element)
    way = passage(case, line, step, 1, geometry.mid_span(spans - 1), math.inf)
    return figures(way, simulate_passage(line, way), geometry.section(spans - 9, spans - 2))


def print_table(title: str, rows: list[tuple[str, dict[str, float]]]) -> None:
    """Print a table in Markdown with the observed order and the limit of the last three rows, each step halved."""
    print(f"\n{title}\n\n| setting | {' | '.join(QUANTITIES)} |\n| :-- |{' --: |' * len(QUANTITIES)}")
    for name, values in rows:
        print(f"| {name} | {' | '.join(f'{values[q]:.3f}' for q in QUANTITIES)} |")
    orders, limits = zip(*(extrapolate([values[q] for _, values in rows[-3:]]) for q in QUANTITIES), strict=True)
    print(f"| observed order | {' | '.join(f'{order:.1f}' for order in orders)} |")
    print(f"| limit | {' | '.join(f'{limit:.3f}' for limit in limits)} |")
    default = dict(rows).get("0.5 m, 1 ms")
    if default is not None:
        errors = [100 * (default[q] / limit - 1) for q, limit in zip(QUANTITIES, limits, strict=True)]
        print(f"| error at the default [%] | {' | '.join(f'{error:+.2f}' for error in errors)} |")
        above = [q for q, error in zip(QUANTITIES, errors, strict=True) if abs(error) > ALLOWED_PCT[q]]
        print(f"\nAbove the target: {', '.join(above) or 'none'}.")


def extrapolate(values: list[float]) -> tuple[float, float]:
    """Observed order and limit of three values with steps halved twice (Richardson); order 2 if there is none."""
    first, second = values[1] - values[0], values[2] - values[1]
    order = math.log2(first / second) if second != 0 and first / second > 1 else math.nan
    ratio = 2 ** (order if 0.5 < order < 4.5 else 2.0)
    return order, values[2] + second / (ratio - 1)


def main() -> None:
    """Run and print."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--spans", type=int, default=18, help="spans of the line; the analysis section has eight")
    case = ac_simple(options.parse_args().spans)
    built = staggered(case)
    begin = time.process_time()

    def simulate(element: float, step: float, line: Catenary = built) -> tuple[str, dict[str, float]]:
        return f"{element:g} m, {1e3 * step:g} ms", run_figures(case, line, element, step)

    both = [simulate(1.0, 2e-3), simulate(*DEFAULT), simulate(0.25, 5e-4), simulate(0.125, 2.5e-4)]
    print_table("Element and time step halved together", both)
    short_step = simulate(0.5, 2.5e-4)
    print_table(
        "Element alone, time step 0.25 ms", [simulate(1.0, 2.5e-4), short_step, simulate(0.25, 2.5e-4), both[3]]
    )
    print_table("Time step alone, elements of 0.5 m", [simulate(0.5, 2e-3), both[1], simulate(0.5, 5e-4), short_step])
    plane = vertical(case, discretise(built, 0.5).state)
    print("\nStagger of 0.2 m against the vertical plane, default setting\n")
    (_, flat), (_, with_stagger) = simulate(*DEFAULT, plane), both[1]
    print(f"| | {' | '.join(QUANTITIES)} |\n| :-- |{' --: |' * len(QUANTITIES)}")
    for name, values in (("stagger", with_stagger), ("vertical plane", flat)):
        print(f"| {name} | {' | '.join(f'{values[q]:.3f}' for q in QUANTITIES)} |")
    print(f"| change [%] | {' | '.join(f'{100 * (flat[q] / with_stagger[q] - 1):+.2f}' for q in QUANTITIES)} |")
    print(f"\n{time.process_time() - begin:.0f} s of process time.")


if __name__ == "__main__":
    main()
