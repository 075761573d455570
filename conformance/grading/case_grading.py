"""From the outcome of a case to its result: quantities, criteria, warnings, traces."""

import math
from collections.abc import Callable, Mapping, Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.consistency.record_checks import check_record
from pantocheck.conformance.grading.extended_band import extended_band_warnings
from pantocheck.conformance.grading.section_spread import section_spread
from pantocheck.conformance.grading.verdicts import Verdict, judge, margin, worst_verdict
from pantocheck.conformance.input_files.trust import Trust, limit_counts
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation, Value
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.results.outcome import Delivered, Errored, Outcome, Skipped
from pantocheck.conformance.results.results_format import (
    CaseResult,
    Criterion,
    FilterFacts,
    InputGroup,
    Number,
    RunFacts,
)
from pantocheck.conformance.results.traces import build_pantograph_traces, build_uplift_traces


def grade_case(case: Case, outcome: Outcome, lowest_trust: Trust) -> CaseResult:
    """Grade what a system delivered for a case.

    Parameters
    ----------
    case : Case
        What was asked, and its limits.
    outcome : Outcome
        What was delivered.
    lowest_trust : Trust
        Lowest trust of the limits that carry a verdict.
    """
    match outcome:
        case Skipped(reason):
            return build_ungraded(case, "skip", reason)
        case Errored(reason):
            return build_ungraded(case, "error", reason)
        case delivered:
            return _grade_delivered(case, delivered, lowest_trust)


def _grade_delivered(case: Case, outcome: Delivered, lowest_trust: Trust) -> CaseResult:
    if (mismatch := _mismatch(case, outcome)) is not None:
        return build_ungraded(case, "error", mismatch, outcome)
    evaluation, refined = _evaluated(case, outcome), _refined(case, outcome)
    record = outcome.record
    low_pass = case.file.filter.low_pass
    shifted = {} if record is None else section_spread(record, case.shifted_sections, low_pass, evaluation.values)
    found = check_record(case, record) if record is not None else []
    contradiction = next((finding for finding in found if finding.kind == "contradiction"), None)
    # Numbers of a record that contradicts itself are shown, but not held against limits: some would pass.
    limits = case.limits if contradiction is None else ()
    criteria = [_with_spread(grade_criterion(limit, evaluation, lowest_trust, refined), shifted) for limit in limits]
    supports = list(case.line.geometry.span_limits)
    return _result(
        case,
        outcome,
        verdict=worst_verdict(criterion.verdict for criterion in criteria) if contradiction is None else "error",
        reason=None if contradiction is None else contradiction.text,
        warnings=[
            *outcome.warnings,
            *(finding.text for finding in found if finding.kind == "doubt"),
            *_close_calls(criteria),
            *_edge_warnings(case, outcome),
            *extended_band_warnings(outcome, evaluation, refined),
        ],
        notes=[f"not checked, {finding.text}" for finding in found if finding.kind == "unchecked"],
        criteria=criteria,
        quantities={str(of): finite_values(evaluation.values[of]) for of in evaluation.values if evaluation.values[of]},
        skipped={str(of): evaluation.skipped[of] for of in evaluation.skipped if evaluation.skipped[of]},
        spread={str(of): values for of, values in shifted.items()},
        traces=build_pantograph_traces(record, low_pass, supports) if record is not None else {},
        uplift=build_uplift_traces(record) if record is not None else [],
        charts=list(outcome.study.charts),
        tables=list(outcome.study.tables),
    )


def grade_criteria(case: Case, outcome: Delivered, lowest_trust: Trust) -> list[Criterion]:
    """Every limit of a case against what was delivered; parameters as in `graded`."""
    evaluation, refined = _evaluated(case, outcome), _refined(case, outcome)
    return [grade_criterion(limit, evaluation, lowest_trust, refined) for limit in case.limits]


def _refined(case: Case, outcome: Delivered) -> Evaluation | None:
    """Quantities of the same case with element and time step halved, where a system delivers that."""
    return _evaluated(case, outcome.refined) if outcome.refined is not None else None


def _mismatch(case: Case, outcome: Delivered) -> str | None:
    """Why a record is not one of this case: graded all the same, its numbers would be believed."""
    record = outcome.record
    for name in sorted(outcome.static):
        if name not in QUANTITIES:
            return f"the system delivered an unknown quantity {name!r}"
        if QUANTITIES[name].scope != "static":
            return f"the system delivered {name!r} as one of the line at rest, but it follows from the record"
    if case.is_static:
        return None
    if record is None:
        return None if outcome.summary is not None else "the system delivered no record"
    if record.pantographs != len(case.pantographs):
        return f"the record has {record.pantographs} pantographs, the case has {len(case.pantographs)}"
    if abs(record.speed / case.speed - 1) > 0.005:
        return f"the record was made at {3.6 * record.speed:.4g} km/h, the case runs at {3.6 * case.speed:.4g} km/h"
    if any(abs(a - b) > 0.01 for a, b in zip(record.evaluated, case.analysis_section, strict=True)):
        (start, end), (first, last) = record.evaluated, case.analysis_section
        return f"the record evaluates {start:g} m to {end:g} m, the case {first:g} m to {last:g} m"
    return None


def build_ungraded(case: Case, verdict: Verdict, reason: str, delivered: Delivered | None = None) -> CaseResult:
    """Result of a case that did not get as far as its limits."""
    line = " ".join(reason.split())
    return _result(
        case,
        delivered or Delivered(),
        verdict=verdict,
        reason=line,
        warnings=[],
        notes=[],
        criteria=[],
        quantities={},
        skipped={},
        spread={},
        traces={},
        uplift=[],
    )


def _result(case: Case, outcome: Delivered, notes: Sequence[str], **parts: object) -> CaseResult:
    file, record = case.file, outcome.record
    return CaseResult.model_validate(
        {
            "id": case.id,
            "title": file.title,
            "notes": [*case.notes, *outcome.notes, *notes],
            "inputs": [InputGroup(group=i.group, trust=i.trust, source=source_text(i.source)) for i in case.inputs],
            "input_digest": case.digest,
            "run": RunFacts(
                **outcome.run.model_dump(),
                speed_km_h=file.speed_km_h,
                rate_Hz=None if record is None else float(f"{record.rate:.9g}"),
                filter=FilterFacts(**file.filter.model_dump()),
                evaluated_m=None if case.is_static else case.analysis_section,
            ),
            **parts,
        }
    )


def _evaluated(case: Case, outcome: Delivered) -> Evaluation:
    if outcome.record is None:
        evaluation = outcome.summary or Evaluation({LINE: {}}, {LINE: {}})
    else:
        evaluation = evaluate_record(outcome.record, case.file.filter.low_pass)
    ordered = {name: outcome.static[name] for name in QUANTITIES if name in outcome.static}
    values = {**evaluation.values, LINE: {**evaluation.values[LINE], **ordered}}
    for of, given in outcome.study.findings.items():
        values[of] = {**values.get(of, {}), **{name: given[name] for name in QUANTITIES if name in given}}
    return Evaluation(values, evaluation.skipped)


def grade_criterion(
    limit: Limit, evaluation: Evaluation, lowest_trust: Trust, refined: Evaluation | None = None
) -> Criterion:
    """A value against its limit.

    Parameters
    ----------
    limit : Limit
        Of one quantity.
    evaluation : Evaluation
        That holds the value, or the reason why there is none.
    lowest_trust : Trust
        Lowest trust of the limits that carry a verdict.
    refined : Evaluation or None
        The same with element and time step halved, for the discretisation error.
    """
    value = find_value(limit, evaluation.values)
    fine = find_value(limit, refined.values) if refined is not None else None
    verdict: Verdict = "skip"
    reason: str | None = None
    if value is None:
        reason = evaluation.skipped.get(limit.owner, {}).get(limit.quantity, "the system delivers no such quantity")
    else:
        verdict = judge(value, limit.lower, limit.upper)
        if verdict == "fail":
            reason = _outside(value, limit)
    if not limit_counts(limit.trust, lowest_trust):
        would = {"pass": "would pass", "fail": f"would fail: {reason}", "skip": f"not graded: {reason}"}[verdict]
        verdict, reason = "info", f"{would}; the limit is {limit.trust} and does not count"
    return Criterion(
        quantity=limit.quantity,
        pantograph=limit.owner,
        item=limit.item,
        value=value,
        unit=QUANTITIES[limit.quantity].unit,
        lower=limit.lower,
        upper=limit.upper,
        verdict=verdict,
        trust=limit.trust,
        source=source_text(limit.source),
        margin=None if value is None else margin(value, limit.lower, limit.upper),
        discretisation_error=None if value is None or fine is None else abs(value - fine),
        reason=reason,
    )


def criterion_name(item: Criterion) -> str:
    """What a criterion is about: the quantity, which of several, and whose."""
    name = f"{item.quantity}[{item.item}]" if item.item else item.quantity
    return f"{name} of pantograph {item.pantograph}" if item.pantograph else f"{name} of the line"


def _with_spread(item: Criterion, shifted: dict[int, dict[str, float]]) -> Criterion:
    found = shifted.get(item.pantograph, {}).get(item.quantity)
    return item if found is None or item.value is None else item.model_copy(update={"spread": found})


def find_value(limit: Limit, values: Mapping[int, Mapping[str, Value]]) -> float | None:
    """The value that a limit is for; None if there is none, or no finite one.

    Parameters
    ----------
    limit : Limit
        Of one quantity, or of one item of it.
    values : Mapping[int, Mapping[str, Value]]
        By pantograph (0: the line) and name.
    """
    value = values.get(limit.owner, {}).get(limit.quantity)
    if isinstance(value, tuple):
        at = (limit.item or 1) - 1
        value = value[at] if at < len(value) else None
    return value if value is not None and math.isfinite(value) else None


def _outside(value: float, limit: Limit) -> str:
    unit = QUANTITIES[limit.quantity].unit
    if limit.lower is not None and value < limit.lower:
        return f"{limit.lower - value:.3g} {unit} below the lower limit".replace("  ", " ")
    return f"{value - (limit.upper or 0.0):.3g} {unit} above the upper limit".replace("  ", " ")


def _close_calls(criteria: list[Criterion]) -> list[str]:
    """A verdict that a finer mesh, or another stretch, could turn is named."""
    close = []
    for item in criteria:
        if item.value is None or item.lower == item.upper:
            continue
        distance = min(abs(item.value - bound) for bound in (item.lower, item.upper) if bound is not None)
        for error, name in (
            (item.discretisation_error, "discretisation error"),
            (item.spread, "spread over stretches"),
        ):
            if error is not None and distance < error:
                close.append(
                    f"{criterion_name(item)} lies {distance:.2g} {item.unit} from a limit, "
                    f"less than its {name} of {error:.2g} {item.unit}"
                )
    return close


def _edge_warnings(case: Case, outcome: Delivered) -> list[str]:
    """The filter's transients reach two periods of the cut-off into the record from its ends."""
    record = outcome.record
    if record is None:
        return []
    settle = 2 / case.file.filter.cutoff_Hz * record.speed
    start, end = record.evaluated
    return [
        f"the record of pantograph {i} has less than {settle:.1f} m of run-in or run-out around the evaluated stretch: "
        "transients of the filter reach into it"
        for i, position in enumerate(record.position, 1)
        if position[0] > start - settle or position[-1] < end + settle
    ]


def finite_values(values: dict[str, Value]) -> dict[str, Number]:
    """Values as results hold them: lists and finite numbers."""
    finite: Callable[[float], bool] = math.isfinite
    kept: dict[str, Number] = {}
    for name, value in values.items():
        numbers = list(value) if isinstance(value, tuple) else value
        if all(map(finite, numbers if isinstance(numbers, list) else [numbers])):
            kept[name] = numbers
    return kept
