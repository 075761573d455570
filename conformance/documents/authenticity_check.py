"""Result of one check of a document, and the comparisons of numbers and texts of all checks."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from itertools import zip_longest
from typing import Literal, TypeAlias

from pantocheck.conformance.core.results_part import Number, select_item
from pantocheck.conformance.pages.words import clean_text

CheckOutcome = Literal["proved", "contradicted", "incomplete", "open"]
"""Outcome of a check; `open` if it was not requested or needs more than the document.

`incomplete`: another version wrote the document, so that a part of it could not be compared. This is not a
contradiction, but such a document is never accepted: otherwise a changed version number would hide changed pages.
"""


MOST_DETAILS = 12
"""Largest number of listed differences: the first ones show the change."""


@dataclass(frozen=True)
class DocumentCheck:
    """Result of one check."""

    outcome: CheckOutcome
    """Outcome of the check."""
    statement: str
    """Fact that was proved or not, as a sentence."""
    details: tuple[str, ...] = ()
    """One line per contradiction, or per part that could not be compared."""


def shorten_details(details: Sequence[str]) -> tuple[str, ...]:
    """First details of a list; the last line counts the others."""
    rest = len(details) - MOST_DETAILS
    return (*details[:MOST_DETAILS], *([f"and {rest} more"] if rest > 0 else []))


def judge_details(proved: str, contradicted: str, details: Iterable[str]) -> DocumentCheck:
    """Check that is contradicted if there are details, and otherwise proved; control characters are removed."""
    lines = tuple(dict.fromkeys(map(clean_text, details)))
    return DocumentCheck("contradicted", contradicted, lines) if lines else DocumentCheck("proved", proved)


# Numbers of results.json: their items, and their comparison.
EXACT, ROUNDED = 1e-9, 2e-5
"""Relative tolerances: numbers of results.json have all their digits, traces are rounded to six digits."""


def select_first(reported: Mapping[str, Number]) -> dict[str, float]:
    """Quantities with one number each: of several values, the first."""
    numbers = {name: select_item(value, None) for name, value in reported.items()}
    return {name: number for name, number in numbers.items() if number is not None}


def same_number(a: float | None, b: float | None, tolerance: float = EXACT) -> bool:
    """Whether two numbers agree within a relative and absolute tolerance, or both are missing."""
    if a is None or b is None:
        return a is b
    return math.isclose(a, b, rel_tol=tolerance, abs_tol=tolerance)


def format_exact(value: float | None) -> str:
    """Number with the digits that show a discrepancy; `nothing` for None."""
    return "nothing" if value is None else f"{value:.10g}"


# Comparison of two results number by number: bit for bit, or within a relative tolerance.
LeafPath = tuple[str | int, ...]
"""Keys and indices that lead to a leaf of nested dictionaries and lists."""

Leaf: TypeAlias = float | str | bool | None

NumberTree: TypeAlias = "Mapping[str, NumberTree] | Sequence[NumberTree] | Leaf"
"""Nested dictionaries and lists of numbers and texts."""


@dataclass(frozen=True)
class NumberComparison:
    """Comparison of the numbers of two trees."""

    count: int
    """Number of compared leaves."""
    largest: float
    """Largest relative difference of two numbers within the tolerance."""
    differences: tuple[str, ...]
    """Leaves that differ by more, one sentence each."""


def compare_numbers(stated: NumberTree, computed: NumberTree, tolerance: float) -> NumberComparison:
    """Compare two trees of numbers and texts.

    A number may differ by the tolerance relative to the largest number of its list, or to itself outside of a list: a
    curve passes through zero.

    Args:
        stated: Content of a document.
        computed: Content that was computed again.
        tolerance: Largest relative difference; 0: all bits are equal.
    """
    ours, theirs = dict(_leaves(stated, ())), dict(_leaves(computed, ()))
    scales = _scales(theirs)
    differences, largest = [], 0.0
    for path in dict.fromkeys([*ours, *theirs]):
        a, b = ours.get(path), theirs.get(path)
        if path not in ours or path not in theirs:
            place = "the document" if path not in ours else "the computation"
            differences.append(f"{_name_leaf(path)}: missing in {place}")
        elif isinstance(a, float) and isinstance(b, float):
            change = abs(a - b) / (scales[path[:-1]] if isinstance(path[-1], int) else abs(b) or 1.0) if a != b else 0.0
            if change > tolerance or math.isnan(change):
                differences.append(f"{_name_leaf(path)}: {format_exact(a)} stated, {format_exact(b)} computed")
            else:
                largest = max(largest, change)
        elif a != b:
            differences.append(f"{_name_leaf(path)}: '{a}' stated, '{b}' computed")
    return NumberComparison(len(theirs), largest, tuple(differences))


def _leaves(tree: NumberTree, path: LeafPath) -> Iterator[tuple[LeafPath, Leaf]]:
    if isinstance(tree, Mapping):
        for key, value in tree.items():
            yield from _leaves(value, (*path, key))
    elif isinstance(tree, Sequence) and not isinstance(tree, str):
        yield (*path, "number of values"), len(tree)
        for index, value in enumerate(tree):
            yield from _leaves(value, (*path, index))
    else:
        yield path, float(tree) if isinstance(tree, int) and not isinstance(tree, bool) else tree


def _scales(leaves: dict[LeafPath, Leaf]) -> dict[LeafPath, float]:
    """Largest absolute number of each list, 1 for a list of zeros."""
    scales: dict[LeafPath, float] = {}
    for path, value in leaves.items():
        if isinstance(value, float) and isinstance(path[-1], int):
            scales[path[:-1]] = max(scales.get(path[:-1], 0.0), abs(value))
    return {path: scale or 1.0 for path, scale in scales.items()}


def _name_leaf(path: LeafPath) -> str:
    return ", ".join(f"value {part + 1}" if isinstance(part, int) else part for part in path)


# First difference of two texts, as a sentence.
QUOTED_CHARACTERS = 80
"""Largest number of characters of a quoted text."""

CHARACTERS_BEFORE = 30
"""Number of characters quoted before the first difference of two long texts."""


ALIGNED_LINES = 100
"""Number of lines from the first difference within which equal lines are searched."""


def compare_lines(stated: Sequence[str], expected: Sequence[str]) -> Iterator[str]:
    """First line of a text that differs from the expected text, is missing, or is additional."""
    pairs = enumerate(zip_longest(stated, expected))
    first = next((number for number, (line, other) in pairs if line != other), None)
    if first is not None:
        lines, others = (list(text[first : first + ALIGNED_LINES]) for text in (stated, expected))
        _, i, i_end, j, j_end = SequenceMatcher(None, lines, others, autojunk=False).get_opcodes()[0]
        printed, follows = quote_difference(lines[i] if i < i_end else None, others[j] if j < j_end else None)
        yield f"{printed} is printed, {follows} follows from the results"


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
