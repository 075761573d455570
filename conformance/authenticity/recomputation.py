"""Recomputation of results from their own numbers: a value that does not follow from its inputs is a discrepancy."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

from pantocheck.conformance.authenticity.reported_numbers import EXACT, ROUNDED, same_number, select_item
from pantocheck.conformance.authenticity.uncertainty_check import check_combination, check_components
from pantocheck.conformance.grading.case_verdict import judge_case, read_participation
from pantocheck.conformance.grading.near_limit import ValueErrors, near_limit_remarks
from pantocheck.conformance.grading.start_agreement import list_verification_components
from pantocheck.conformance.grading.verdicts import Verdict, judge, margin
from pantocheck.conformance.input_files.trust import limit_counts
from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.quantities.statistics import coefficient_of_variation, statistical_extremes
from pantocheck.conformance.results.criterion_format import COMPONENT_NAMES
from pantocheck.conformance.results.finding_format import count_findings, count_verdict, judge_finding
from pantocheck.conformance.results.record_facts import RecordFacts
from pantocheck.conformance.results.results_format import Results


def find_discrepancies(results: dict[str, Any]) -> list[str]:
    """Find contradictions between the numbers and verdicts of results.

    Parameters
    ----------
    results : dict of str
        Content of a valid results.json.

    Returns
    -------
    list of str
        One line per contradiction.
    """
    discrepancies = [text for case in results["cases"] for text in _check_case(case, results["trust"])]
    stated = Results.model_validate(results)
    decided = read_participation(stated).decide_run(stated)
    pairs: list[tuple[str, Verdict | None, Verdict | None]] = [
        (f"{case.id}: ", case.verdict, other.verdict) for case, other in zip(stated.cases, decided.cases, strict=True)
    ]
    pairs.append(("", stated.verdict, decided.verdict))
    pairs.append(("verification: ", stated.verification_verdict, decided.verification_verdict))
    if stated.criteria_verdict is not None:  # null: made by a version without a second verdict
        pairs.append(("EN 50318 criteria: ", stated.criteria_verdict, decided.criteria_verdict))
    findings = count_findings(row.finding for case in stated.cases for row in case.criteria)
    return [
        *discrepancies,
        *(() if stated.findings == findings else ("the numbers of findings do not follow from the criteria",)),
        *(f"{where}verdict '{old}' stated, '{new}' follows from the cases" for where, old, new in pairs if old != new),
    ]


def _check_case(case: dict[str, Any], trust: Any) -> Iterator[str]:
    stated, verification = case["criteria_verdict"] or case["verdict"], case["verification"]
    yield from (f"{case['id']}, {text}" for text in check_combination(case))
    record = None if case["record"] is None else RecordFacts.model_validate(case["record"])
    ungraded = not case["criteria"] and case["reason"] and stated in ("skip", "error")
    if record is None and case["run"]["evaluated_m"] is not None and not ungraded:
        yield f"{case['id']}: the state of the record is missing"
    yield from _check_criteria(case, case["criteria"], trust)
    verdict = judge_case((row["verdict"] for row in case["criteria"]), record)
    if stated != verdict and not ungraded:
        yield f"{case['id']}: verdict '{stated}' stated, '{verdict}' follows from the criteria and the record"
    if verification is not None:
        yield from _check_verification(case, verification, record)
    for key, quantities in case["quantities"].items():
        trace = case["traces"].get(key)
        # Statistics delivered as numbers are rounded, and printed tables are not always consistent.
        computed = trace is not None or case["run"]["rate_Hz"] is not None
        statistics = (*_check_order(quantities), *(_check_statistics(quantities) if computed else ()))
        for text in (*statistics, *(_check_trace(quantities, trace) if trace else ())):
            yield f"{case['id']}, pantograph {key}: {text}"


def _check_criteria(case: dict[str, Any], criteria: list[dict[str, Any]], trust: Any) -> Iterator[str]:
    start = case["record"] and case["record"]["start"]
    names = list_verification_components(start) if trust == "computed" else COMPONENT_NAMES
    for row in criteria:
        where = f"{case['id']}, {row['quantity']} of pantograph {row['pantograph']}"
        components = check_components(row, case["uncertainty_components"], names)
        for text in (*_check_value(row, case["quantities"]), *components, *_check_grade(row, trust)):
            yield f"{where}: {text}"


def _check_verification(
    case: dict[str, Any], verification: dict[str, Any], record: RecordFacts | None
) -> Iterator[str]:
    """Verification: its verdict must follow from its criteria; without criteria it must not pass."""
    for text in _check_criteria(case, verification["criteria"], "computed"):
        yield f"verification: {text}"
    verdict, stated = judge_case((row["verdict"] for row in verification["criteria"]), record), verification["verdict"]
    if stated != verdict and (verification["criteria"] or stated not in ("info", "skip", "error")):
        yield f"{case['id']}: verification '{stated}' stated, '{verdict}' follows from its criteria and the record"


def _check_value(row: dict[str, Any], quantities: dict[str, Any]) -> Iterator[str]:
    """The graded value must be the reported quantity."""
    reported = select_item(quantities.get(str(row["pantograph"]), {}).get(row["quantity"]), row["item"])
    if row["value"] != reported:
        yield f"value {_format(row['value'])} graded, {_format(reported)} reported among the quantities"


def _check_grade(row: dict[str, Any], trust: Any) -> Iterator[str]:
    """Verdict, margin and remarks on a close limit must follow from value, limits, errors and trust."""
    value, lower, upper = row["value"], row["lower"], row["upper"]
    if lower is None and upper is None:
        # Only a rule without a bound for this record, which is skipped, may lack a limit.
        if row["verdict"] != ("skip" if limit_counts(row["trust"], trust) else "info"):
            yield "no limit"
        return
    if lower is not None and upper is not None and lower > upper:
        yield f"lower limit {_format(lower)} above upper limit {_format(upper)}"
        return
    judged = "skip" if value is None else judge(value, lower, upper)
    finding = row["finding"]
    if finding is not None and finding["outcome"] != judge_finding(finding["role"], judged):
        yield f"finding '{finding['outcome']}' stated, '{judge_finding(finding['role'], judged)}' follows"
    role = None if finding is None else finding["role"]
    verdict = count_verdict(role, judged) if limit_counts(row["trust"], trust) else "info"
    if row["verdict"] != verdict:
        yield f"verdict '{row['verdict']}' stated, '{verdict}' follows from value, limits and trust"
    expected = None if value is None else margin(value, lower, upper)
    if not same_number(row["margin"], expected, EXACT):
        yield f"margin {_format(row['margin'])} stated, {_format(expected)} follows from value and limits"
    errors = ValueErrors(row["discretisation_error"], row["spread"], row["components"], row["limit_uncertainty"])
    if row["components"] and not same_number(row["uncertainty"], errors.uncertainty, EXACT):
        printed, combined = _format(row["uncertainty"]), _format(errors.uncertainty)
        yield f"uncertainty {printed} stated, {combined} follows from its components"
    remarks = near_limit_remarks(value, (lower, upper), row["unit"], errors)
    if row["close"] != remarks:
        stated = len(row["close"])
        yield f"{stated} remarks on a close limit stated, {len(remarks)} follow from value, limits and errors"


def _check_statistics(quantities: dict[str, Any]) -> Iterator[str]:
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
            stated = _format(quantities[name])
            yield f"{name} {stated} stated, {_format(value)} follows from mean and standard deviation"


def _check_order(quantities: dict[str, Any]) -> Iterator[str]:
    """The minimum must not exceed the maximum."""
    low, high = quantities.get("min_force_N"), quantities.get("max_force_N")
    if low is not None and high is not None and low > high:
        yield f"min_force_N {_format(low)} above max_force_N {_format(high)}"


def _check_trace(quantities: dict[str, Any], trace: dict[str, Any]) -> Iterator[str]:
    """Drawn curves must agree with the stated quantities."""
    for key, name in (("mean_N", "mean_force_N"), ("std_N", "std_force_N")):
        if name in quantities and trace[key] is not None and not same_number(trace[key], quantities[name], ROUNDED):
            yield f"{name} {_format(quantities[name])} stated, {_format(trace[key])} drawn"
    force = trace["force_20_N"]
    if force:
        # The drawn force is thinned: it may miss the extremes, but must not exceed them.
        slack = ROUNDED * max(map(abs, force))
        if "max_force_N" in quantities and max(force) > quantities["max_force_N"] + slack:
            yield f"max_force_N {_format(quantities['max_force_N'])} stated, {_format(max(force))} drawn"
        if "min_force_N" in quantities and min(force) < quantities["min_force_N"] - slack:
            yield f"min_force_N {_format(quantities['min_force_N'])} stated, {_format(min(force))} drawn"
    yield from _check_bands(quantities, trace["spectrum"]["frequency_Hz"], trace["spectrum"]["amplitude_N"])


def _check_bands(quantities: dict[str, Any], frequency: list[float], amplitude: list[float]) -> Iterator[str]:
    """RMS values of the bands must follow from the drawn spectrum by Parseval, if it has all its lines."""
    steps = [b - a for a, b in pairwise(frequency)]
    complete = len(frequency) == len(amplitude) and steps and max(steps) - min(steps) <= ROUNDED * max(frequency)
    if not complete:
        return
    for low, high, name in BANDS:
        # Rounding may have moved a line onto an edge, so that its band is unknown.
        doubtful = any(abs(f - edge) <= ROUNDED * edge for f in frequency for edge in (low, high) if edge)
        if name not in quantities or doubtful:
            continue
        power = sum(a * a / 2 for f, a in zip(frequency, amplitude, strict=True) if low < f <= high)
        if not same_number(quantities[name], math.sqrt(power), ROUNDED):
            yield f"{name} {_format(quantities[name])} stated, {_format(math.sqrt(power))} follows from the spectrum"


def _format(value: float | None) -> str:
    return "nothing" if value is None else f"{value:.10g}"
