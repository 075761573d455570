"""Result of one check of a document."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from pantocheck.conformance.pages.words import clean_text

CheckOutcome = Literal["proved", "contradicted", "incomplete", "open"]
"""CheckOutcome of a check, `open` if it was not requested or needs more than the document.

`incomplete`: another version wrote the document, so that a part of it could not be compared. This is no contradiction,
but such a document is never accepted: otherwise a changed version number would hide changed pages.
"""


MOST_DETAILS = 12
"""Largest number of listed differences: the first ones show the change."""


@dataclass(frozen=True)
class DocumentCheck:
    """Result of one check."""

    outcome: CheckOutcome
    """CheckOutcome of the check."""
    statement: str
    """Fact that was proved or not, as a sentence."""
    details: tuple[str, ...] = ()
    """One line per contradiction, or per part that could not be compared."""


def shorten_details(details: Sequence[str]) -> tuple[str, ...]:
    """First details of a list; the last line counts the others."""
    rest = len(details) - MOST_DETAILS
    return (*details[:MOST_DETAILS], *([f"and {rest} more"] if rest > 0 else []))


def judge_details(proved: str, contradicted: str, details: Iterable[str]) -> DocumentCheck:
    """Check that is proved without details, and contradicted by each of them; control characters are removed."""
    lines = tuple(dict.fromkeys(map(clean_text, details)))
    return DocumentCheck("contradicted", contradicted, lines) if lines else DocumentCheck("proved", proved)
