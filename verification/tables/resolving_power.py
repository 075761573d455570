"""Resolving power of the library cases: the largest error of each input that still passes.

python -m verification.tables.resolving_power [CASE ...] [--inputs NAME ...] [--like CASE] [--longest 3600]

The error grows from zero in doubling steps until a verdict changes, and the first change is bisected. Larger errors may
pass again. An input is stored as soon as it is finished; a second call continues. The uplift force of a case with a
mean force is tuned anew for every error.
"""

import argparse
import datetime
import json
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_studies import ErrorBound, InputBounds, ResolvingPowerFile, read_study
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.trust import decides_verdict
from pantocheck.conformance.grading.case_identity import limits_digest
from verification.tables.input_variations import (
    TRUST,
    CaseInput,
    Grade,
    NotApplicable,
    grade_error,
    grade_record,
    read_variations,
    simulate_varied,
)

CASES = (
    "en50318-2002/250",
    "en50318-2002/300",
    "en50318-2018/ac-simple/320",
    "en50318-2018/ac-simple/275",
    "en50318-2018/ac-simple/320-twin",
    "en50318-2018/ac-simple/275-twin",
    "en50318-2018/ac-stitched/320",
    "en50318-2018/ac-stitched/275",
)
"""Cases with counted limits or a converged solution, the cheapest first."""
OUT = Path("reference_cases/resolving-power")
COMMAND = "python -m verification.tables.resolving_power"
PRECISION = 0.1
"""Width of the bracket of a change, relative to its larger end; for small errors, to the first error."""
DOWN_PCT = 90.0
"""Largest relative error downwards, for inputs that cannot be zero."""


def find_first_change(
    grade: Callable[[float], Grade],
    passes: Callable[[Grade], bool],
    first: float,
    largest: float,
    start: float | None = None,
) -> ErrorBound:
    """First change of a verdict when the error grows from zero.

    Args:
        grade: Grade of an error.
        passes: Whether a grade lets a record pass.
        first: First error of the outward search.
        largest: Largest error of the search.
        start: First tried error, from a similar case; default: `first`. Smaller errors are taken to pass if it does.

    Returns:
        Bracket of the change; without a change, `by` is the reason why no larger error can be tried.
    """
    passed, error = 0.0, min(start or first, largest)
    try:
        while passes(grade(error)):
            passed = error
            if error >= largest:
                return ErrorBound(passed=passed)
            error = min(2 * error, largest)
    except NotApplicable as problem:
        if not passed:
            raise
        return ErrorBound(passed=passed, by=str(problem))
    while error - passed > PRECISION * max(error, first):
        middle = (passed + error) / 2
        passed, error = (middle, error) if passes(grade(middle)) else (passed, middle)
    return ErrorBound(passed=passed, noticed=error, by=grade(error).reason)


def measure_input(case: Case, item: CaseInput, similar: InputBounds | None = None) -> InputBounds:
    """Errors of an input that pass, both ways, by both verdicts and by the criteria alone.

    Args:
        case: Case.
        item: Input.
        similar: Errors of the input in a similar case, at which the search starts.
    """
    kept: dict[float, Grade] = {}

    def grade(sign: float, error: float) -> Grade:
        if sign * error not in kept:
            kept[sign * error] = grade_error(case, item, sign * error, predict_forces(case, kept, sign * error))
        return kept[sign * error]

    down = item.largest_down or (DOWN_PCT if item.shift is None else item.largest)
    bounds: dict[str, ErrorBound] = {}
    reasons = []
    for name, sign, largest in (("up", 1.0, item.largest), ("down", -1.0, down)):
        known = getattr(similar, name, None)
        start = None if known is None else known.passed or known.noticed
        search = partial(find_first_change, partial(grade, sign), first=item.first, largest=largest, start=start)
        try:
            bounds[name] = search(lambda found: found.passes)
            if any(decides_verdict(limit.trust, TRUST) for limit in case.limits):
                bounds[f"{name}_criteria"] = name_criteria(search(lambda found: found.passes_criteria))
        except NotApplicable as problem:
            reasons.append(str(problem))
    reason = {} if bounds else {"not_applicable": reasons[0]}
    return InputBounds(name=item.name, group=item.group, unit=item.unit, **reason, **bounds)


def predict_forces(case: Case, known: Mapping[float, Grade], error: float) -> tuple[float, ...]:
    """Uplift forces by a polynomial through those of the nearest errors, so that the tuning needs fewer runs [N].

    Args:
        case: Case, whose stated forces belong to the error zero.
        known: Grades by error.
        error: Error of the input.
    """
    stated = [lift.stated_uplift_force for lift in case.lift_forces]
    if None in stated:
        return ()
    forces = {0.0: stated} | {each: list(grade.uplift_forces) for each, grade in known.items() if grade.uplift_forces}
    nearest = sorted(forces, key=lambda each: abs(each - error))[:3]
    weights = [np.prod([(error - other) / (each - other) for other in nearest if other != each]) for each in nearest]
    return tuple(map(float, weights @ np.array([forces[each] for each in nearest])))


def name_criteria(bound: ErrorBound) -> ErrorBound:
    """Bound by the criteria alone: without the quantities that only the verification limits."""
    names = [name for name in bound.by.split(", ") if not name.endswith("(verification)")]
    return bound.model_copy(update={"by": ", ".join(names)})


def complete_file(
    case: Case, path: Path, longest: float, items: Sequence[CaseInput], similar: Mapping[str, InputBounds] | None = None
) -> None:
    """Measure the inputs that a file does not have yet; every finished input is stored.

    Args:
        case: Case.
        path: File of its resolving power; a file of another version of the case is replaced.
        longest: Longest processor time of the case [s].
        items: Inputs.
        similar: Errors of the inputs in a similar case, by name.

    Raises:
        ValueError: The case does not pass with its own inputs.
    """
    done: list[InputBounds] = []
    begin = time.process_time()
    if path.is_file():
        file = read_study(path, ResolvingPowerFile)
        if (file.case_digest, file.limits_digest) == (case.digest, limits_digest(case.limits)):
            done, begin = list(file.input), begin - file.processor_s
    if not done and not (own := grade_record(case, simulate_varied(case))).passes:
        raise ValueError(f"{case.id} does not pass with its own inputs: {own.reason}")
    for item in items:
        if item.name in {bounds.name for bounds in done} or time.process_time() - begin > longest:
            continue
        done.append(measure_input(case, item, (similar or {}).get(item.name)))
        print(f"{time.process_time() - begin:.0f} s  {case.id}  {done[-1]}", flush=True)
        order = [each.name for each in read_variations().input]
        done.sort(key=lambda bounds: order.index(bounds.name))
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, write_file(case, done, time.process_time() - begin).encode())


def write_file(case: Case, done: Sequence[InputBounds], processor_s: float) -> str:
    """Content of the file of a case."""
    head = (
        f"# Written by {COMMAND}; do not edit.",
        'schema = "pantocheck.resolving-power/1"',
        f'case = "{case.id}"',
        f'case_digest = "{case.digest}"',
        f'limits_digest = "{limits_digest(case.limits)}"',
        f"date = {datetime.datetime.now(tz=datetime.UTC).date()}",
        f'command = "{COMMAND} {case.id}"',
        'rule = "simple"',
        f"processor_s = {processor_s:.0f}.0",
    )
    return "\n".join([*head, *(line for bounds in done for line in _write_input(bounds))]) + "\n"


def _write_input(bounds: InputBounds) -> Iterator[str]:
    yield from ("", "[[input]]")
    for key, value in bounds.model_dump(exclude_none=True).items():
        if isinstance(value, dict):
            rounded = {name: float(f"{part:.6g}") if isinstance(part, float) else part for name, part in value.items()}
            parts = (f"{name} = {json.dumps(part)}" for name, part in rounded.items() if part != "")
            yield f"{key} = {{ {', '.join(parts)} }}"
        else:
            yield f"{key} = {json.dumps(value)}"


def read_similar(chosen: argparse.Namespace) -> dict[str, InputBounds]:
    """Stored errors of the inputs of the case of `--like`, by name; empty without it."""
    if chosen.like is None:
        return {}
    return {item.name: item for item in read_study(chosen.out / f"{chosen.like}.toml", ResolvingPowerFile).input}


def main() -> None:
    """Measure and store."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("cases", nargs="*", default=CASES, metavar="CASE")
    options.add_argument("--out", type=Path, default=OUT, help="folder to write to")
    options.add_argument("--inputs", nargs="*", metavar="NAME", help="inputs to measure; default: all")
    options.add_argument("--longest", type=float, default=3600.0, help="longest processor time of a case [s]")
    options.add_argument("--like", metavar="CASE", help="stored case at whose errors the searches start")
    chosen = options.parse_args()
    known = {case.id: case for case in select_cases(chosen.cases)}
    for name in chosen.cases:
        items = [item for item in read_variations().input if item.name in (chosen.inputs or [item.name])]
        complete_file(known[name], chosen.out / f"{name}.toml", chosen.longest, items, read_similar(chosen))


if __name__ == "__main__":
    main()
