"""Why a verdict is what it is: what failed, what could not be evaluated, and the closest margins."""

from collections import Counter
from typing import Any

from pantocheck.conformance.reports.certificate.criteria_rows import (
    criterion_title,
    format_signed,
    is_unresolved,
    total_error,
)
from pantocheck.conformance.reports.certificate.page_content import Reasons
from pantocheck.conformance.reports.page_text import format_beside_limits, format_limits
from pantocheck.conformance.reports.words import owner, read_words

CLOSEST = 3


def build_headline(results: dict[str, Any]) -> str:
    """The verdict in one sentence with its count."""
    verdicts = Counter(row["verdict"] for case in results["cases"] for row in case["criteria"])
    counted = sum(verdicts[v] for v in ("pass", "fail", "skip", "error"))
    cases = f"{len(results['cases'])} {'case' if len(results['cases']) == 1 else 'cases'}"
    broken = sum(case["verdict"] == "error" for case in results["cases"])
    if broken:
        return f"{broken} of {cases} ended in an error."
    if verdicts["fail"]:
        return f"{verdicts['fail']} of {counted} counted criteria in {cases} lie outside their limits."
    if results["verdict"] == "skip":
        idle = sum(case["verdict"] == "skip" for case in results["cases"])
        return f"{idle} of {cases} could not be evaluated in full; {verdicts['pass']} of {counted} criteria are inside."
    if not counted:
        return f"No limit counts in {cases}: the numbers are informative."
    if verdicts["pass"] == counted:
        return f"All {counted} counted criteria in {cases} lie inside their limits."
    return f"{verdicts['pass']} of {counted} counted criteria in {cases} lie inside their limits."


def build_reasons(results: dict[str, Any]) -> tuple[Reasons, ...]:
    """Sentences under headings, the gravest first; empty groups are left out."""
    cases = results["cases"]
    rows = [(case, row) for case in cases for row in case["criteria"]]

    def of(verdict: str) -> list[tuple[dict[str, Any], dict[str, Any]]]:
        chosen = [(case, row) for case, row in rows if row["verdict"] == verdict]
        return sorted(chosen, key=lambda pair: 0.0 if pair[1].get("margin") is None else pair[1]["margin"])

    def whole(verdict: str) -> list[str]:
        return [
            f"{case['id']}: {case['reason']}" for case in cases if case["verdict"] == verdict and case.get("reason")
        ]

    unsure: dict[str, list[str]] = {}
    for case, row in rows:
        if is_unresolved(row):
            unsure.setdefault(total_error(row)[1], []).append(_where(case, row))
    groups = (
        ("What could not be run", [*whole("error"), *(_why(case, row) for case, row in of("error"))]),
        ("What failed", [*whole("fail"), *(_where(case, row) for case, row in of("fail"))]),
        ("What could not be evaluated", [*whole("skip"), *(_why(case, row) for case, row in of("skip"))]),
        *((f"Closer to a limit than the {name}", sentences) for name, sentences in unsure.items()),
        ("Closest margins", [_where(case, row) for case, row in of("pass") if _has_width(row)][:CLOSEST]),
    )
    return tuple(Reasons(name, tuple(sentences)) for name, sentences in groups if sentences)


def build_case_reasons(case: dict[str, Any]) -> str:
    """The verdict of one case in one sentence."""
    if case.get("reason"):
        return str(case["reason"])
    verdicts = Counter(row["verdict"] for row in case["criteria"])
    words_of = read_words()["verdict"]
    parts = [
        f"{verdicts[v]} {words_of[v]['meaning'] if v != 'info' else 'informative'}"
        for v in ("error", "fail", "skip", "pass", "info")
        if verdicts[v]
    ]
    return f"{sum(verdicts.values())} criteria: {', '.join(parts)}." if parts else "No criteria."


def criterion_subject(row: dict[str, Any]) -> str:
    """The owner of a value and the quantity's name in words."""
    return f"{owner(row)}, {criterion_title(row)}"


def _has_width(row: dict[str, Any]) -> bool:
    """Whether a margin above 0 is possible: between two equal limits it is 0 at best, and tells nothing."""
    return bool(row["lower"] != row["upper"])


def _where(case: dict[str, Any], row: dict[str, Any]) -> str:
    value = format_beside_limits(row["value"], row["lower"], row["upper"])
    margin = "" if row.get("margin") is None else f", margin {format_signed(row['margin'])}"
    text = f"{case['id']}, {criterion_subject(row)}: {value} {row.get('unit') or ''}".rstrip()
    return f"{text}, limits {format_limits(row['lower'], row['upper'])}{margin}."


def _why(case: dict[str, Any], row: dict[str, Any]) -> str:
    return f"{case['id']}, {criterion_subject(row)}: {row.get('reason') or 'no reason given'}"
