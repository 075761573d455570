"""Texts of a criterion: the number that a limit applies to, its value, its bounds and its margin."""

import re
from itertools import combinations
from typing import NamedTuple

ROUNDED_DIGITS = 4
"""Significant digits of a computed number."""

STATED_DIGITS = 5
"""Largest number of significant digits of a limit that is taken as stated, so that it is not rounded."""

EXACT_DIGITS = 17
"""Significant digits that distinguish any two numbers."""

_TRUST_RAISED = re.compile(r"[^:]+: the trust of the limit is raised from [a-z]+ to [a-z]+")


class GradedText(NamedTuple):
    """Texts of a value, `-` for none, and of its limits, in ASCII characters."""

    value: str
    bounds: str


def name_value(quantity: str, item: int | None) -> str:
    """Name of a value: the quantity, with the number of the item if it has several values.

    Args:
        quantity: Name of the quantity.
        item: Number of the item, from 1.

    Returns:
        Name such as `std_force_N` or `damping_ratio[2]`.
    """
    return f"{quantity}[{item}]" if item else quantity


def format_rounded(value: float, digits: int = ROUNDED_DIGITS) -> str:
    """A computed number with significant digits, as `119.7` or `-2.400e-09`."""
    if value == 0:
        return "0"
    text = f"{value:#.{digits}g}"
    return (f"{value:.{digits - 1}e}" if "e" in text else text).rstrip(".")


def format_input_number(value: float) -> str:
    """An input number in its shortest form: `20`, `0.001`."""
    return f"{value:.12g}"


def format_margin(margin: float) -> str:
    """A margin with its sign and two decimals, three or more where two would show no distance to the limit."""
    if margin == 0:
        return "0.00"
    texts = (f"{margin:+.{decimals}f}" for decimals in range(2, 13))
    return next((text for text in texts if float(text) != 0), f"{margin:+.1e}")


def is_relative_margin(lower: float | None, upper: float | None) -> bool:
    """Whether a margin is relative: a limit of 0 alone gives no scale, so that the margin has the unit of the value."""
    return bool(lower) or bool(upper)


def format_criterion_margin(margin: float | None, lower: float | None, upper: float | None, unit: str) -> str:
    """A margin as a number, or with the unit of the value beside a limit of 0 alone, in ASCII characters.

    Args:
        margin: Margin of the criterion; None if there is none.
        lower, upper: Limits in the unit of the value.
        unit: Unit of the value.

    Returns:
        `+0.48`, `+78.49 N`, or `-` without a margin, also on a limit of a single value.
    """
    if margin is None or (margin == 0 and lower == upper):
        return "-"
    return format_margin(margin) if is_relative_margin(lower, upper) else f"{format_margin(margin)} {unit}".rstrip()


def format_bounds(lower: float | None, upper: float | None) -> str:
    """Stated bounds of a limit in ASCII characters.

    Args:
        lower, upper: Bounds in the unit of the quantity; None if there is no such bound.

    Returns:
        `26 to 31`, `<= 225`, `>= 30`, `= 0` or `none`.
    """
    return _join_bounds(*(None if bound is None else format_input_number(bound) for bound in (lower, upper)))


def format_graded(value: float | None, lower: float | None, upper: float | None) -> GradedText:
    """A value and its limits, rounded so that their texts never contradict the verdict.

    Stated limits keep their digits. The value and computed limits have `ROUNDED_DIGITS` significant digits, and more
    where these would change the order of the three numbers: a value outside a limit is never shown on it or inside it.

    Args:
        value: Graded value.
        lower, upper: Limits in the unit of the value.
    """
    for digits in range(ROUNDED_DIGITS, EXACT_DIGITS + 1):
        low, high = (None if bound is None else _format_bound(bound, digits) for bound in (lower, upper))
        shown = None if value is None else format_rounded(value, digits)
        if _keeps_order((lower, value, upper), (low, shown, high)):
            break
    return GradedText(shown or "-", _join_bounds(low, high))


def _format_bound(bound: float, digits: int) -> str:
    """A stated bound in its shortest form, a computed one rounded."""
    return format_input_number(bound) if float(f"{bound:.{STATED_DIGITS}g}") == bound else format_rounded(bound, digits)


def _keeps_order(numbers: tuple[float | None, ...], texts: tuple[str | None, ...]) -> bool:
    """Whether every two texts are in the order of their numbers."""
    pairs = [(number, float(text)) for number, text in zip(numbers, texts, strict=True) if number is not None and text]
    return all(((a > b) - (a < b)) == ((x > y) - (x < y)) for (a, x), (b, y) in combinations(pairs, 2))


def _join_bounds(low: str | None, high: str | None) -> str:
    if low is None:
        return "none" if high is None else f"<= {high}"
    if high is None:
        return f">= {low}"
    return f"= {low}" if low == high else f"{low} to {high}"


def raises_trust_only(change: str) -> bool:
    """Whether a sentence on a changed limit states a higher trust of the limit and nothing else.

    Args:
        change: The sentence; a name with a colon is not recognised, so that its change is never played down.
    """
    return _TRUST_RAISED.fullmatch(change) is not None
