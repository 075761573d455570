"""Verdict and normalised margin of a value between its limits."""

import math
from collections.abc import Iterable
from typing import Literal, get_args

Verdict = Literal["error", "fail", "undecided", "skip", "info", "unconfirmed", "pass"]

WORST_FIRST: tuple[Verdict, ...] = get_args(Verdict)


def judge(value: float, lower: float | None, upper: float | None) -> Verdict:
    """`pass` if a value lies within its limits, limits included; otherwise `fail`."""
    inside = (lower is None or value >= lower) and (upper is None or value <= upper)
    return "pass" if inside else "fail"


def margin(value: float, lower: float | None, upper: float | None) -> float:
    """Normalised distance of a value from its nearer limit: 0 on a limit, negative outside.

    With two limits, the distance is divided by half their difference, so that the middle has the margin 1. With one
    limit, it is divided by the absolute limit (by 1 if the limit is 0). With two equal limits, it is divided by the
    absolute limit, but at least by 1.

    Args:
        value: Graded value.
        lower, upper: Limits in the unit of the value; at least one must be given.

    Returns:
        Margin [-].
    """
    if lower is not None and lower == upper:
        return 0.0 if value == lower else -abs(value - lower) / max(abs(lower), 1.0)
    below = math.inf if lower is None else value - lower
    above = math.inf if upper is None else upper - value
    return normalise_distance(min(below, above), lower, upper)


def normalise_distance(distance: float, lower: float | None, upper: float | None) -> float:
    """Distance divided by half the difference of two limits, or by the absolute limit (by 1 if the limit is 0).

    Args:
        distance: Distance in the unit of the limits.
        lower, upper: Limits that are not equal; at least one must be given.

    Returns:
        Distance [-].
    """
    if lower is not None and upper is not None:
        return 2 * (distance / (upper - lower))
    limit = upper if lower is None else lower
    if limit is None:
        raise ValueError("a margin needs at least one limit")
    return distance / (abs(limit) or 1.0)


def worst_verdict(verdicts: Iterable[Verdict]) -> Verdict:
    """Worst of several verdicts, in the order of `WORST_FIRST`; `info` if there are none."""
    return min(verdicts, key=WORST_FIRST.index, default="info")


def judge_parts(verdicts: Iterable[Verdict]) -> Verdict:
    """Worst of the verdicts that count; `info`, which marks a criterion that does not count, if none does."""
    return worst_verdict(verdict for verdict in verdicts if verdict != "info")
