"""The known limitations as a page of the site."""

from pathlib import Path

LIMITATIONS = Path(__file__).parents[2] / "templates" / "known-limitations.md"


def build_limitations_page() -> str:
    """Text of the only list of the limitations, with its links as seen from the folder of generated pages."""
    return LIMITATIONS.read_text(encoding="utf-8").replace("](../docs/", "](../")
