"""Remarks of a run: those of several cases are footnotes, printed once; others are warnings of their case."""

from collections import Counter
from collections.abc import Sequence

from pantocheck.conformance.results.results_format import CaseResult

STANDING_REMARKS = ("20-50 Hz: lumped models",)
"""Begin of remarks that hold for every run and that a user cannot act on."""


def list_footnotes(cases: Sequence[CaseResult]) -> list[str]:
    """Remarks that are printed once, in their order: standing ones, and those that several cases have in common.

    Args:
        cases: All cases of a run.
    """
    counts = Counter(warning for case in cases for warning in dict.fromkeys(case.warnings))
    return [text for text, count in counts.items() if count > 1 or text.startswith(STANDING_REMARKS)]


def mark_footnotes(case: CaseResult, footnotes: Sequence[str]) -> str:
    """Marks of the footnotes that apply to a case, such as `[1] [2]`; empty without one."""
    return " ".join(f"[{number}]" for number, text in enumerate(footnotes, 1) if text in case.warnings)
