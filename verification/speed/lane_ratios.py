"""Processor time of passages on one line in lanes over that of the same passages one after another.

python -m verification.speed.lane_ratios [--pairs 3]

The seven other starts of a case of EN 50318:2002, and eight uplift forces on AC simple. Both ways alternate, and their
results must have the same bits. The first line states the number of lanes, which depends on the processor.
"""

import argparse
import statistics
import time
from collections.abc import Sequence
from dataclasses import replace

from pantocheck.conformance.cases.library import find_library_case
from pantocheck.conformance.cases.start_and_section import list_other_starts
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.runs.case_run import build_passage, estimate_uplift_forces
from pantocheck.model import DiscretisedLine, History, Passage, simulate_passage
from pantocheck.model.dynamics.lanes import count_core_lanes, simulate_passages

STARTS, FORCES = "en50318-2002/250", "en50318-2018/ac-simple/320"
SHARES = tuple(1 + 0.01 * number for number in range(8))
"""Uplift forces over that of the case."""


def list_passages(name: str) -> tuple[DiscretisedLine, list[Passage]]:
    """Line of a case, and its passages from other starts, or with other uplift forces."""
    case = find_library_case(name)
    line, discretisation = discretise_line(case.line, case.file.discretisation.element_m), case.file.discretisation
    forces = estimate_uplift_forces(case, line)
    if name == FORCES:
        scaled = [tuple(share * force for force in forces) for share in SHARES]
        return line, [build_passage(case, line, discretisation, one) for one in scaled]
    starts = [
        (build_passage(start.case, line, discretisation, forces), start.ramp_s) for start in list_other_starts(case)
    ]
    return line, [replace(passage, ramp=ramp) for passage, ramp in starts]


def compare(line: DiscretisedLine, passages: Sequence[Passage]) -> tuple[float, float]:
    """Processor time alone and in lanes, per step of a passage [us]."""
    steps = sum(round(passage.duration / passage.time_step) for passage in passages)
    begin = time.process_time()
    alone = [simulate_passage(line, passage) for passage in passages]
    middle = time.process_time()
    together = simulate_passages(line, passages)
    end = time.process_time()
    assert [list_bits(history) for history in together] == [list_bits(history) for history in alone]
    return 1e6 * (middle - begin) / steps, 1e6 * (end - middle) / steps


def list_bits(history: History) -> list[bytes]:
    """Bits of a history."""
    return [values.tobytes() for values in (history.force, history.height, history.motion)]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=3, help="number of measurements")
    pairs = parser.parse_args().pairs
    print(f"{count_core_lanes()} lanes\n\n| case | alone [us a step] | in lanes | ratio |\n| :-- | --: | --: | --: |")
    for name in (STARTS, FORCES):
        line, passages = list_passages(name)
        simulate_passage(line, replace(passages[0], duration=passages[0].time_step))  # set-up
        found = [compare(line, passages) for _ in range(pairs)]
        alone, together = (statistics.median(times) for times in zip(*found, strict=True))
        ratio = statistics.median(b / a for a, b in found)
        print(f"| {name}, {len(passages)} passages | {alone:.1f} | {together:.1f} | {ratio:.2f} |", flush=True)


if __name__ == "__main__":
    main()
