"""Grading results once more from their own numbers: what does not follow from its inputs is a discrepancy."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

from pantocheck.conformance.grading.verdicts import judge, margin, worst_verdict
from pantocheck.conformance.input_files.trust import limit_counts
from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.quantities.statistics import coefficient_of_variation, statistical_extremes

# Numbers of results.json carry all their digits, so only the last bits may differ; traces are rounded to six digits.
EXACT, ROUNDED = 1e-9, 2e-5


def find_discrepancies(results: dict[str, Any]) -> list[str]:
    """Everything in results that contradicts something else in them.

    Parameters
    ----------
    results : dict[str, Any]
        Valid results.json as a dictionary.
    """
    found = [text for case in results["cases"] for text in _case(case, results["trust"])]
    verdict = worst_verdict(case["verdict"] for case in results["cases"])
    if results["verdict"] != verdict:
        found.append(f"verdict: '{results['verdict']}' stated, '{verdict}' follows from the cases")
    return found


def _case(case: dict[str, Any], trust: Any) -> Iterator[str]:
    for row in case["criteria"]:
        where = f"{case['id']}, {row['quantity']} of pantograph {row['pantograph']}"
        for text in (*_value(row, case["quantities"]), *_grade(row, trust)):
            yield f"{where}: {text}"
    verdict = worst_verdict(row["verdict"] for row in case["criteria"])
    ungraded = not case["criteria"] and case["reason"] and case["verdict"] in ("skip", "error")
    if case["verdict"] != verdict and not ungraded:
        yield f"{case['id']}: verdict '{case['verdict']}' stated, '{verdict}' follows from the criteria"
    for key, quantities in case["quantities"].items():
        trace = case["traces"].get(key)
        # Statistics that were delivered as numbers are rounded, and printed tables are not always consistent.
        computed = trace is not None or case["run"]["rate_Hz"] is not None
        statistics = (*_ordered(quantities), *(_statistics(quantities) if computed else ()))
        for text in (*statistics, *(_trace(quantities, trace) if trace else ())):
            yield f"{case['id']}, pantograph {key}: {text}"


def _value(row: dict[str, Any], quantities: dict[str, Any]) -> Iterator[str]:
    """The value graded is the quantity reported."""
    reported = quantities.get(str(row["pantograph"]), {}).get(row["quantity"])
    if isinstance(reported, list):
        at = (row["item"] or 1) - 1
        reported = reported[at] if 0 <= at < len(reported) else None
    if row["value"] != reported:
        yield f"value {_shown(row['value'])} graded, {_shown(reported)} reported among the quantities"


def _grade(row: dict[str, Any], trust: Any) -> Iterator[str]:
    """Verdict and margin follow from value, limits and trust."""
    value, lower, upper = row["value"], row["lower"], row["upper"]
    if lower is None and upper is None:
        # A rule that has no bound for this record is skipped; nothing else may be without a limit.
        if row["verdict"] != ("skip" if limit_counts(row["trust"], trust) else "info"):
            yield "no limit"
        return
    if lower is not None and upper is not None and lower > upper:
        yield f"lower limit {_shown(lower)} above upper limit {_shown(upper)}"
        return
    verdict = "skip" if value is None else judge(value, lower, upper)
    if not limit_counts(row["trust"], trust):
        verdict = "info"
    if row["verdict"] != verdict:
        yield f"verdict '{row['verdict']}' stated, '{verdict}' follows from value, limits and trust"
    expected = None if value is None else margin(value, lower, upper)
    if not _same(row["margin"], expected, EXACT):
        yield f"margin {_shown(row['margin'])} stated, {_shown(expected)} follows from value and limits"


def _statistics(quantities: dict[str, Any]) -> Iterator[str]:
    """Quantities that are functions of others."""
    mean, std, std_50 = (quantities.get(name) for name in ("mean_force_N", "std_force_N", "std_force_50_N"))
    expected: dict[str, float] = {}
    if mean is not None and std is not None:
        expected["statistical_min_N"], expected["statistical_max_N"] = statistical_extremes(mean, std)
    if mean is not None and mean > 0:
        ratios = {"cov_20": std, "cov_50": std_50}
        expected |= {k: coefficient_of_variation(mean, v) for k, v in ratios.items() if v is not None}
    for name, value in expected.items():
        if name in quantities and not _same(quantities[name], value, EXACT):
            yield f"{name} {_shown(quantities[name])} stated, {_shown(value)} follows from mean and standard deviation"


def _ordered(quantities: dict[str, Any]) -> Iterator[str]:
    """Extremes are in their order."""
    low, high = quantities.get("min_force_N"), quantities.get("max_force_N")
    if low is not None and high is not None and low > high:
        yield f"min_force_N {_shown(low)} above max_force_N {_shown(high)}"


def _trace(quantities: dict[str, Any], trace: dict[str, Any]) -> Iterator[str]:
    """What is drawn agrees with what is stated."""
    for key, name in (("mean_N", "mean_force_N"), ("std_N", "std_force_N")):
        if name in quantities and trace[key] is not None and not _same(trace[key], quantities[name], ROUNDED):
            yield f"{name} {_shown(quantities[name])} stated, {_shown(trace[key])} drawn"
    force = trace["force_20_N"]
    if force:
        # The drawn force is thinned: it may miss the extremes, but not go beyond them.
        slack = ROUNDED * max(map(abs, force))
        if "max_force_N" in quantities and max(force) > quantities["max_force_N"] + slack:
            yield f"max_force_N {_shown(quantities['max_force_N'])} stated, {_shown(max(force))} drawn"
        if "min_force_N" in quantities and min(force) < quantities["min_force_N"] - slack:
            yield f"min_force_N {_shown(quantities['min_force_N'])} stated, {_shown(min(force))} drawn"
    yield from _bands(quantities, trace["spectrum"]["frequency_Hz"], trace["spectrum"]["amplitude_N"])


def _bands(quantities: dict[str, Any], frequency: list[float], amplitude: list[float]) -> Iterator[str]:
    """RMS of the bands by Parseval from the drawn spectrum, if it has all its lines."""
    steps = [b - a for a, b in pairwise(frequency)]
    whole = len(frequency) == len(amplitude) and steps and max(steps) - min(steps) <= ROUNDED * max(frequency)
    if not whole:
        return
    for low, high, name in BANDS:
        # Rounding may have moved a line onto an edge, so that its band cannot be told.
        doubtful = any(abs(f - edge) <= ROUNDED * edge for f in frequency for edge in (low, high) if edge)
        if name not in quantities or doubtful:
            continue
        power = sum(a * a / 2 for f, a in zip(frequency, amplitude, strict=True) if low < f <= high)
        if not _same(quantities[name], math.sqrt(power), ROUNDED):
            yield f"{name} {_shown(quantities[name])} stated, {_shown(math.sqrt(power))} follows from the spectrum"


def _same(a: float | None, b: float | None, tolerance: float) -> bool:
    if a is None or b is None:
        return a is b
    return math.isclose(a, b, rel_tol=tolerance, abs_tol=tolerance)


def _shown(value: float | None) -> str:
    return "nothing" if value is None else f"{value:.10g}"
