"""Texts of a criterion: one form on terminal, pages and in results, which never contradicts the verdict."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from pantocheck.conformance.core.verdicts import judge
from pantocheck.conformance.pages.words import format_beside_limits
from pantocheck.conformance.quantities.limit_text import (
    format_bounds,
    format_criterion_margin,
    format_graded,
    format_margin,
    format_rounded,
    name_value,
)

numbers = st.floats(-1e6, 1e6)


@pytest.mark.parametrize(
    ("lower", "upper", "text", "page"),
    [
        (26.0, 31.0, "26 to 31", "26 to 31"),
        (-5.0, 20.0, "-5 to 20", "−5 to 20"),
        (None, 225.0, "<= 225", "≤ 225"),
        (30.0, None, ">= 30", "≥ 30"),
        (0.0, 0.0, "= 0", "= 0"),
        (None, None, "none", "none"),
        (None, 1.0165, "<= 1.0165", "≤ 1.0165"),
    ],
)
def test_bounds_have_one_text(lower: float | None, upper: float | None, text: str, page: str) -> None:
    assert format_bounds(lower, upper) == text
    assert format_beside_limits(None, lower, upper) == ("–", page)


@pytest.mark.parametrize(
    ("value", "lower", "upper", "shown", "bounds"),
    [
        (28.1234, 22.0, 31.0, "28.12", "22 to 31"),
        (144.0, 142.57834821, 145.46565179, "144.0", "142.6 to 145.5"),
        (-5.5891, -14.17312345, 3.64412345, "-5.589", "-14.17 to 3.644"),
        (1.01651, 1.0165, 1.018, "1.017", "1.0165 to 1.018"),  # a stated limit keeps its digits
        (25.99996, 26.0, None, "25.99996", ">= 26"),  # four digits would show the limit itself
        (26.0, 26.0, 31.0, "26.00", "26 to 31"),
        (142.5783, 142.57834821, None, "142.57830", ">= 142.57835"),
        (142.5783, None, 142.57834821, "142.57830", "<= 142.57835"),
        (97.72345678, 92.79345678, 97.72345678, "97.72", "92.79 to 97.72"),
        (1.0, 0.99999991, 1.00000012, "1.0000000", "0.99999991 to 1.0000001"),
        (3e-9, 2.123456789e-9, None, "3.000e-09", ">= 2.123e-09"),
        (0.1 + 0.2, None, 0.3, "0.30000000000000004", "<= 0.3"),
        (None, 142.57834821, None, "-", ">= 142.6"),
        (0.0, 0.0, 0.0, "0", "= 0"),
    ],
)
def test_value_and_computed_limits_are_rounded_alike(
    value: float | None, lower: float | None, upper: float | None, shown: str, bounds: str
) -> None:
    """Four digits, and more where a rounded value would lie on a limit or beyond it."""
    assert format_graded(value, lower, upper) == (shown, bounds)


@given(numbers, numbers, st.floats(0, 1e6), st.floats(-1e-12, 1e-12))
@example(value=26.0, lower=26.0, width=1.0, shift=-1e-15)
def test_texts_have_the_verdict_of_the_numbers(value: float, lower: float, width: float, shift: float) -> None:
    """Also for a value that lies next to its limit."""
    for number in (value, lower * (1 + shift), (lower + width) * (1 + shift)):
        text, bounds = format_graded(number, lower, lower + width)
        low, _, high = bounds.removeprefix("= ").partition(" to ")
        assert judge(float(text), float(low), float(high or low)) == judge(number, lower, lower + width)


@pytest.mark.parametrize(
    ("margin", "shown"), [(0.0, "0.00"), (0.4812, "+0.48"), (-0.0004, "-0.0004"), (1e-20, "+1.0e-20")]
)
def test_margin_is_never_rounded_to_zero(margin: float, shown: str) -> None:
    assert format_margin(margin) == shown


def test_rounded_number_has_no_final_point_and_an_item_stands_in_brackets() -> None:
    assert (format_rounded(1234.5), format_rounded(119.71234, 2)) == ("1234", "1.2e+02")
    assert name_value("std_force_N", None) == "std_force_N"
    assert name_value("damping_ratio", 2) == "damping_ratio[2]"


@pytest.mark.parametrize(
    ("margin", "lower", "upper", "shown"),
    [
        (78.49, 0.0, None, "+78.49 N"),
        (-2.0, None, 0.0, "-2.00 N"),
        (-2.0, 0.0, 0.0, "-2.00 N"),
        (0.35, 0.0, 10.0, "+0.35"),
        (0.35, None, 10.0, "+0.35"),
        (None, None, None, "-"),
    ],
)
def test_margin_at_zero_has_a_unit(margin: float | None, lower: float | None, upper: float | None, shown: str) -> None:
    """A limit of zero alone gives no scale: the margin is the distance, as in `grading.verdicts.margin`."""
    assert format_criterion_margin(margin, lower, upper, "N") == shown
