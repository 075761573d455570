"""Adversary: an optimiser that changes results of a record that fails, until `verify --numbers-only` accepts a PASS.

    python -m verification.attacks.adversary [--seeds 1 2] [--minutes 60]

The distance to PASS is the number of contradictions, plus the distances of the failing values beyond their limits. A
PASS of another case, of limits that are stated as changed, or of accepted unconfirmed records is none: page 1 names
them. The optimiser accepts a step that does not raise the distance, and now and then one that does. It has three kinds
of steps.

* `fields`: one field of the results, whichever, is changed; verdicts, margins and remarks follow, or do not.
* `samples`: samples of one embedded signal, whichever, are changed, and nothing else; or a field is changed.
* `record`: the same, and everything that follows from the samples is made again by the suite, with the rows of the
  consistency checks.

The last one is no longer a change of a document: whoever can run the suite can write everything from an invented
record. Only the record, a new run or a signature shows that. The other two must not succeed; the exit code is 1 if they
do, or if `verify` ends with another error than a refusal.
"""

import argparse
import copy
import math
import random
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from hashlib import sha256
from inspect import getsource
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.document_reading import ResultsFile
from pantocheck.conformance.documents.repetition_check import check_record_quantities
from pantocheck.conformance.documents.verification import Verification, verify_certificate
from pantocheck.conformance.results.results_format import Results
from verification.attacks.consistent_results import (
    Tree,
    adopt_widths,
    case_of,
    change_signal,
    follow_checks,
    follow_signals,
    regrade,
)
from verification.attacks.field_walk import Path_, Place, apply_change, list_places, list_values, read_place
from verification.attacks.forgeries import CASE, find_outcome, grade_record, simulate_failing

CONTRADICTION = 0.1
"""Weight of a contradiction against a distance beyond a limit, relative to the width of the limits."""

COOLING = 0.02
"""Probability of a step that raises the distance."""

DECISIVE = ("criteria", "quantities", "verdict", "uncertainty", "conformity")
"""Parts of the names of fields of which verdicts are made."""

REFUSED = math.inf
"""Distance of results that the format refuses, or that are none of the case and its limits."""

CRASHES: Counter[str] = Counter()
"""Errors of `verify` that are no refusal of a file."""

Step = Callable[[Tree, random.Random], Tree]


def verify_results(tree: Tree) -> Verification:
    """Verification of results as a file."""
    results = Results.model_validate(tree)
    return verify_certificate(ResultsFile("results.json", results.to_json(), results))


def measure_distance(tree: Tree) -> tuple[float, Verification | None]:
    """Distance of results from a PASS without a contradiction, which has the distance 0."""
    try:
        verification = verify_results(tree)
    except (ValidationError, InputError, UnicodeEncodeError):
        return REFUSED, None
    except Exception:  # a defect of its own: `verify` must refuse every file with a reason
        text = traceback.format_exc()
        CRASHES[text] += 1
        if CRASHES[text] == 1:
            print(text, file=sys.stderr, flush=True)
        return REFUSED, None
    results = verification.results
    named = [(case.id, case.library, case.limit_changes, case.profile) for case in results.cases]
    if named != [(CASE, "identical", [], None)] or results.accepted_unconfirmed:
        return REFUSED, None
    verified = [row for case in results.cases if case.verification for row in case.verification.criteria]
    rows = [*(row for case in results.cases for row in case.criteria), *verified]
    failing = [row for row in rows if row.verdict in ("fail", "undecided")]
    beyond = sum(max(0.01, -(row.margin or 0.0)) for row in failing)
    missed = verification.verdict != "pass", verification.state != "consistent"
    if not any(missed):
        return 0.0, verification  # values that fail for information do not matter
    return CONTRADICTION * len(verification.discrepancies) + beyond + 0.5 * sum(missed), verification


def change_field(tree: Tree, chance: random.Random) -> Tree:
    """Change one field, or its value wherever it stands; half of the time, the rest is graded again.

    Half of the fields are drawn from those of which the verdict is made.
    """
    places = list(list_places(Results.model_validate(tree), [Results]))
    fields = sorted({place.field for place in places})
    decisive = [field for field in fields if any(part in field for part in DECISIVE)]
    field = chance.choice(chance.choice([fields, decisive]))
    alike = [place for place in places if place.field == field]
    place = chance.choice(alike)
    values = list(_list_other_values(tree, place, alike, chance))
    if not values:
        return tree
    value, stored = chance.choice(values), read_place(tree, place.path)
    everywhere = isinstance(stored, float | str) and isinstance(value, float | str) and chance.random() < 0.5
    changed: Tree = _replace(tree, stored, value) if everywhere else apply_change(tree, place.path, value)
    return grade_again(changed) if chance.random() < 0.5 else changed


def _list_other_values(tree: Tree, place: Place, alike: list[Place], chance: random.Random) -> Iterator[Any]:
    """Values by the types of a place, a number near it, the value of a place alike, and a part less."""
    stored = read_place(tree, place.path)
    yield from list_values(place, stored)
    yield copy.deepcopy(read_place(tree, chance.choice(alike).path))
    if isinstance(place.value, float):
        yield from (place.value * (1 + chance.gauss(0, 0.1)), place.value + chance.gauss(0, 1.0))
    if isinstance(stored, list) and stored:
        left_out = chance.randrange(len(stored))
        yield [*stored[:left_out], *stored[left_out + 1 :]]
    if isinstance(stored, dict) and stored:
        other = chance.choice(sorted(stored))
        yield {key: value for key, value in stored.items() if key != other}


def _replace(tree: Any, old: float | str, new: float | str) -> Any:
    """Copy of a tree with a number or text replaced everywhere."""
    if isinstance(tree, dict):
        return {key: _replace(value, old, new) for key, value in tree.items()}
    if isinstance(tree, list):
        return [_replace(value, old, new) for value in tree]
    return new if type(tree) is type(old) and tree == old else tree


def grade_again(tree: Tree) -> Tree:
    """Results with verdicts, margins and remarks that follow from their numbers."""
    graded = Results.model_validate(tree).to_dict()
    regrade(graded)
    return graded


def draw_change(chance: random.Random) -> Callable[[RealArray], RealArray]:
    """Random change of a signal, in parts of its standard deviation: level, dynamic part, a bump, and one sample."""
    level, scale, single = chance.gauss(0, 0.02), 1 + chance.gauss(0, 0.02), chance.gauss(0, 0.1)
    place, width, height = chance.random(), 10 ** chance.uniform(0.5, 2.5), chance.gauss(0, 0.1)
    kind, cut = chance.randrange(4), chance.random()

    def change(signal: RealArray) -> RealArray:
        mean, spread = float(np.nanmean(signal)), float(np.nanstd(signal)) or 1.0
        samples = np.arange(signal.size)
        bump = height * np.exp(-(((samples - place * signal.size) / width) ** 2))
        peak = np.where(samples == int(cut * signal.size), single, 0.0)
        return signal + (level * spread, (scale - 1) * (signal - mean), spread * bump, spread * peak)[kind]

    return change


def list_signals(signals: Tree) -> Iterator[Path_]:
    """Paths of all embedded signals."""
    for number, part in signals["pantographs"].items():
        yield from (("pantographs", number, key) for key, value in part.items() if isinstance(value, dict))
    yield from (("uplift", index, "uplift_m") for index in range(len(signals["uplift"])))
    yield from ((key,) for key in ("time_s", "last_position_m") if isinstance(signals[key], dict))


def change_samples(tree: Tree, chance: random.Random) -> Tree:
    """Change samples of one signal alone; half of the time, a field is changed in place of it."""
    if chance.random() < 0.5:
        return change_field(tree, chance)
    changed = copy.deepcopy(tree)
    signals = case_of(changed)["signals"]
    change_signal(signals, chance.choice(list(list_signals(signals))), draw_change(chance))
    return changed


def change_record(tree: Tree, chance: random.Random) -> Tree:
    """Change samples of one signal, and make all that follows from them again."""
    changed = copy.deepcopy(tree)
    case = case_of(changed)
    change_signal(case["signals"], chance.choice(list(list_signals(case["signals"]))), draw_change(chance))
    follow_signals(case)
    follow_checks(case)
    regrade(changed)
    adopt_widths(case_of(changed))
    return changed


STEPS: dict[str, Step] = {"fields": change_field, "samples": change_samples, "record": change_record}

REFUSALS = (ValidationError, InputError, ArithmeticError, ValueError, TypeError, KeyError, IndexError)
"""Errors of the suite on results from which it can make nothing again."""


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
        except REFUSALS:
            continue
        there, found = measure_distance(tried)
        if found is not None and (there <= here or chance.random() < COOLING):
            current, here = tried, there
            if there < best[0]:
                best = (there, tried, found)
        elif chance.random() < COOLING:
            current, here = best[1], best[0]
    return trials, best[0], best[1], best[2]


def code_digest() -> str:
    """Digest of the steps, the distance and the search, without spaces: the table states it."""
    parts = (measure_distance, change_field, _list_other_values, _replace, draw_change, list_signals, change_samples)
    text = "".join(map(getsource, (*parts, change_record, optimise)))
    return sha256("".join(text.split()).encode()).hexdigest()[:12]


def main() -> int:
    """Run the optimiser with every kind of step and seed, and print the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--steps", nargs="+", choices=STEPS, default=list(STEPS))
    parser.add_argument("--minutes", type=float, default=60.0, help="processor time of all searches")
    options = parser.parse_args()
    minutes, broken = options.minutes / (len(options.seeds) * len(options.steps)), False
    heading = ("steps", "seed", "minutes", "trials", "distance at the start", "smallest distance")
    heading += ("verdict", "contradictions", "`--record`", "code")
    print(f"| {' | '.join(heading)} |\n|{'---|' * len(heading)}")
    with tempfile.TemporaryDirectory() as name:
        tree = grade_record(simulate_failing(), Path(name))
        start, _ = measure_distance(tree)
        for kind in options.steps:
            for seed in options.seeds:
                begin = time.process_time()
                trials, distance, best, found = optimise(tree, STEPS[kind], seed, 60 * minutes)
                results, file = Results.model_validate(best), Path(name, "run.h5")
                record = find_outcome(partial(check_record_quantities, results, file))
                spent = (time.process_time() - begin) / 60
                facts = (kind, seed, f"{spent:.1f}", trials, f"{start:.3g}", f"{distance:.3g}")
                facts += (found.verdict, len(found.discrepancies), record, code_digest())
                print(f"| {' | '.join(map(str, facts))} |", flush=True)
                if kind != "record" and distance == 0:
                    broken = True
                    Path(f"adversary-{kind}-{seed}.json").write_bytes(Results.model_validate(best).to_json())
    return 1 if broken or CRASHES else 0


if __name__ == "__main__":
    sys.exit(main())
