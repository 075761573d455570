"""Texts and numbers of the pages."""

from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pantocheck.conformance.reports import page_text as text
from pantocheck.conformance.reports.certificate.criteria_table import format_signed

numbers = st.floats(-1e6, 1e6)


@given(st.text(st.characters()))
def test_clean_text_fits_any_format(raw: str) -> None:
    shown = text.clean_text(raw)
    assert text.clean_text(shown) == shown
    shown.encode("utf-8")
    ElementTree.fromstring(f"<a>{shown.replace('&', '').replace('<', '')}</a>")
    assert len(shown) <= text.LONGEST


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (119.71234, "119.7"),
        (-0.000123456, "−0.0001235"),
        (0.0, "0"),
        (1234.5, "1234"),
        (8e-9, "8.000e−09"),
        (None, "–"),
    ],
)
def test_format_value(value: float | None, shown: str) -> None:
    assert text.format_value(value) == shown


@given(numbers, numbers)
def test_format_beside_limits_keeps_the_side_of_the_limit(value: float, limit: float) -> None:
    shown = float(text.format_beside_limits(value, limit, None).replace("−", "-"))
    assert (shown >= limit) == (value >= limit)


@pytest.mark.parametrize(
    ("margin", "shown"), [(0.0, "0.00"), (0.4812, "+0.48"), (-0.0004, "−0.0004"), (1e-20, "+1.0e−20")]
)
def test_format_signed(margin: float, shown: str) -> None:
    assert format_signed(margin) == shown
