"""Consistency checks of a record."""

from pantocheck.conformance.runs.check import Check
from pantocheck.conformance.runs.record_checks import RECORD_CHECKS
from site_pages.markdown_table import build_markdown_table, escape_text


def build_check_table() -> str:
    """Condition, numbers with their thresholds, needs and reason of every check."""
    rows = [
        (check.name, *map(escape_text, (check.must_hold, _list_thresholds(check), check.needs, check.purpose)))
        for check in RECORD_CHECKS
    ]
    return build_markdown_table(("check", "condition", "thresholds", "needs", "reason"), rows) + "\n"


def _list_thresholds(check: Check) -> str:
    """Numbers of a check with their thresholds; a dash for a check without a number."""
    return (
        "; ".join(
            f"{measure.name}: {outcome} {measure.side} {limit:g} {measure.unit}".rstrip()
            for measure in check.measures
            for outcome, limit in measure.thresholds.items()
        )
        or "–"
    )
