"""Process time of the set-up of a line and of its passages; prints a table of docs/speed.md.

python -m verification.speed.set_up
"""

import argparse
import math
import os
import time
from collections.abc import Callable
from dataclasses import replace

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from pantocheck.model import discretise, simulate_passage
from pantocheck.model.statics.elasticity import static_uplift
from verification.speed.passage_lines import ac_simple, passage, staggered, vertical

STEP, ELEMENT = 1e-3, 0.5
SPANS = (20, 60)
POSITIONS_PER_SPAN = 24
REPETITIONS = 5


def measure(action: Callable[[], object], repetitions: int = REPETITIONS) -> float:
    """Smallest process time of some repetitions [ms]."""
    best = math.inf
    for _ in range(repetitions):
        begin = time.process_time()
        action()
        best = min(best, time.process_time() - begin)
    return 1e3 * best


def print_row(spans: int, plane: bool) -> None:
    """Measure a line of AC simple with two pantographs."""
    case = ac_simple(spans)
    catenary = staggered(case)
    if plane:
        catenary = vertical(case, discretise(catenary, ELEMENT).state)
    line = discretise(catenary, ELEMENT)
    start = replace(passage(case, line, STEP, 2, 55.0 * 5, math.inf), duration=0.0)
    first = measure(lambda: simulate_passage(replace(line), start))  # a copy begins without shared results
    simulate_passage(line, start)
    positions = np.linspace(55.0, 55.0 * (spans - 1), POSITIONS_PER_SPAN * spans)
    cells = [
        f"{measure(lambda: discretise(catenary, ELEMENT)):.0f}",
        f"{first:.0f}",
        f"{measure(lambda: simulate_passage(line, start)):.1f}",
        f"{measure(lambda: static_uplift(replace(line), positions, 200.0), 1):.0f}",
    ]
    print(f"| {spans} | {'vertical' if plane else 'with stagger'} | {' | '.join(cells)} |", flush=True)


def main() -> None:
    """Measure and print."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    heads = "line at rest | first passage | further passages | elasticity along the line"
    print(f"| spans | plane | {heads} [ms] |\n| --: | :-- | --: | --: | --: | --: |")
    for spans in SPANS:
        for plane in (True, False):
            print_row(spans, plane)


if __name__ == "__main__":
    main()
