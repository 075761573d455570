"""Processor time of a passage by the structure of the head, over that of one strip with a spring, in one process.

python -m verification.speed.head_ratios [--case en50318-2018/ac-simple/320] [--repetitions 30]

The passages alternate in random order, so that other loads of the machine meet all of them alike.
"""

import argparse
import random
import time
from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.runs.case_run import build_passage, estimate_uplift_forces
from pantocheck.model import Pantograph, discretise, simulate_passage
from pantocheck.model.description.head_structure import MountedStrip, Rotation, add_friction, add_stop, mount_strips

SECONDS = 1.0
"""Simulated time of a passage [s]."""

STRIPS = (MountedStrip(0.29, 3.0, 1e4, 20.0), MountedStrip(-0.25, 2.5, 1e4, 20.0))


def list_heads(pantograph: Pantograph) -> dict[str, Pantograph]:
    """Pantograph with other heads and contacts."""
    pitching = mount_strips(pantograph, STRIPS, Rotation(0.1, 50.0, 1.0))
    size = pantograph.head.size
    suspension = pitching.head * 0.0
    suspension[size - 1], suspension[size - 2] = 1.0, -1.0
    rubbing = add_stop(add_friction(pitching, suspension, 8.0, 1e-3), -suspension, 0.05, 1e5, 0.0)
    return {
        "one strip": pantograph,
        "constraint": replace(pantograph, contact_stiffness=np.inf),
        "two strips": mount_strips(pantograph, STRIPS),
        "two strips, pitch": pitching,
        "two strips, pitch, friction, stop": rubbing,
    }


def main() -> None:
    """Run and print."""
    options = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    options.add_argument("--case", default="en50318-2018/ac-simple/320")
    options.add_argument("--repetitions", type=int, default=30)
    chosen = options.parse_args()
    (case,) = (found for found in select_cases([chosen.case]) if found.id == chosen.case)
    discretisation = case.file.discretisation
    line = discretise(build_catenary(case.line), discretisation.element_m)
    passage = build_passage(case, line, discretisation, estimate_uplift_forces(case, line))
    heads = list_heads(passage.pantographs[0])
    times: dict[str, list[float]] = {name: [] for name in heads}
    names, order = list(heads), random.Random(1)
    for repetition in range(chosen.repetitions + 1):
        order.shuffle(names)
        for name in names:
            changed = replace(passage, pantographs=(heads[name],) * len(passage.pantographs), duration=SECONDS)
            begin = time.process_time()
            simulate_passage(line, changed)
            if repetition:  # the first one compiles
                times[name].append(time.process_time() - begin)
    single = np.array(times["one strip"])
    print("| head | median of the ratios | ratio of the smallest |\n| --- | --: | --: |")
    for name, values in times.items():
        print(f"| {name} | {np.median(np.array(values) / single):.3f} | {min(values) / single.min():.3f} |")


if __name__ == "__main__":
    main()
