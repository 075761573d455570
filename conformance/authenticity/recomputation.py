"""Recomputation of results from their own numbers: a value that does not follow from its inputs is a discrepancy."""

from collections.abc import Iterator, Mapping, Sequence

from pantocheck.conformance.authenticity.baseline_check import check_baseline, list_graded
from pantocheck.conformance.authenticity.procedure_check import check_procedure
from pantocheck.conformance.authenticity.reported_numbers import (
    EXACT,
    format_exact,
    same_number,
    select_first,
)
from pantocheck.conformance.authenticity.trace_check import check_trace, check_uplift
from pantocheck.conformance.authenticity.uncertainty_check import check_combination, check_components
from pantocheck.conformance.grading.case_verdict import judge_case, read_participation
from pantocheck.conformance.grading.near_limit import ValueErrors, near_limit_remarks
from pantocheck.conformance.grading.start_agreement import list_verification_components
from pantocheck.conformance.grading.verdicts import Verdict, judge, margin
from pantocheck.conformance.input_files.trust import Computed, Trust, limit_counts
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.statistics import coefficient_of_variation, statistical_extremes
from pantocheck.conformance.results.criterion_format import COMPONENT_NAMES, CaseVerification, Criterion
from pantocheck.conformance.results.finding_format import count_findings, count_verdict, judge_finding
from pantocheck.conformance.results.record_facts import RecordFacts
from pantocheck.conformance.results.results_format import STATEMENT, CaseResult, Results
from pantocheck.conformance.results.results_part import Number, select_item
from pantocheck.conformance.results.scope import build_scope
from pantocheck.model.statics.wave_factors import amplification_coefficient, doppler_factor


def find_discrepancies(results: Results) -> list[str]:
    """Find contradictions between the numbers and verdicts of results.

    Args:
        results: Results of a document.

    Returns:
        One line per contradiction.
    """
    discrepancies = [text for case in results.cases for text in _check_case(case, results.trust)]
    decided = read_participation(results).decide_run(results)
    pairs: list[tuple[str, Verdict | None, Verdict | None]] = [
        (f"{case.id}: ", case.verdict, other.verdict) for case, other in zip(results.cases, decided.cases, strict=True)
    ]
    pairs.append(("", results.verdict, decided.verdict))
    pairs.append(("verification: ", results.verification_verdict, decided.verification_verdict))
    pairs.append(("baseline: ", results.baseline_verdict, decided.baseline_verdict))
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


def _check_case(case: CaseResult, trust: Trust | Computed) -> Iterator[str]:
    stated, verification = case.criteria_verdict or case.verdict, case.verification
    yield from (f"{case.id}, {text}" for text in check_combination(case))
    record = case.record
    graded = list_graded(case)
    ungraded = not graded and case.reason and stated in ("skip", "error")
    yield from _check_criteria(case, case.criteria, trust)
    yield from (f"{case.id}: {text}" for text in check_baseline(case))
    verdict = judge_case((row.verdict for row in graded), record)
    if stated != verdict and not ungraded:
        yield f"{case.id}: verdict '{stated}' stated, '{verdict}' follows from the criteria and the record"
    if verification is not None:
        yield from _check_verification(case, verification, record)
    yield from (f"{case.id}: {text}" for text in (*check_uplift(case), *_check_line(case)))
    for key, reported in case.quantities.items():
        quantities = select_first(reported)
        trace = case.traces.get(key)
        # Statistics delivered as numbers are rounded, and printed tables are not always consistent.
        computed = trace is not None or case.run.rate_Hz is not None
        statistics = (*_check_order(quantities), *(_check_statistics(quantities) if computed else ()))
        for text in (*statistics, *(check_trace(quantities, trace) if trace else ())):
            yield f"{case.id}, pantograph {key}: {text}"


def _check_criteria(case: CaseResult, criteria: Sequence[Criterion], trust: Trust | Computed) -> Iterator[str]:
    start = None if case.record is None else case.record.start
    names = list_verification_components(start) if trust == "computed" else COMPONENT_NAMES
    for row in criteria:
        where = f"{case.id}, {row.quantity} of pantograph {row.pantograph}"
        components = check_components(row, case.uncertainty_components, names)
        for text in (*_check_value(row, case.quantities), *components, *_check_grade(row, trust)):
            yield f"{where}: {text}"


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


def _check_grade(row: Criterion, trust: Trust | Computed) -> Iterator[str]:
    """Verdict, margin and remarks on a close limit must follow from value, limits, errors and trust."""
    quantity = QUANTITIES.get(row.quantity)
    if quantity is not None and row.unit != quantity.unit:
        yield f"unit '{row.unit}' stated, '{quantity.unit}' is the unit of this quantity"
    value, lower, upper = row.value, row.lower, row.upper
    if lower is None and upper is None:
        # Only a rule without a bound for this record, which is skipped, may lack a limit.
        if row.verdict != ("skip" if limit_counts(row.trust, trust) else "info"):
            yield "no limit"
        return
    if lower is not None and upper is not None and lower > upper:
        yield f"lower limit {format_exact(lower)} above upper limit {format_exact(upper)}"
        return
    judged = "skip" if value is None else judge(value, lower, upper)
    finding = row.finding
    if finding is not None and finding.outcome != judge_finding(finding.role, judged):
        yield f"finding '{finding.outcome}' stated, '{judge_finding(finding.role, judged)}' follows"
    role = None if finding is None else finding.role
    verdict = count_verdict(role, judged) if limit_counts(row.trust, trust) else "info"
    if row.verdict != verdict:
        yield f"verdict '{row.verdict}' stated, '{verdict}' follows from value, limits and trust"
    expected = None if value is None else margin(value, lower, upper)
    if not same_number(row.margin, expected, EXACT):
        yield f"margin {format_exact(row.margin)} stated, {format_exact(expected)} follows from value and limits"
    errors = ValueErrors(row.discretisation_error, row.spread, row.components, row.limit_uncertainty)
    if row.components and not same_number(row.uncertainty, errors.uncertainty, EXACT):
        printed, combined = format_exact(row.uncertainty), format_exact(errors.uncertainty)
        yield f"uncertainty {printed} stated, {combined} follows from its components"
    remarks = near_limit_remarks(value, (lower, upper), row.unit, errors)
    if row.close != remarks:
        stated, follow = len(row.close), len(remarks)
        texts = " with other texts" if stated == follow else ""
        yield f"{stated} remarks on a close limit stated, {follow}{texts} follow from value, limits and errors"


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
