"""Grade of a value between limits: verdict, reason, margin, and remark near a limit."""

from typing import NamedTuple

from pantocheck.conformance.grading.near_limit import NO_ERRORS, ValueErrors, near_limit_remarks
from pantocheck.conformance.grading.verdicts import Verdict, judge, margin


class ValueGrade(NamedTuple):
    """Verdict on a value, with its reason, its normalised margin and its remarks near a limit."""

    verdict: Verdict
    reason: str | None
    margin: float | None
    close: tuple[str, ...]


def grade_value(
    value: float | None,
    limits: tuple[float | None, float | None],
    unit: str,
    errors: ValueErrors = NO_ERRORS,
    missing: str | None = None,
    place: str = "",
) -> ValueGrade:
    """Grade a value; it is skipped if data are missing, and a distance beyond a limit is stated all the same.

    Args:
        value: Graded value; None if there is none.
        limits: Lower and upper limit; at least one is given.
        unit: Unit of the value; empty for a ratio.
        errors: Errors of the value.
        missing: Data that the value needs and the record does not have; None if it is complete.
        place: Place of the value in words, behind the distance beyond a limit.

    Returns:
        The grade.
    """
    if value is None:
        return ValueGrade("skip", missing, None, ())
    verdict = judge(value, *limits)
    reasons = [] if missing is None else [missing]
    if verdict == "fail":
        distance = min(abs(value - limit) for limit in limits if limit is not None)
        reasons.append(" ".join(filter(None, (f"{distance:.3g}", unit, "beyond the limit"))) + place)
    close = tuple(near_limit_remarks(value, limits, unit, errors))
    return ValueGrade(verdict if missing is None else "skip", "; ".join(reasons) or None, margin(value, *limits), close)
