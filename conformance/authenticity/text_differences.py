"""First difference of two texts, as a sentence."""

from collections.abc import Iterator, Sequence
from itertools import zip_longest

QUOTED_CHARACTERS = 80
"""Largest number of characters of a quoted text."""


def compare_lines(stated: Sequence[str], expected: Sequence[str]) -> Iterator[str]:
    """First line of a text that differs from the expected text.

    Parameters
    ----------
    stated : sequence of str
        Lines of the document.
    expected : sequence of str
        Lines that the results give.

    Yields
    ------
    str
        One sentence, if the texts differ.
    """
    for line, other in zip_longest(stated, expected):
        if line != other:
            yield f"{quote(line)} is printed, {quote(other)} follows from the results"
            return


def quote(text: str | None) -> str:
    """Short quotation of a line; `nothing` for a missing line."""
    if text is None:
        return "nothing"
    return f"'{text}'" if len(text) <= QUOTED_CHARACTERS else f"'{text[:QUOTED_CHARACTERS]}…'"
