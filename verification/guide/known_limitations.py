"""Known limitations of the suite, from the Markdown file that is their only home."""

from pantocheck.conformance.reports.words import TEMPLATES
from verification.guide.guide_format import Limitation

LIMITATIONS_FILE = "known-limitations.md"
"""File among the templates: a heading of second level per limitation, and list items below it."""


def read_limitations() -> list[Limitation]:
    """Known limitations, in the order of their file."""
    text = (TEMPLATES / LIMITATIONS_FILE).read_text("utf-8")
    return [_read_limitation(part) for part in text.split("\n## ")[1:]]


def _read_limitation(part: str) -> Limitation:
    title, _, body = part.partition("\n")
    items = [" ".join(item.split()) for item in f"\n{body}".split("\n* ")[1:]]
    return Limitation(title=title.strip(), sentences=items)
