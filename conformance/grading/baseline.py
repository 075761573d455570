"""Baseline: a value that drifts from earlier results fails, independent of its limits."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from pantocheck.conformance.grading.case_verdict import judge_case, read_participation
from pantocheck.conformance.grading.criterion_grading import Requirement, build_criterion
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.criterion_format import BASELINE, Criterion
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.results.results_reading import read_results

SMALLEST_SCALE = 1.0
"""Smallest reference of a relative drift, in the unit of the value: near zero, a percentage has no meaning."""

SMALLEST_RATIO_SCALE = 0.01
"""Smallest reference of a relative drift of a quantity without a unit."""

LARGEST_VALUE = 1e12
"""Largest absolute value of a baseline; values of real runs are far below."""

MOST_VALUES = 10_000
"""Largest number of values of a case of a baseline; real cases are far below."""


class _Key(NamedTuple):
    """Owner, quantity and item of one number of a case."""

    owner: str
    quantity: str
    item: int | None


def read_baseline(path: Path) -> Results:
    """Read earlier results before a run, so that no comparison fails after it.

    Raises
    ------
    InputError
        The file cannot be read, is not in the format of the suite, or its values are too many or too large.
    """
    baseline = read_results(path)
    for case in baseline.cases:
        values = [value for _, value in _numbers(case)]
        found = (
            f"{len(values)} values; at most {MOST_VALUES} can be compared"
            if len(values) > MOST_VALUES
            else next((f"a value of {value:g}" for value in values if not abs(value) <= LARGEST_VALUE), None)
        )
        if found is not None:
            raise InputError(
                f"baseline '{path.name}', case {case.id[:80]}", found, "Give results.json of an earlier run."
            )
    return baseline


def compare_with_baseline(results: Results, baseline: Results, drift_pct: float, name: str) -> Results:
    """Add a failed criterion for each value that has drifted from its baseline.

    A value of the baseline that is no longer delivered becomes a skipped criterion, so that its loss is noticed.

    Parameters
    ----------
    results : Results
        Results of this run.
    baseline : Results
        Results of the earlier run.
    drift_pct : float
        Largest accepted drift [%].
    name : str
        Name of the baseline in reports.
    """
    earlier = {case.id: case for case in baseline.cases}
    cases = [_compare_case(case, earlier.get(case.id), drift_pct, name) for case in results.cases]
    return read_participation(results).decide_run(results.model_copy(update={"cases": cases}))


def _compare_case(case: CaseResult, earlier: CaseResult | None, drift_pct: float, name: str) -> CaseResult:
    if not case.quantities:
        return case  # skipped or in error as a whole
    if earlier is None:
        return _skip_comparison(case, f"baseline {name} has no case {case.id}")
    if not earlier.quantities:
        return _skip_comparison(case, f"baseline {name} has no values of this case: its verdict was {earlier.verdict}")
    values, earlier_values = dict(_numbers(case)), dict(_numbers(earlier))
    source = f"baseline {name}, allowed drift {drift_pct:g} %"
    graded = (_grade_drift(case, key, (old, values.get(key)), drift_pct, source) for key, old in earlier_values.items())
    drifted = [criterion for criterion in graded if criterion.verdict != "pass"]
    note = (
        f"Compared with baseline {name}: {len(earlier_values)} values, of which {len(drifted)} drifted by more than "
        f"{drift_pct:g} % or are missing."
    )
    if changes := _list_changes(case, earlier):
        drifted.append(_skipped_comparison(f"baseline {name} has other {' and '.join(changes)}; renew the baseline"))
    return _add_criteria(case, drifted).model_copy(update={"notes": [*case.notes, note]})


def _list_changes(case: CaseResult, earlier: CaseResult) -> list[str]:
    """Parts of a case that differ from the baseline; for an assessment, the inputs are the graded record itself."""
    parts = {
        "inputs": case.profile is None and case.input_digest != earlier.input_digest,
        "limits": case.limits_digest != earlier.limits_digest,
        "converged values": _verification_digest(earlier) not in {None, _verification_digest(case)},
        "texts or sources": case.library != earlier.library,
    }
    return [name for name, differs in parts.items() if differs]


def _verification_digest(case: CaseResult) -> str | None:
    return None if case.verification is None else case.verification.digest


def _skipped_comparison(reason: str) -> Criterion:
    """Skipped criterion, without which a case could pass by the baseline of another one."""
    requirement = Requirement(BASELINE, LINE, None, None, None, "primary", "baseline")
    return build_criterion(requirement, None, reason, "primary")


def _skip_comparison(case: CaseResult, reason: str) -> CaseResult:
    """Case with a skipped criterion in place of the comparison."""
    return _add_criteria(case, [_skipped_comparison(reason)])


def _add_criteria(case: CaseResult, added: Sequence[Criterion]) -> CaseResult:
    """Case with further criteria and the verdict that follows from all of them."""
    criteria = [*case.criteria, *added]
    verdict = judge_case((criterion.verdict for criterion in criteria), case.record)
    return case.model_copy(update={"criteria": criteria, "criteria_verdict": verdict})


def _numbers(case: CaseResult) -> Iterator[tuple[_Key, float]]:
    for owner, quantities in case.quantities.items():
        for quantity, value in quantities.items():
            if isinstance(value, list):
                yield from ((_Key(owner, quantity, item), number) for item, number in enumerate(value, 1))
            else:
                yield _Key(owner, quantity, None), value


def _round_limit(limit: float, allowed: float) -> float:
    """Round a limit to a hundredth of the allowed drift or finer, so that no page prints twelve digits."""
    return round(limit, 3 - math.floor(math.log10(allowed))) if allowed > 0 else limit


def _grade_drift(
    case: CaseResult, key: _Key, values: tuple[float, float | None], drift_pct: float, source: str
) -> Criterion:
    """Grade a value (earlier, now) by the drift from its earlier value."""
    earlier, now = values
    unit = QUANTITIES[key.quantity].unit if key.quantity in QUANTITIES else ""
    scale = max(abs(earlier), SMALLEST_SCALE if unit else SMALLEST_RATIO_SCALE)
    allowed = drift_pct / 100 * scale
    lower, upper = (_round_limit(earlier + side * allowed, allowed) for side in (-1, 1))
    requirement = Requirement(key.quantity, int(key.owner), key.item, lower, upper, "primary", source)
    if now is None:
        missing = case.skipped.get(key.owner, {}).get(key.quantity, "the system no longer delivers it")
        reason = f"the baseline has {earlier:.6g} {unit}".rstrip() + f"; now: {missing}"
    else:
        drift = 100 * (now - earlier) / scale
        reason = f"drifted by {drift:+.3g} % from the baseline of {earlier:.6g} {unit}".rstrip()
    criterion = build_criterion(requirement, now, reason, "primary")
    return criterion.model_copy(update={"reason": reason, "baseline": earlier})
