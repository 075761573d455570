"""Reasons of a verdict: failed and missing criteria, close values and the smallest margins."""

from collections import Counter
from collections.abc import Iterator
from typing import Any

from pantocheck.conformance.reports.certificate.criteria_table import criterion_title, format_signed, is_close
from pantocheck.conformance.reports.document import BulletList, Section
from pantocheck.conformance.reports.page_text import format_beside_limits, format_limits
from pantocheck.conformance.reports.words import name_owner, read_words

MARGINS_SHOWN = 3
"""Number of the smallest margins in the reasons."""


def build_headline(results: dict[str, Any]) -> str:
    """The verdict in one sentence with its counts."""
    verdicts = Counter(criterion["verdict"] for case in results["cases"] for criterion in case["criteria"])
    counted = sum(verdicts[verdict] for verdict in ("pass", "fail", "skip", "error"))
    cases = f"{len(results['cases'])} {'case' if len(results['cases']) == 1 else 'cases'}"
    broken = sum(case["verdict"] == "error" for case in results["cases"])
    if broken:
        return f"{broken} of {cases} ended in an error."
    if verdicts["fail"]:
        return f"{verdicts['fail']} of {counted} counted criteria in {cases} lie outside their limits."
    if results["verdict"] == "skip":
        incomplete = sum(case["verdict"] == "skip" for case in results["cases"])
        inside = f"{verdicts['pass']} of {counted} criteria are inside their limits"
        return f"{incomplete} of {cases} could not be evaluated completely; {inside}."
    if not counted:
        return f"No limit counts in {cases}: the numbers are informative."
    if verdicts["pass"] == counted:
        return f"All {counted} counted criteria in {cases} lie inside their limits."
    return f"{verdicts['pass']} of {counted} counted criteria in {cases} lie inside their limits."


def list_reasons(results: dict[str, Any]) -> tuple[Section, ...]:
    """Sentences under headings, errors first; a heading without sentences is left out."""
    passed = _select(results, "pass")
    bounded = [(case, criterion) for case, criterion in passed if criterion["lower"] != criterion["upper"]]
    groups = {
        "Errors": [*_case_reasons(results, "error"), *map(_reason, _select(results, "error"))],
        "Failed": [*_case_reasons(results, "fail"), *map(_value, _select(results, "fail"))],
        "Not evaluated": [*_case_reasons(results, "skip"), *map(_reason, _select(results, "skip"))],
        "Closer to a limit than an error": [_value(pair) for pair in _criteria(results) if is_close(pair[1])],
        # Between two equal limits a margin is 0 at best and says nothing about closeness.
        "Smallest margins": [_value(pair) for pair in bounded[:MARGINS_SHOWN]],
    }
    return tuple(
        Section(heading, (BulletList(tuple(sentences)),)) for heading, sentences in groups.items() if sentences
    )


def summarise_case(case: dict[str, Any]) -> str:
    """The verdict of one case in one sentence."""
    if case["reason"]:
        return str(case["reason"])
    verdicts = Counter(criterion["verdict"] for criterion in case["criteria"])
    words = read_words()["verdict"]
    parts = [
        f"{verdicts[verdict]} {words[verdict]['meaning'] if verdict != 'info' else 'informative'}"
        for verdict in ("error", "fail", "skip", "pass", "info")
        if verdicts[verdict]
    ]
    return f"{sum(verdicts.values())} criteria: {', '.join(parts)}." if parts else "No criteria."


CaseCriterion = tuple[dict[str, Any], dict[str, Any]]
"""A case and one of its criteria."""


def _criteria(results: dict[str, Any]) -> Iterator[CaseCriterion]:
    return ((case, criterion) for case in results["cases"] for criterion in case["criteria"])


def _select(results: dict[str, Any], verdict: str) -> list[CaseCriterion]:
    """Criteria with one verdict, the smallest margin first."""
    pairs = [pair for pair in _criteria(results) if pair[1]["verdict"] == verdict]
    return sorted(pairs, key=lambda pair: pair[1]["margin"] or 0.0)


def _case_reasons(results: dict[str, Any], verdict: str) -> list[str]:
    return [
        f"{case['id']}: {case['reason']}" for case in results["cases"] if case["verdict"] == verdict and case["reason"]
    ]


def _value(pair: CaseCriterion) -> str:
    case, criterion = pair
    value = format_beside_limits(criterion["value"], criterion["lower"], criterion["upper"])
    margin = "" if criterion["margin"] is None else f", margin {format_signed(criterion['margin'])}"
    text = f"{_subject(case, criterion)}: {value} {criterion['unit']}".rstrip()
    return f"{text}, limits {format_limits(criterion['lower'], criterion['upper'])}{margin}."


def _reason(pair: CaseCriterion) -> str:
    case, criterion = pair
    return f"{_subject(case, criterion)}: {criterion['reason'] or 'no reason given'}"


def _subject(case: dict[str, Any], criterion: dict[str, Any]) -> str:
    return f"{case['id']}, {name_owner(criterion)}, {criterion_title(criterion)}"
