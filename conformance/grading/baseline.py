"""Baseline: a value that drifts from earlier results fails, independent of its limits, by a verdict of its own."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from pantocheck.conformance.core.criterion import BASELINE, Criterion, Requirement
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.case_verdict import judge_baseline, read_participation
from pantocheck.conformance.grading.criterion_grading import build_criterion, skip_unlimited
from pantocheck.conformance.quantities.registry import unit_of
from pantocheck.conformance.results.case_facts_format import BaselineComparison
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.results.scope import build_scope

SMALLEST_SCALE = 1.0
"""Smallest reference of a relative drift, in the unit of the value: near zero, a percentage has no meaning."""

SMALLEST_RATIO_SCALE = 0.01
"""Smallest reference of a relative drift of a quantity without a unit."""

LARGEST_VALUE = 1e12
"""Largest absolute value of a baseline; values of real runs are far below."""

MOST_VALUES = 10_000
"""Largest number of values of a case of a baseline; real cases are far below."""

KEYS_SHOWN = 5
"""Number of changed keys of the inputs that a reason names."""


class _Key(NamedTuple):
    """Owner, quantity and item of one number of a case."""

    owner: str
    quantity: str
    item: int | None


def read_baseline(path: Path) -> Results:
    """Read earlier results before a run, so that no comparison fails after it.

    Raises:
        InputError: The file cannot be read, is not in the format of the suite, or its values are too many or too large.
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

    A value of the baseline that is no longer delivered becomes a skipped criterion, so that its loss is noticed. These
    criteria give a verdict of their own; they do not belong to the EN 50318 criteria.

    Args:
        results: Results of this run.
        baseline: Results of the earlier run.
        drift_pct: Largest accepted drift [%].
        name: Name of the baseline in reports.
    """
    earlier = {case.id: case for case in baseline.cases}
    cases = [_compare_case(case, earlier.get(case.id), drift_pct, name) for case in results.cases]
    decided = read_participation(results).decide_run(results.model_copy(update={"cases": cases}))
    return decided.model_copy(update={"scope": build_scope(decided.cases)})


def _compare_case(case: CaseResult, earlier: CaseResult | None, drift_pct: float, name: str) -> CaseResult:
    if not case.quantities:
        return case  # skipped or in error as a whole
    if earlier is None:
        return _skip_comparison(case, f"baseline {name} has no case {case.id}", drift_pct, name)
    if not earlier.quantities:
        reason = f"baseline {name} has no values of this case: its verdict was {earlier.verdict}"
        return _skip_comparison(case, reason, drift_pct, name)
    values, earlier_values = dict(_numbers(case)), dict(_numbers(earlier))
    source = f"baseline {name}, allowed drift {drift_pct:g} %"
    graded = (_grade_drift(case, key, (old, values.get(key)), drift_pct, source) for key, old in earlier_values.items())
    drifted = [criterion for criterion in graded if criterion.verdict != "pass"]
    note = (
        f"Compared with baseline {name}: {len(earlier_values)} values, of which {len(drifted)} drifted by more than "
        f"{drift_pct:g} % or are missing."
    )
    sizes = (len(earlier_values), len(drifted))
    if changes := _list_changes(case, earlier):
        drifted.append(_skipped_comparison(f"baseline {name} has other {', '.join(changes)}; renew the baseline"))
    compared = _add_criteria(case, drifted, sizes, drift_pct, name)
    return compared.model_copy(update={"notes": [*case.notes, note]})


def _list_changes(case: CaseResult, earlier: CaseResult) -> list[str]:
    """Parts of a case that differ from the baseline; for an assessment, the inputs are the graded record itself."""
    parts = {
        f"inputs{_name_inputs(case, earlier)}": case.profile is None and case.input_digest != earlier.input_digest,
        "limits": case.limits_digest != earlier.limits_digest,
        "converged values": _verification_digest(earlier) not in {None, _verification_digest(case)},
        "texts or sources": case.library != earlier.library,
    }
    return [name for name, differs in parts.items() if differs]


def _name_inputs(case: CaseResult, earlier: CaseResult) -> str:
    """Keys of the inputs that differ, in brackets; empty if results state none."""
    groups, earlier_groups = ({group.group: group.values for group in each.inputs} for each in (case, earlier))
    keys = []
    for group in dict.fromkeys([*groups, *earlier_groups]):
        values, earlier_values = groups.get(group, {}), earlier_groups.get(group, {})
        names = dict.fromkeys([*values, *earlier_values])
        prefix = "" if group == "case" else f"{group}."
        keys += [f"{prefix}{name}" for name in names if values.get(name) != earlier_values.get(name)]
    more = f" and {len(keys) - KEYS_SHOWN} more" if len(keys) > KEYS_SHOWN else ""
    return f" ({', '.join(keys[:KEYS_SHOWN])}{more})" if keys else ""


def _verification_digest(case: CaseResult) -> str | None:
    return None if case.verification is None else case.verification.digest


def _skipped_comparison(reason: str) -> Criterion:
    """Skipped criterion, without which a case could pass by the baseline of another one."""
    return skip_unlimited(BASELINE, reason, "baseline", trust=None)


def _skip_comparison(case: CaseResult, reason: str, drift_pct: float, name: str) -> CaseResult:
    """Case with a skipped criterion in place of the comparison."""
    return _add_criteria(case, [_skipped_comparison(reason)], (0, 0), drift_pct, name)


def _add_criteria(
    case: CaseResult, added: Sequence[Criterion], sizes: tuple[int, int], drift_pct: float, name: str
) -> CaseResult:
    """Case with criteria of drift, (compared, drifted) values, and the verdict that follows; others stay."""
    values, drifted = sizes
    verdict = judge_baseline((criterion.verdict for criterion in added), values)
    comparison = BaselineComparison(verdict=verdict, name=name, drift_pct=drift_pct, values=values, drifted=drifted)
    return case.model_copy(
        update={
            "criteria": [*case.criteria, *added],
            "criteria_verdict": case.criteria_verdict or case.verdict,
            "baseline": comparison,
        }
    )


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


def bound_drift(quantity: str, earlier: float, drift_pct: float) -> tuple[float, float]:
    """Bounds of a value that has not drifted from its earlier value, in the unit of the quantity."""
    allowed = drift_pct / 100 * _scale(quantity, earlier)
    return _round_limit(earlier - allowed, allowed), _round_limit(earlier + allowed, allowed)


def _scale(quantity: str, earlier: float) -> float:
    """Reference of a relative drift."""
    return max(abs(earlier), SMALLEST_SCALE if unit_of(quantity) else SMALLEST_RATIO_SCALE)


def _grade_drift(
    case: CaseResult, key: _Key, values: tuple[float, float | None], drift_pct: float, source: str
) -> Criterion:
    """Grade a value (earlier, now) by the drift from its earlier value."""
    earlier, now = values
    unit = unit_of(key.quantity)
    lower, upper = bound_drift(key.quantity, earlier, drift_pct)
    requirement = Requirement(
        quantity=key.quantity,
        pantograph=int(key.owner),
        item=key.item,
        unit=unit,
        lower=lower,
        upper=upper,
        trust=None,
        source=source,
        baseline=earlier,
    )
    if now is None:
        lost = case.skipped.get(key.owner, {}).get(key.quantity, "the system no longer delivers it")
        reason = f"the baseline has {earlier:.6g} {unit}".rstrip() + f"; now: {lost}"
    else:
        drift = 100 * (now - earlier) / _scale(key.quantity, earlier)
        reason = f"drifted by {drift:+.3g} % from the baseline of {earlier:.6g} {unit}".rstrip()
    criterion = build_criterion(requirement, now, None, "primary")
    return criterion.model_copy(update={"reason": reason})
