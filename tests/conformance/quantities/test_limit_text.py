"""Texts that name a criterion: one form on terminal, pages and in results."""

import pytest

from pantocheck.conformance.quantities.limit_text import format_bounds, name_value
from pantocheck.conformance.reports.page_text import format_limits


@pytest.mark.parametrize(
    ("lower", "upper", "text", "page"),
    [
        (26.0, 31.0, "26 to 31", "26 to 31"),
        (-5.0, 20.0, "-5 to 20", "−5 to 20"),
        (None, 225.0, "<= 225", "≤ 225"),
        (30.0, None, ">= 30", "≥ 30"),
        (0.0, 0.0, "= 0", "= 0"),
        (None, None, "none", "none"),
        (None, 0.123456789, "<= 0.123456789", "≤ 0.123456789"),
    ],
)
def test_bounds_have_one_text_with_ascii_or_typographic_signs(
    lower: float | None, upper: float | None, text: str, page: str
) -> None:
    assert format_bounds(lower, upper) == text
    assert format_limits(lower, upper) == page


def test_bounds_in_a_narrow_column_are_rounded() -> None:
    assert format_bounds(117.60123, 120.0, 4) == "117.6 to 120"


def test_item_of_a_quantity_stands_in_brackets() -> None:
    assert name_value("std_force_N", None) == "std_force_N"
    assert name_value("damping_ratio", 2) == "damping_ratio[2]"
