"""CONTRIBUTING.md as a page of the site."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]


def build_contributing_page() -> str:
    """Text of CONTRIBUTING.md with its links to pages; other files of the repository are named without a link."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    text = re.sub(r"\]\(docs/([^)]*)\)", r"](../\1)", text)
    return re.sub(r"\[([^\]]*)\]\((?!\.\./|https?:|#)[^)]*\)", r"\1", text)
