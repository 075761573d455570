"""Wall time per simulated time on AC simple at 320 km/h; prints the tables of docs/speed.md.

python -m verification.speed.speed

Process time on one core is measured after compilation, so that other work on the machine has little influence.
"""

import argparse
import importlib.util
import math
import os
import resource
import subprocess
import sys
import time
from dataclasses import replace
from importlib.metadata import version

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from pantocheck.model import DiscretisedLine, Passage, discretise, simulate_passage
from pantocheck.model.dynamics.core_choice import CORE_VARIABLE
from verification.speed.passage_lines import ac_simple, passage, staggered, vertical

STEP, ELEMENT = 1e-3, 0.5
SPANS = (10, 20, 30, 40, 60)
RUN_SPANS = 4
"""Simulated spans, for any length of the line."""
KEPT_BEHIND = 82.5
"""Distance behind the train with known motion [m]: 1.5 spans, as in `pantocheck run`."""
WHOLE_RUN = 14
"""Simulated spans on a line of 20 spans, with the second pantograph 200 m behind the first."""


def measure(line: DiscretisedLine, way: Passage) -> tuple[float, np.ndarray]:
    """Process time per simulated time with the set-up, the better of two simulations, and the contact force."""
    simulate_passage(line, replace(way, duration=0.01))
    best, force = math.inf, np.zeros(0)
    for _ in range(2):
        own = replace(line)  # a line that no other simulation has set up
        begin = time.process_time()
        force = simulate_passage(own, way).force
        best = min(best, time.process_time() - begin)
    return best / way.duration, force


def measure_kernel(
    spans: int, pantographs: int, plane: bool, reach: float | None, run_spans: float = RUN_SPANS
) -> tuple[float, float]:
    """Process time per simulated time, and the standard deviation of the leading pantograph's force [-, N]."""
    case = ac_simple(spans)
    built = staggered(case)
    line = discretise(vertical(case, discretise(built, ELEMENT).state) if plane else built, ELEMENT)
    way = passage(case, line, STEP, pantographs, 55.0 * (1 + run_spans), math.inf)
    window = {"kept_behind": KEPT_BEHIND} if reach is None else {"reach": reach}
    ratio, force = measure(line, replace(way, **window))
    return ratio, float(force[0].std())


def measure_memory(spans: int) -> float:
    """Peak memory of a process that simulates one case with stagger and two pantographs [MB]."""
    code = f"from verification.speed import speed; speed.measure_kernel({spans}, 2, False, None)"
    command = [sys.executable, "-c", code]
    subprocess.run(command, check=True, timeout=600)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024


def compare_reference_kernel() -> None:
    """Compare the kernel with the reference kernel, which factors in every iteration, in the vertical plane."""
    case = ac_simple(20)
    line = discretise(vertical(case, discretise(staggered(case), ELEMENT).state), ELEMENT)
    way = replace(passage(case, line, STEP, 2, 55.0 * 3, math.inf), duration=0.5)
    print("\n| kernel, 20 spans, vertical plane, 2 pantographs, 0.5 s | process time / simulated time | sigma [N] |")
    print("| :-- | --: | --: |")
    found = []
    for name, demanded in (("kernel", {}), ("reference kernel", {CORE_VARIABLE: "reference"})):
        os.environ |= demanded
        ratio, force = measure(line, way)
        print(f"| {name} | {ratio:.3f} | {force[0].std():.4f} |", flush=True)
        found.append(force)
    del os.environ[CORE_VARIABLE]
    print(f"\nLargest difference of the force {np.abs(found[1] - found[0]).max():.1e} N.")


def compare_general_engine() -> None:
    """Compare the kernel with Exudyn on the same matrices of one line in the vertical plane."""
    print("\n| solver, 10 spans, vertical plane, 2 pantographs, 1 s | process time / simulated time | sigma [N] |")
    print("| :-- | --: | --: |")
    case = ac_simple(10)
    line = discretise(vertical(case, discretise(staggered(case), ELEMENT).state), ELEMENT)
    way = replace(passage(case, line, STEP, 2, 55.0 * 3, math.inf), duration=1.0)
    ratio, force = measure(line, way)
    print(f"| kernel | {ratio:.3f} | {sigmas(force)} |", flush=True)
    if importlib.util.find_spec("exudyn") is None:
        print("| Exudyn | not installed: `pip install 'pantocheck[peers]'` | |")
        return
    from verification.guide.peers.exudyn_engine import run_exudyn

    run_exudyn(line, replace(way, duration=0.01))
    theirs, spent, in_python = min((run_exudyn(line, way) for _ in range(2)), key=lambda result: result[1])
    print(f"| Exudyn {version('exudyn')} | {spent / way.duration:.2f} | {sigmas(theirs)} |")
    print(f"\nLargest difference of the force {np.abs(theirs - force).max():.1e} N.")
    print(f"Our Python functions for droppers and contact take {in_python / spent:.0%} of Exudyn's time.")


def sigmas(force: np.ndarray) -> str:
    """Standard deviation of each pantograph's force."""
    return ", ".join(f"{sigma:.4f}" for sigma in force.std(axis=1))


def main() -> None:
    """Measure and print."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    print("| plane | pantographs | whole line | wave front | 220 m |\n| :-- | --: | --: | --: | --: |")
    for plane in (True, False):
        for pantographs in (1, 2):
            ratios = [measure_kernel(20, pantographs, plane, reach, WHOLE_RUN)[0] for reach in (math.inf, None, 220.0)]
            cells = " | ".join(f"{ratio:.3f}" for ratio in ratios)
            print(f"| {'vertical' if plane else 'with stagger'} | {pantographs} | {cells} |", flush=True)
    print("\n| spans | whole line | wave front | 660 m |\n| --: | --: | --: | --: |")
    for spans in SPANS:
        ratios = [measure_kernel(spans, 2, False, reach)[0] for reach in (math.inf, None, 660.0)]
        print(f"| {spans} | {' | '.join(f'{ratio:.3f}' for ratio in ratios)} |", flush=True)
    print(f"\nMemory of a process with stagger, 2 pantographs, 60 spans: {measure_memory(60):.0f} MB.")
    compare_reference_kernel()
    compare_general_engine()


if __name__ == "__main__":
    main()
