"""Pages of the documentation, and their code blocks."""

import re
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"


def read_page(name: str) -> str:
    return (DOCS / name).read_text(encoding="utf-8")


def list_blocks(page: str, language: str) -> list[str]:
    """Code blocks of a page in a language; those without a language under the empty text."""
    fenced = re.findall(r"^```(\w*)\n(.*?)^```$", read_page(page), re.DOTALL | re.MULTILINE)
    return [text for name, text in fenced if name == language]
