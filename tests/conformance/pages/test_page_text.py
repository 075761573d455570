"""Texts and numbers of the pages."""

from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pantocheck.conformance.pages import words as text


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


def test_value_and_limits_have_typographic_signs() -> None:
    assert text.format_beside_limits(-5.5891, -14.17312345, 3.644) == ("−5.589", "−14.17 to 3.644")
