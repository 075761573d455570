"""Baselines: earlier results that values may not drift from, whatever the limits say."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from pantocheck.conformance.grading.verdicts import judge, margin, worst_verdict
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.results_format import CaseResult, Criterion, Results

LEAST = 1.0
"""Drift is relative to at least one unit (N, mm, %, Hz, m/s): of a value near zero, any change would be 100 %."""

LEAST_RATIO = 0.01
"""The same for quantities without a unit."""


@dataclass(frozen=True)
class _Value:
    """One number of a case: whose, which quantity, and which of several."""

    of: str
    quantity: str
    item: int | None
    value: float


def compare_with_baseline(results: Results, baseline: Results, drift_pct: float, name: str) -> Results:
    """Results with a failed criterion for each value that has drifted from its baseline.

    A value of the baseline that is no longer there is a skipped criterion, so that it does not vanish unnoticed.

    Parameters
    ----------
    results : Results
        Of this run.
    baseline : Results
        Of the run to compare with.
    drift_pct : float
        How far a value may be from that of the baseline [%].
    name : str
        What the baseline is called in reports.
    """
    earlier = {case.id: case for case in baseline.cases}
    cases = [_compared(case, earlier.get(case.id), drift_pct, name) for case in results.cases]
    return results.model_copy(update={"cases": cases, "verdict": worst_verdict(case.verdict for case in cases)})


def _compared(case: CaseResult, earlier: CaseResult | None, drift_pct: float, name: str) -> CaseResult:
    if not case.quantities:
        return case  # skipped or in error as a whole: that is its verdict already
    if earlier is None:
        return case.model_copy(update={"warnings": [*case.warnings, f"baseline {name} has no case {case.id}"]})
    now = {(v.of, v.quantity, v.item): v.value for v in _values(case)}
    then = list(_values(earlier))
    rows = [_row(case, v, now.get((v.of, v.quantity, v.item)), drift_pct, name) for v in then]
    findings = [row for row in rows if row.verdict != "pass"]
    warnings = list(case.warnings)
    if case.input_digest != earlier.input_digest:
        warnings.append(f"the inputs of the case have changed since baseline {name}: their digests differ")
    if not then:
        warnings.append(f"baseline {name} has no values of this case: it ended in {earlier.verdict}")
    said = f"Compared with baseline {name}: {len(rows)} values, of which {len(findings)} drifted by more than "
    return case.model_copy(
        update={
            "criteria": [*case.criteria, *findings],
            "notes": [*case.notes, f"{said}{drift_pct:g} % or are missing."],
            "warnings": warnings,
            "verdict": worst_verdict([case.verdict, *(row.verdict for row in findings)]),
        }
    )


def _values(case: CaseResult) -> Iterator[_Value]:
    for of, quantities in case.quantities.items():
        for quantity, value in quantities.items():
            if isinstance(value, list):
                yield from (_Value(of, quantity, i, one) for i, one in enumerate(value, 1))
            else:
                yield _Value(of, quantity, None, value)


def _rounded(limit: float, allowed: float) -> float:
    """A limit to a hundredth of the allowed drift or finer, so that no page prints twelve digits of it."""
    return round(limit, 3 - math.floor(math.log10(allowed))) if allowed > 0 else limit


def _row(case: CaseResult, then: _Value, now: float | None, drift_pct: float, name: str) -> Criterion:
    unit = QUANTITIES[then.quantity].unit if then.quantity in QUANTITIES else ""
    scale = max(abs(then.value), LEAST if unit else LEAST_RATIO)
    allowed = drift_pct / 100 * scale
    lower, upper = (_rounded(then.value + side * allowed, allowed) for side in (-1, 1))
    verdict = "skip" if now is None else judge(now, lower, upper)
    why_none = case.skipped.get(then.of, {}).get(then.quantity, "the system no longer delivers it")
    if now is None:
        reason = f"the baseline has {then.value:.6g} {unit}".rstrip() + f"; now: {why_none}"
    else:
        drift = 100 * (now - then.value) / scale
        reason = f"drifted by {drift:+.3g} % from the baseline of {then.value:.6g} {unit}".rstrip()
    return Criterion(
        quantity=then.quantity,
        pantograph=int(then.of),
        item=then.item,
        value=now,
        unit=unit,
        lower=lower,
        upper=upper,
        verdict=verdict,
        trust="primary",
        source=f"baseline {name}, from which a value may drift by {drift_pct:g} %",
        margin=None if now is None else margin(now, lower, upper),
        discretisation_error=None,
        reason=reason,
        baseline=then.value,
    )
