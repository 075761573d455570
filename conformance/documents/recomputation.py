"""Recomputation of results from their own numbers: a value that does not follow from its inputs is a discrepancy."""

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

from pantocheck.conformance.core.criterion import (
    COMPONENT_NAMES,
    CaseVerification,
    ComponentName,
    Criterion,
    judge_criteria,
)
from pantocheck.conformance.core.decision import SIMPLE, DecisionRule, judge_by_rule, parse_decision
from pantocheck.conformance.core.findings import count_findings, judge_finding, lower_imposed_verdict
from pantocheck.conformance.core.near_limit import BOUNDED_COMPONENTS, ValueErrors, near_limit_remarks
from pantocheck.conformance.core.results_part import Number, select_item
from pantocheck.conformance.core.trust import Computed, Trust, decides_verdict
from pantocheck.conformance.core.verdicts import Verdict, margin
from pantocheck.conformance.documents.authenticity_check import EXACT, format_exact, same_number, select_first
from pantocheck.conformance.documents.signal_check import check_signals
from pantocheck.conformance.documents.state_check import check_state
from pantocheck.conformance.documents.statement_check import (
    check_case_statements,
    check_criterion_statements,
    check_run_statements,
)
from pantocheck.conformance.documents.trace_check import check_trace, check_uplift
from pantocheck.conformance.grading.baseline import bound_drift
from pantocheck.conformance.grading.case_conformity import find_case_conformity
from pantocheck.conformance.grading.case_identity import explain_widened_limit
from pantocheck.conformance.grading.case_verdict import judge_baseline, judge_case, read_participation
from pantocheck.conformance.grading.reading_grades import list_reading_remarks
from pantocheck.conformance.grading.start_agreement import list_verification_components
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.statistics import coefficient_of_variation, statistical_extremes
from pantocheck.conformance.quantities.uncertainty import ABSENT_BASIS, UNKNOWN_BASIS
from pantocheck.conformance.results.case_facts_format import RecordFacts
from pantocheck.conformance.results.procedure_format import STEP_NAMES, Procedure
from pantocheck.conformance.results.results_format import STATEMENT, CaseResult, Results, UncertaintyComponents
from pantocheck.conformance.results.scope import build_scope
from pantocheck.model.statics.wave_factors import amplification_coefficient, doppler_factor

WIDEST_RATIO = 3.0
"""Largest ratio between the interval of a joint sample and the root of the sum of squares of its components."""

LOSS_QUANTITIES = frozenset(
    {"contact_loss_pct", "longest_contact_loss_s", "contact_loss_events", "long_contact_loss_pct"}
)
"""Quantities that are zero in most spans."""

ROUNDING_OF_DRAWS = 1e-5
"""Largest effect of the rounding of the draws on a width, relative to the value."""


def find_discrepancies(results: Results) -> list[str]:
    """Find contradictions between the numbers and verdicts of results."""
    rule = parse_decision(results.decision, "results, key decision")
    discrepancies = list(check_run_statements(results))
    discrepancies += [text for case in results.cases for text in _check_case(case, results.trust, rule)]
    decided = read_participation(results).decide_run(results)
    pairs: list[tuple[str, Verdict | None, Verdict | None]] = [
        (f"{case.id}: ", case.verdict, other.verdict) for case, other in zip(results.cases, decided.cases, strict=True)
    ]
    pairs.append(("", results.verdict, decided.verdict))
    pairs.append(("verification: ", results.verification_verdict, decided.verification_verdict))
    pairs.append(("baseline: ", results.baseline_verdict, decided.baseline_verdict))
    if results.conformity != decided.conformity:
        stated, follows = format_exact(results.conformity), format_exact(decided.conformity)
        discrepancies.append(f"probability of conformity {stated} stated, {follows} follows from the joint samples")
    pairs.append(("EN 50318 criteria: ", results.criteria_verdict, decided.criteria_verdict))
    findings = count_findings(row.finding for case in results.cases for row in case.criteria)
    if results.statement != STATEMENT:
        discrepancies.append(f"the report is called '{results.statement}', expected '{STATEMENT}'")
    if results.scope and results.scope != build_scope(results.cases):
        discrepancies.append("the scope does not follow from the cases")
    return [
        *discrepancies,
        *(() if results.findings == findings else ("the numbers of findings do not follow from the criteria",)),
        *check_procedure(
            results.procedure, decided.procedure, results.cases, lambda row: _check_grade(row, results.trust)
        ),
        *(f"{where}verdict '{old}' stated, '{new}' follows from the cases" for where, old, new in pairs if old != new),
    ]


def _check_case(case: CaseResult, trust: Trust | Computed, rule: DecisionRule) -> Iterator[str]:
    stated, verification = case.criteria_verdict or case.verdict, case.verification
    yield from (f"{case.id}, {text}" for text in check_combination(case))
    record = case.record
    graded = [row for row in case.criteria if not row.is_drift]
    ungraded = not graded and case.reason and stated in ("skip", "error")
    yield from _check_criteria(case, case.criteria, trust, rule)
    yield from _check_conformity(case)
    yield from (f"{case.id}, {text}" for text in _check_readings(case))
    yield from (f"{case.id}: {text}" for text in check_baseline(case))
    yield from (f"{case.id}: {text}" for text in (*check_state(case), *check_case_statements(case)))
    verdict = judge_case([judge_criteria(graded)], record)
    if stated != verdict and not ungraded:
        yield f"{case.id}: verdict '{stated}' stated, '{verdict}' follows from the criteria and the record"
    if verification is not None:
        yield from _check_verification(case, verification, record)
    yield from (f"{case.id}: {text}" for text in (*check_uplift(case), *check_signals(case), *_check_line(case)))
    for key, reported in case.quantities.items():
        quantities = select_first(reported)
        trace, drawn = case.traces.get(key), case.traces.get(key) if case.signals is None else None
        # Statistics delivered as numbers are rounded, and printed tables are not always consistent.
        computed = trace is not None or case.run.rate_Hz is not None
        statistics = (*_check_order(quantities), *(_check_statistics(quantities) if computed else ()))
        for text in (*statistics, *(check_trace(quantities, drawn) if drawn else ())):
            yield f"{case.id}, pantograph {key}: {text}"


def _check_criteria(
    case: CaseResult, criteria: Sequence[Criterion], trust: Trust | Computed, rule: DecisionRule = SIMPLE
) -> Iterator[str]:
    start = None if case.record is None else case.record.start
    names = list_verification_components(start) if trust == "computed" else COMPONENT_NAMES
    for row in criteria:
        where = f"{case.id}, {row.quantity} of pantograph {row.pantograph}"
        unknown = list_unknown_components(case, row, names)
        components = check_components(row, case.uncertainty_components, names)
        if row.doubt is None and (doubt := explain_widened_limit(case.id, row)) is not None:
            yield f"{where}: {doubt}, which the criterion does not state"
        stated = check_criterion_statements(case, row, _gather_errors(row, unknown), trust, rule)
        grade = _check_grade(row, trust, rule, unknown)
        for text in (*_check_value(row, case.quantities), *components, *grade, *stated):
            yield f"{where}: {text}"


def _check_readings(case: CaseResult) -> Iterator[str]:
    """Remarks on other readings of the evaluation must follow from their values, and these from each other."""
    for row in case.criteria:
        if row.readings != list_reading_remarks(row, case.readings, case.conditions):
            place = f"{row.quantity} of pantograph {row.pantograph}"
            yield f"{place}: the remarks on readings do not follow from their values"
    for row in () if case.verification is None else case.verification.criteria:
        if row.readings:
            yield f"verification, {row.quantity}: a remark on a reading, under which nothing is verified"
    for reading in case.readings:
        for key, reported in reading.quantities.items():
            for text in _check_statistics(select_first(reported)):
                yield f"reading '{reading.id}', pantograph {key}: {text}"


def _check_verification(case: CaseResult, verification: CaseVerification, record: RecordFacts | None) -> Iterator[str]:
    """Verification: its verdict must follow from its criteria; without criteria it must not pass."""
    for text in _check_criteria(case, verification.criteria, "computed"):
        yield f"verification: {text}"
    verdict, stated = judge_case((row.verdict for row in verification.criteria), record), verification.verdict
    if stated != verdict and (verification.criteria or stated not in ("info", "skip", "error")):
        yield f"{case.id}: verification '{stated}' stated, '{verdict}' follows from its criteria and the record"


def _check_value(row: Criterion, quantities: Mapping[str, Mapping[str, Number]]) -> Iterator[str]:
    """The graded value must be the reported quantity."""
    reported = select_item(quantities.get(str(row.pantograph), {}).get(row.quantity), row.item)
    if row.value != reported:
        yield f"value {format_exact(row.value)} graded, {format_exact(reported)} reported among the quantities"


def _check_grade(
    row: Criterion, trust: Trust | Computed, rule: DecisionRule = SIMPLE, unknown: tuple[ComponentName, ...] = ()
) -> Iterator[str]:
    """Verdict, margin and remarks on a close limit must follow from value, limits, errors and trust."""
    quantity = QUANTITIES.get(row.quantity)
    if quantity is not None and row.unit != quantity.unit:
        yield f"unit '{row.unit}' stated, '{quantity.unit}' is the unit of this quantity"
    value, lower, upper = row.value, row.lower, row.upper
    if lower is None and upper is None:
        # Only a rule without a bound for this record, which is skipped, may lack a limit.
        if row.verdict != ("skip" if decides_verdict(row.trust, trust) else "info"):
            yield "no limit"
        return
    if lower is not None and upper is not None and lower > upper:
        yield f"lower limit {format_exact(lower)} above upper limit {format_exact(upper)}"
        return
    errors = _gather_errors(row, unknown)
    judged: Verdict = "skip" if value is None else judge_by_rule(value, (lower, upper), errors, rule)[0]
    finding = row.finding
    if finding is not None and finding.outcome != judge_finding(finding.role, judged):
        yield f"finding '{finding.outcome}' stated, '{judge_finding(finding.role, judged)}' follows"
    role = None if finding is None else finding.role
    judged = "info" if judged == "pass" and row.doubt is not None else judged
    verdict = lower_imposed_verdict(role, judged) if decides_verdict(row.trust, trust) else "info"
    if row.verdict != verdict:
        yield f"verdict '{row.verdict}' stated, '{verdict}' follows from value, limits and trust"
    expected = None if value is None else margin(value, lower, upper)
    if not same_number(row.margin, expected, EXACT):
        yield f"margin {format_exact(row.margin)} stated, {format_exact(expected)} follows from value and limits"
    half_width = None if value is None else errors.find_half_width(value)
    if row.components and not same_number(row.uncertainty, half_width, EXACT):
        printed, combined = format_exact(row.uncertainty), format_exact(half_width)
        yield f"uncertainty {printed} stated, {combined} follows from its joint sample and components"
    conformity = None if value is None else errors.find_conformity((lower, upper))
    if not same_number(row.conformity, conformity, EXACT):
        printed, found = format_exact(row.conformity), format_exact(conformity)
        yield f"probability of conformity {printed} stated, {found} follows from its joint sample"
    remarks = near_limit_remarks(value, (lower, upper), row.unit, errors)
    if row.close != remarks:
        stated, follow = len(row.close), len(remarks)
        texts = " with other texts" if stated == follow else ""
        yield f"{stated} remarks on a close limit stated, {follow}{texts} follow from value, limits and errors"


def _gather_errors(row: Criterion, unknown: tuple[ComponentName, ...]) -> ValueErrors:
    return ValueErrors(
        row.discretisation_error, row.spread, row.components, row.limit_uncertainty, tuple(row.draws), unknown
    )


def _check_conformity(case: CaseResult) -> Iterator[str]:
    """The probability of a case must follow from the joint samples of its criteria."""
    stated = case.conformity
    starts = (0, 0) if stated is None else (stated.starts, stated.passing_starts)
    found = find_case_conformity(case.criteria, starts, case.readings)
    if stated != found:
        yield f"{case.id}: the probability of conformity does not follow from the joint samples of the criteria"
    elif stated is not None and stated.passing_starts > stated.starts:
        yield f"{case.id}: {stated.passing_starts} of {stated.starts} starts pass"


def _is_plausible(stated: float | None, combined: float, rounding: float, widest: float) -> bool:
    """Whether the width of an interval can be that of a joint sample of components with this combined width."""
    if stated is None or not math.isfinite(stated):
        return False
    return combined / WIDEST_RATIO - rounding <= stated and (
        widest == math.inf or stated <= widest * combined + rounding
    )


def list_unknown_components(
    case: CaseResult, row: Criterion, names: Collection[ComponentName]
) -> tuple[ComponentName, ...]:
    """Components of a criterion that are not known: of the whole case, or one of the record that the quantity lacks."""
    basis = case.uncertainty_basis
    unknown = [name for name in names if basis.get(name, "").startswith(UNKNOWN_BASIS)]
    reported = case.uncertainty_components.get(str(row.pantograph), {}).get(row.quantity)
    lacking = [name for name in BOUNDED_COMPONENTS if name in names and reported is not None and name not in reported]
    return (*unknown, *(name for name in lacking if not basis.get(name, ABSENT_BASIS).startswith(ABSENT_BASIS)))


def _check_statistics(quantities: Mapping[str, float]) -> Iterator[str]:
    """Quantities must follow from the quantities they are functions of."""
    mean, std, std_50 = (quantities.get(name) for name in ("mean_force_N", "std_force_N", "std_force_50_N"))
    expected: dict[str, float] = {}
    if mean is not None and std is not None:
        expected["statistical_min_N"], expected["statistical_max_N"] = statistical_extremes(mean, std)
    if mean is not None and mean > 0:
        ratios = {"cov_20": std, "cov_50": std_50}
        expected |= {k: coefficient_of_variation(mean, v) for k, v in ratios.items() if v is not None}
    for name, value in expected.items():
        if name in quantities and not same_number(quantities[name], value, EXACT):
            stated = format_exact(quantities[name])
            yield f"{name} {stated} stated, {format_exact(value)} follows from mean and standard deviation"


def _check_line(case: CaseResult) -> Iterator[str]:
    """Quantities of the line must follow from the wave speed and from the elasticities that they are functions of."""
    line, speed = select_first(case.quantities.get("0", {})), (case.run.speed_km_h or 0) / 3.6
    expected: dict[str, float] = {}
    if wave := line.get("wave_speed_m_s"):
        expected["speed_over_wave_speed"] = speed / wave
        expected["doppler_factor"] = doppler_factor(speed, wave)
    if "reflection_coefficient" in line and line.get("doppler_factor"):
        expected["amplification_coefficient"] = amplification_coefficient(
            line["reflection_coefficient"], line["doppler_factor"]
        )
    for name, value in expected.items():
        if name in line and not same_number(line[name], value, EXACT):
            yield f"{name} {format_exact(line[name])} stated, {format_exact(value)} follows from the wave speed"


def _check_order(quantities: Mapping[str, float]) -> Iterator[str]:
    """The minimum must not exceed the maximum."""
    low, high = quantities.get("min_force_N"), quantities.get("max_force_N")
    if low is not None and high is not None and low > high:
        yield f"min_force_N {format_exact(low)} above max_force_N {format_exact(high)}"


# Check of the stated uncertainties: they must follow from their components.
def check_components(
    row: Criterion, components: UncertaintyComponents, names: Collection[ComponentName]
) -> Iterator[str]:
    """Check that the components of a criterion are those of its quantity; a drift and a missing limit have none."""
    if row.is_drift or (row.lower is None and row.upper is None):
        return
    reported = components.get(str(row.pantograph), {}).get(row.quantity, {})
    listed = {name: select_item(width, row.item) for name, width in reported.items() if name in names}
    if row.value is not None and row.components != listed:
        yield "components of the uncertainty differ from those reported with the quantities"


def check_combination(case: CaseResult) -> Iterator[str]:
    """Check the uncertainty of every quantity: that of its criteria, and without a record that of its components."""
    for row in case.criteria:
        stated = select_item(case.uncertainty.get(str(row.pantograph), {}).get(row.quantity), row.item)
        if row.uncertainty is not None and not row.is_drift and row.uncertainty != stated:
            yield f"pantograph {row.pantograph}: uncertainty of {row.quantity} differs from that of its criterion"
    for key, quantities in case.uncertainty_components.items():
        for name, parts in quantities.items():
            columns = [width if isinstance(width, list) else [width] for width in parts.values()]
            expected = [math.hypot(*items) for items in zip(*columns, strict=False)]
            width = case.uncertainty.get(key, {}).get(name)
            numbers = width if isinstance(width, list) else [width]
            value = case.quantities.get(key, {}).get(name, 0.0)
            rounding = ROUNDING_OF_DRAWS * abs(value) if isinstance(value, float | int) else 0.0
            # Start and section together can cause a contact loss that neither causes alone.
            widest = math.inf if name in LOSS_QUANTITIES and {"start", "section"} <= parts.keys() else WIDEST_RATIO
            plausible = len(numbers) == len(expected) and all(
                _is_plausible(width, other, rounding, widest) for width, other in zip(numbers, expected, strict=True)
            )
            exact = plausible and all(map(same_number, numbers, expected))
            if not plausible or (not exact and set(parts) == {"discretisation"}):
                yield f"pantograph {key}: uncertainty of {name} does not follow from its components"


# Check of a comparison with a baseline: bounds, numbers and verdict must follow from the criteria of drift.
def check_baseline(case: CaseResult) -> Iterator[str]:
    """Find contradictions between a comparison with a baseline and the criteria of drift."""
    comparison = case.baseline
    rows = [row for row in case.criteria if row.is_drift]
    if comparison is None:
        yield from (f"{row.quantity}: drift without a comparison with a baseline" for row in rows)
        return
    for row in rows:
        if row.verdict not in ("fail", "skip"):
            yield f"{row.quantity}: verdict '{row.verdict}' among the values that drifted"
        if row.baseline is not None:
            yield from _check_bounds(row, row.baseline, comparison.drift_pct)
    verdict = judge_baseline((row.verdict for row in rows), comparison.values)
    if comparison.verdict != verdict:
        yield f"baseline '{comparison.verdict}' stated, '{verdict}' follows from the criteria of drift"
    drifted = sum(row.baseline is not None for row in rows)
    if comparison.drifted != drifted or drifted > comparison.values:
        yield f"{comparison.drifted} of {comparison.values} values drifted are stated, {drifted} are listed"


def _check_bounds(row: Criterion, baseline: float, drift_pct: float) -> Iterator[str]:
    if (row.lower, row.upper) != bound_drift(row.quantity, baseline, drift_pct):
        yield f"{row.quantity}: the bounds do not follow from the baseline and the accepted drift"


# Check of a procedure: verdicts of its steps and claims must follow from criteria, cases and evidence.
def check_procedure(
    stated: Procedure | None,
    decided: Procedure | None,
    cases: list[CaseResult],
    check_grade: Callable[[Criterion], Iterator[str]],
) -> Iterator[str]:
    """Find contradictions of a stated procedure with the verdicts that follow; `check_grade` checks one criterion."""
    if stated is None or decided is None:
        return
    if tuple(step.step for step in stated.steps) != STEP_NAMES:
        yield "procedure: its steps are not complete, or not in their order"
    named = [name for step in stated.steps for name in step.cases]
    for case in cases:
        if named.count(case.id) != 1:
            yield f"procedure: {case.id} belongs to {named.count(case.id)} steps"
    for step in stated.steps:
        for row in step.criteria:
            yield from (f"step {step.step}, {row.quantity}: {text}" for text in check_grade(row))
    for name, old, new in zip(STEP_NAMES, stated.steps, decided.steps, strict=False):
        if old != new:
            yield f"step {name}: verdict '{old.verdict}', margin or uncertainty do not follow: '{new.verdict}'"
    for old_claim, new_claim in zip(stated.claims, decided.claims, strict=True):
        if old_claim != new_claim:
            yield f"claim on {old_claim.kind}: '{old_claim.verdict}' stated, '{new_claim.verdict}' follows"
    if stated.evidence != decided.evidence:
        yield "procedure: the passed runs are not those whose cases pass"
