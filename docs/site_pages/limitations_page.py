"""The known limitations as a page of the site, with the trust of the limits of each case."""

from collections import Counter
from pathlib import Path

from pantocheck.conformance.cases.library import select_cases
from site_pages.markdown_table import build_markdown_table

LIMITATIONS = Path(__file__).parents[2] / "templates" / "known-limitations.md"


def build_limitations_page() -> str:
    """Text of the only list of the limitations, with its links as seen from the folder of generated pages."""
    text = LIMITATIONS.read_text(encoding="utf-8").replace("](../docs/", "](../").rstrip()
    return f"{text}\n\n## Trust of the limits by case\n\n{build_trust_table()}\n"


def build_trust_table() -> str:
    """Number of limits of every library case at each trust."""
    rows = []
    for case in select_cases(["*"]):
        counts = Counter(limit.trust for limit in case.limits)
        rows.append((f"`{case.id}`", ", ".join(f"{count} {trust}" for trust, count in counts.items()) or "none"))
    return build_markdown_table(("case", "limits and their trust"), rows)
