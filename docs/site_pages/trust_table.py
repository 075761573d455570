"""Trust of the limits of each case."""

from collections import Counter

from pantocheck.conformance.cases.library import select_cases
from site_pages.markdown_table import build_markdown_table


def build_trust_table() -> str:
    """Number of limits of every library case at each trust."""
    rows = []
    for case in select_cases(["*"]):
        counts = Counter(limit.trust for limit in case.limits)
        rows.append((f"`{case.id}`", ", ".join(f"{count} {trust}" for trust, count in counts.items()) or "none"))
    return build_markdown_table(("case", "limits and their trust"), rows) + "\n"
