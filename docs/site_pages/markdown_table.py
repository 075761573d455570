"""Tables in Markdown."""

import re
from collections.abc import Iterable, Sequence


def build_markdown_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Table in Markdown; cells are Markdown already, line breaks and bars in them are replaced."""
    lines = (headings, ["---"] * len(headings), *rows)
    return "\n".join("| " + " | ".join(map(_clean_cell, line)) + " |" for line in lines)


def escape_text(text: str) -> str:
    """Text that Markdown shows unchanged."""
    return re.sub(r"([\\`*_{}\[\]<>$])", r"\\\1", text)


def _clean_cell(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())
