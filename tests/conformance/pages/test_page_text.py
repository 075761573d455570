"""Texts and numbers of the pages."""

from xml.etree import ElementTree

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


def test_values_have_four_digits_and_typographic_signs() -> None:
    values = (119.71234, -0.000123456, 0.0, 1234.5, 8e-9, None)
    assert [text.format_value(value) for value in values] == ["119.7", "−0.0001235", "0", "1234", "8.000e−09", "–"]
    assert text.format_beside_limits(-5.5891, -14.17312345, 3.644) == ("−5.589", "−14.17 to 3.644")
