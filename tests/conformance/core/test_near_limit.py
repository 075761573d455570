"""Near-limit rule: a value is marked only where its combined uncertainty exceeds its distance from the nearer limit."""

import pytest

from pantocheck.conformance.core.near_limit import ValueErrors, near_limit_remarks

LIMITS = (20.0, 40.0)


def errors(limit_uncertainty: float = 0.0, **components: float) -> ValueErrors:
    return ValueErrors(components=components, limit_uncertainty=limit_uncertainty)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("value", "limits", "found", "names"),
    [
        (38.0, LIMITS, errors(discretisation=2.5), ["2.5 N (mostly discretisation)"]),
        (38.0, LIMITS, errors(discretisation=2.0), []),  # an interval that just reaches the limit does not pass it
        (22.0, LIMITS, errors(start=2.5), ["2.5 N (mostly start)"]),
        (42.0, LIMITS, errors(start=2.5), ["2.5 N (mostly start)"]),  # a fail is marked, too
        (38.0, LIMITS, errors(start=1.5, length=2.0), ["2.5 N (mostly length)"]),  # 3-4-5: neither would do alone
        (38.0, LIMITS, errors(start=1.5, section=1.0), []),  # 1.8 N
        (38.0, LIMITS, errors(limit_uncertainty=2.0, length=1.5), ["2.5 N (mostly limit)"]),
        (38.0, LIMITS, errors(limit_uncertainty=2.5), ["2.5 N (mostly limit)"]),
        (38.0, (None, 40.0), errors(section=2.5), ["2.5 N (mostly section)"]),
        (22.0, (None, 40.0), errors(section=2.5), []),
        (22.0, (20.0, None), errors(section=2.5), ["2.5 N (mostly section)"]),
        (30.0, (None, None), errors(start=5.0), []),
        (None, LIMITS, errors(start=5.0), []),
        (38.0, LIMITS, ValueErrors(discretisation=9.0, spread=9.0), []),  # neither is a component
    ],
)
def test_uncertainty_larger_than_the_distance_is_named(
    value: float | None, limits: tuple[float | None, float | None], found: ValueErrors, names: list[str]
) -> None:
    """The value lies 2 N inside or outside a limit."""
    remarks = near_limit_remarks(value, limits, "N", found)
    assert [remark.split(":")[0] for remark in remarks] == [
        f"lies 2 N from a limit, less than its uncertainty of {name}" for name in names
    ]


def test_value_on_a_single_permitted_value_is_close_with_any_uncertainty() -> None:
    """Contact loss of 0 % that another start raises: the pass could be reversed; without an uncertainty it is none."""
    (remark,) = near_limit_remarks(0.0, (0.0, 0.0), "%", errors(start=0.3))
    assert remark.startswith("lies 0 % from a limit, less than its uncertainty of 0.3 % (mostly start)")
    assert near_limit_remarks(0.0, (0.0, 0.0), "%", errors(start=0.0)) == []


def test_further_component_never_removes_a_remark_and_none_is_no_zero() -> None:
    """The combination grows with every component: to leave one out never makes a value less close."""
    assert near_limit_remarks(38.0, LIMITS, "N", errors(start=2.5))
    assert near_limit_remarks(38.0, LIMITS, "N", errors(start=2.5, length=0.0, section=1e-9, discretisation=30.0))
    # None is not zero.
    assert errors().find_half_width(38.0) is None
    assert errors(start=0.0).find_half_width(38.0) == 0.0
    assert errors(start=3.0, section=4.0, limit_uncertainty=9.0).find_half_width(38.0) == pytest.approx(5.0, rel=1e-12)
    (remark,) = near_limit_remarks(0.29, (None, 0.3), "", errors(length=0.02))
    assert remark == (
        "lies 0.01 from a limit, less than its uncertainty of 0.02 (mostly length): "
        "a longer record could reverse the verdict"
    )
