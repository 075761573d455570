"""Known limitations of the suite, from the Markdown file that is their only home."""

from pathlib import Path

from verification.guide.guide_format import Limitation

DOCS = Path(__file__).parents[2] / "docs"
LIMITATIONS_FILE = "known-limitations.md"
"""Page of the documentation: a heading of second level per limitation, and list items below it."""


def read_limitations() -> list[Limitation]:
    """Known limitations, in the order of their file."""
    text = (DOCS / LIMITATIONS_FILE).read_text("utf-8")
    return [_read_limitation(part) for part in text.split("\n## ")[1:]]


def _read_limitation(part: str) -> Limitation:
    title, _, body = part.partition("\n")
    items = [" ".join(item.split()) for item in f"\n{body}".split("\n* ")[1:]]
    return Limitation(title=title.strip(), sentences=items)
