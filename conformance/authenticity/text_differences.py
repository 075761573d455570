"""First difference of two texts, as a sentence."""

from collections.abc import Iterator, Sequence
from itertools import zip_longest

QUOTED_CHARACTERS = 80
"""Largest number of characters of a quoted text."""

CHARACTERS_BEFORE = 30
"""Number of characters quoted before the first difference of two long texts."""


def compare_lines(stated: Sequence[str], expected: Sequence[str]) -> Iterator[str]:
    """First line of a text that differs from the expected text.

    Args:
        stated: Lines of the document.
        expected: Lines that the results give.

    Yields:
        One sentence, if the texts differ.
    """
    for line, other in zip_longest(stated, expected):
        if line != other:
            printed, follows = quote_difference(line, other)
            yield f"{printed} is printed, {follows} follows from the results"
            return


def quote_difference(text: str | None, other: str | None) -> tuple[str, str]:
    """Short quotations of two different texts, which both show their first difference; `nothing` for a missing text."""
    if text is None or other is None:
        return quote(text), quote(other)
    first = next((i for i, (a, b) in enumerate(zip_longest(text, other)) if a != b), 0)
    start = max(0, first - CHARACTERS_BEFORE) if max(len(text), len(other)) > QUOTED_CHARACTERS else 0
    quoted = (quote(part[start:]) for part in (text, other))
    before, after = (f"'…{part[1:]}" if start else part for part in quoted)
    return before, after


def quote(text: str | None) -> str:
    """Short quotation of a line; `nothing` for a missing line."""
    if text is None:
        return "nothing"
    return f"'{text}'" if len(text) <= QUOTED_CHARACTERS else f"'{text[:QUOTED_CHARACTERS]}…'"
