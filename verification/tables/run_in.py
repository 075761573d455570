"""Influence of the run-in on the quantities of AC simple; prints the tables of docs/run-in.md.

python -m verification.tables.run_in [--spans 72]
"""

import argparse
from dataclasses import replace

import numpy as np

from pantocheck.conformance.runs.case_run import build_passage
from pantocheck.model import discretise, simulate_passage
from verification.speed.passage_lines import QUANTITIES, ac_simple, figures, passage, staggered

EVALUATED = 10
CHOSEN = {275: 24, 320: 30}
"""Spans before the analysis section of the cases, by speed [km/h]."""
LENGTHS = (3, 6, 10, 14, 17, 20, 24, 27, 30, 35, 40, 48)
RESERVE = 10
"""Spans after the last analysis section, so that reflections from the end of the line do not reach it."""


def print_table(speed: int, spans: int) -> None:
    """Print the quantities over ten spans after an increasing run-in, and their change when the run-in is doubled."""
    case = ac_simple(spans, case=f"en50318-2018/ac-simple/{speed}")
    geometry = case.line.geometry
    line = discretise(staggered(case), 0.5)
    use = case.file.pantograph[0]
    pantographs = build_passage(case, line, case.file.discretisation, (use.uplift_force_N,)).pantographs
    way = replace(passage(case, line, 1e-3, 1, geometry.span(spans - RESERVE + 1)[1], 660.0), pantographs=pantographs)
    history = simulate_passage(line, way)

    def quantities_after(first: int) -> np.ndarray:
        """Quantities over ten spans after a number of spans."""
        return np.array(list(figures(way, history, geometry.section(first + 1, first + EVALUATED)).values()))

    print(f"\n### {speed} km/h\n\n| run-in [spans] | {' | '.join(QUANTITIES)} |")
    print(f"| --: |{' --: |' * len(QUANTITIES)}")
    for first in LENGTHS:
        if first + EVALUATED <= spans - RESERVE:
            print(f"| {first - 1} | {' | '.join(f'{value:.2f}' for value in quantities_after(first))} |")
    chosen = CHOSEN[speed]
    twice = min(2 * chosen - 1, spans - RESERVE - EVALUATED)
    change = 100 * (quantities_after(twice) / quantities_after(chosen) - 1)
    print(f"| from {chosen - 1} to {twice - 1}: change [%] | {' | '.join(f'{value:+.2f}' for value in change)} |")


def main() -> None:
    """Run and print."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--spans", type=int, default=72, help="spans of the line")
    spans = options.parse_args().spans
    for speed in CHOSEN:
        print_table(speed, spans)


if __name__ == "__main__":
    main()
