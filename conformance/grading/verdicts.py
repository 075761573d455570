"""Verdicts: a value and its limits give a verdict and a normalised margin."""

from collections.abc import Iterable
from typing import Literal, get_args

Verdict = Literal["error", "fail", "skip", "pass", "info"]

WORST_FIRST: tuple[Verdict, ...] = get_args(Verdict)


def judge(value: float, lower: float | None, upper: float | None) -> Verdict:
    """`pass` if a value lies within its limits (the limits themselves included), else `fail`."""
    inside = (lower is None or value >= lower) and (upper is None or value <= upper)
    return "pass" if inside else "fail"


def margin(value: float, lower: float | None, upper: float | None) -> float:
    """Normalised distance of a value to its nearer limit: 0 on a limit, negative outside.

    With two limits the unit is half their distance, so that 1 is the middle. With one limit, or two equal ones, the
    unit is the limit itself (1 if the limit is 0, and at least 1 for two equal ones).

    Parameters
    ----------
    value : float
        The value graded.
    lower, upper : float or None
        Limits in the unit of the value; at least one of them.

    Returns
    -------
    float
        [-].
    """
    if lower is not None and upper is not None:
        if lower == upper:
            return 0.0 if value == lower else -abs(value - lower) / max(abs(lower), 1.0)
        return 2 * (min(value - lower, upper - value) / (upper - lower))
    if lower is not None:
        return (value - lower) / (abs(lower) or 1.0)
    if upper is not None:
        return (upper - value) / (abs(upper) or 1.0)
    raise ValueError("a margin needs at least one limit")


def worst_verdict(verdicts: Iterable[Verdict]) -> Verdict:
    """The verdict of a whole from those of its parts: error > fail > skip > pass > info; of nothing, `info`."""
    return min(verdicts, key=WORST_FIRST.index, default="info")
