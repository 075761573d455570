"""Adversary: an optimiser that changes results of a record that fails, until `verify --numbers-only` accepts a PASS.

    python -m verification.attacks.adversary [--seeds 4] [--minutes 60]

The distance to PASS is the number of contradictions, plus the distances of the failing values beyond their limits. The
optimiser accepts a step that does not raise it, and now and then one that does. It has two kinds of steps.

* `fields`: one field of the results, whichever, is changed; verdicts, margins and remarks follow, or do not.
* `samples`: the samples of the embedded force are changed around one place, and nothing else.
* `record`: the same, and every number, curve and place that follows from the samples is made again by the suite.

The last one is no longer a change of a document: whoever can run the suite can write everything from an invented
record. Only the record, a new run or a signature shows that. The other two must not succeed; the exit code is 1 if they
do.
"""

import argparse
import copy
import math
import random
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.packed_samples import PackedSamples, pack_samples
from pantocheck.conformance.documents.document_reading import ResultsFile
from pantocheck.conformance.documents.repetition_check import check_record_quantities
from pantocheck.conformance.documents.verification import Verification, verify_certificate
from pantocheck.conformance.results.results_format import Results
from verification.attacks.field_walk import apply_change, list_places, list_values, read_place
from verification.attacks.forged_results import Tree, adopt_widths, case_of, follow_signals, regrade
from verification.attacks.forgeries import grade_record, simulate_failing

CONTRADICTION = 0.1
"""Weight of a contradiction against a distance beyond a limit, relative to the limit."""

COOLING = 0.02
"""Probability of a step that raises the distance."""

REFUSED = math.inf
"""Distance of results that the format refuses."""

Step = Callable[[Tree, random.Random], Tree]


def verify_results(tree: Tree) -> Verification:
    """Verification of results as a file."""
    results = Results.model_validate(tree)
    return verify_certificate(ResultsFile("results.json", results.to_json(), results))


def measure_distance(tree: Tree) -> tuple[float, Verification | None]:
    """Distance of results from a PASS without a contradiction, which has the distance 0."""
    try:
        verification = verify_results(tree)
    except (ValidationError, InputError):
        return REFUSED, None
    rows = [row for case in verification.results.cases for row in case.criteria if row.verdict in ("fail", "undecided")]
    beyond = sum(max(0.01, -(row.margin or 0.0)) for row in rows)
    missed = 0.0 if verification.verdict == "pass" else 0.5
    incomplete = 0.0 if verification.state == "consistent" else 0.5
    return CONTRADICTION * len(verification.discrepancies) + beyond + missed + incomplete, verification


def change_field(tree: Tree, chance: random.Random) -> Tree:
    """Change one field; half of the time, the rest is graded again."""
    places = list(list_places(Results.model_validate(tree), [Results]))
    fields = sorted({place.field for place in places})
    field = chance.choice(fields)
    place = chance.choice([place for place in places if place.field == field])
    values = list(list_values(place, read_place(tree, place.path)))
    if isinstance(place.value, float):
        values += [place.value * (1 + chance.gauss(0, 0.1)), place.value + chance.gauss(0, 1.0)]
    if not values:
        return tree
    changed: Tree = apply_change(tree, place.path, chance.choice(values))
    return grade_again(changed) if chance.random() < 0.5 else changed


def grade_again(tree: Tree) -> Tree:
    """Results with verdicts, margins and remarks that follow from their numbers."""
    graded = Results.model_validate(tree).to_dict()
    regrade(graded)
    return graded


def draw_change(chance: random.Random) -> Callable[[RealArray], RealArray]:
    """Random change of a force: its level, its dynamic part, and a bump at one place."""
    level, scale = chance.gauss(0, 0.5), 1 + chance.gauss(0, 0.02)
    place, width, height = chance.random(), 10 ** chance.uniform(0.5, 2.5), chance.gauss(0, 2.0)

    def change(force: RealArray) -> RealArray:
        mean = float(np.nanmean(force))
        bump = height * np.exp(-(((np.arange(force.size) - place * force.size) / width) ** 2))
        return mean + level + scale * (force - mean) + bump

    return change


def change_samples(tree: Tree, chance: random.Random) -> Tree:
    """Change the samples of the force alone; the values of the failing criteria are improved half of the time."""
    changed, change = copy.deepcopy(tree), draw_change(chance)
    for part in case_of(changed)["signals"]["pantographs"].values():
        part["force_N"] = pack_samples(change(PackedSamples.model_validate(part["force_N"]).unpack())).model_dump()
    return change_field(changed, chance) if chance.random() < 0.5 else changed


def change_record(tree: Tree, chance: random.Random) -> Tree:
    """Change the samples of the force, and make all that follows from them again."""
    changed = copy.deepcopy(tree)
    follow_signals(case_of(changed), draw_change(chance))
    regrade(changed)
    adopt_widths(case_of(changed))
    return changed


STEPS: dict[str, Step] = {"fields": change_field, "samples": change_samples, "record": change_record}


def optimise(tree: Tree, step: Step, seed: int, seconds: float) -> tuple[int, float, Tree, Verification]:
    """Search for a consistent PASS; ends with it, or after a processor time.

    Returns:
        trials: Number of tried steps.
        distance: Smallest distance to PASS.
        best: Results with this distance.
        verification: Their verification.
    """
    chance, trials = random.Random(seed), 0
    distance, verification = measure_distance(tree)
    assert verification is not None
    current, here = tree, distance
    best = (distance, tree, verification)
    end = time.process_time() + seconds
    while best[0] > 0 and time.process_time() < end:
        trials += 1
        try:
            tried = step(current, chance)
        except (ValidationError, InputError, ArithmeticError, ValueError, TypeError, KeyError):
            continue
        there, found = measure_distance(tried)
        if found is not None and (there <= here or chance.random() < COOLING):
            current, here = tried, there
            if there < best[0]:
                best = (there, tried, found)
        elif chance.random() < COOLING:
            current, here = best[1], best[0]
    return trials, best[0], best[1], best[2]


def main() -> int:
    """Run the optimiser with every kind of step and seed, and print the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--minutes", type=float, default=60.0, help="processor time of all searches")
    options = parser.parse_args()
    seconds, broken = 60 * options.minutes / (options.seeds * len(STEPS)), False
    print(
        "| steps | seed | trials | distance at the start | smallest distance | verdict | contradictions | `--record` |"
    )
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        tree = grade_record(simulate_failing(), Path(name))
        start, _ = measure_distance(tree)
        for kind, step in STEPS.items():
            for seed in range(1, options.seeds + 1):
                trials, distance, best, found = optimise(tree, step, seed, seconds)
                checks = check_record_quantities(Results.model_validate(best), Path(name, "run.h5"))
                record = "found" if any(check.outcome == "contradicted" for check in checks) else "-"
                facts = (kind, seed, trials, f"{start:.3g}", f"{distance:.3g}", found.verdict, len(found.discrepancies))
                print(f"| {' | '.join(map(str, facts))} | {record} |", flush=True)
                broken |= kind != "record" and distance == 0
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
