"""Consistency checks of a record."""

from pantocheck.conformance.runs.record_checks import RECORD_CHECKS
from site_pages.markdown_table import build_markdown_table, escape_text


def build_check_table() -> str:
    """Condition, needs and reason of every check."""
    rows = [(check.name, *map(escape_text, (check.must_hold, check.needs, check.why))) for check in RECORD_CHECKS]
    return build_markdown_table(("check", "condition", "needs", "reason"), rows) + "\n"
