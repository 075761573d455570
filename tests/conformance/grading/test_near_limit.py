"""Near-limit rule: a value is marked only where an error exceeds its distance from the nearer limit."""

import pytest

from pantocheck.conformance.grading.near_limit import ValueErrors, near_limit_remarks

LIMITS = (20.0, 40.0)


@pytest.mark.parametrize(
    ("value", "limits", "errors", "names"),
    [
        (38.0, LIMITS, ValueErrors(discretisation=2.5), ["discretisation error of 2.5 N"]),
        (38.0, LIMITS, ValueErrors(discretisation=2.0), []),  # an error that just reaches the limit does not pass it
        (22.0, LIMITS, ValueErrors(spread=2.5), ["spread over analysis sections of 2.5 N"]),
        (42.0, LIMITS, ValueErrors(spread=2.5), ["spread over analysis sections of 2.5 N"]),  # a fail is marked, too
        (38.0, LIMITS, ValueErrors(uncertainty=1.5, limit_uncertainty=2.0), ["uncertainty of 2.5 N"]),
        (38.0, LIMITS, ValueErrors(uncertainty=1.5), []),
        (38.0, LIMITS, ValueErrors(limit_uncertainty=2.5), ["uncertainty of 2.5 N"]),
        (38.0, (None, 40.0), ValueErrors(discretisation=2.5), ["discretisation error of 2.5 N"]),
        (22.0, (None, 40.0), ValueErrors(discretisation=2.5), []),
        (22.0, (20.0, None), ValueErrors(discretisation=2.5), ["discretisation error of 2.5 N"]),
        (
            38.0,
            LIMITS,
            ValueErrors(3.0, 4.0, 5.0),
            ["discretisation error of 3 N", "spread over analysis sections of 4 N", "uncertainty of 5 N"],
        ),
        (20.0, (20.0, 20.0), ValueErrors(3.0, 4.0, 5.0), []),  # equal limits
        (30.0, (None, None), ValueErrors(3.0, 4.0, 5.0), []),
        (None, LIMITS, ValueErrors(3.0, 4.0, 5.0), []),
        (38.0, LIMITS, ValueErrors(), []),
    ],
)
def test_error_larger_than_the_distance_is_named(
    value: float | None, limits: tuple[float | None, float | None], errors: ValueErrors, names: list[str]
) -> None:
    """The value lies 2 N inside or outside a limit."""
    remarks = near_limit_remarks(value, limits, "N", errors)
    assert [remark.split(":")[0] for remark in remarks] == [f"lies 2 N from a limit, less than its {n}" for n in names]


def test_remark_without_a_unit_ends_without_a_space() -> None:
    (remark,) = near_limit_remarks(0.29, (None, 0.3), "", ValueErrors(uncertainty=0.02))
    assert (
        remark == "lies 0.01 from a limit, less than its uncertainty of 0.02: a longer record could reverse the verdict"
    )
