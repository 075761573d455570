"""Margin bar of a criterion."""

import re
from xml.etree import ElementTree

from hypothesis import given
from hypothesis import strategies as st

from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.pages.margin_bar import HEIGHT, WIDTH, draw_margin_bar

numbers = st.floats(-1e6, 1e6)


@given(numbers, st.none() | numbers, st.none() | numbers, st.none() | st.floats(0, 1e3))
def test_margin_bar_stays_inside_its_drawing(
    value: float, lower: float | None, upper: float | None, error: float | None
) -> None:
    if lower is not None and upper is not None and lower > upper:
        lower, upper = upper, lower
    root = ElementTree.fromstring(draw_margin_bar(value, lower, upper, error, "pass"))
    for circle in root.iter("{http://www.w3.org/2000/svg}circle"):
        assert 0 <= float(circle.get("cx", "nan")) <= WIDTH
    assert "nan" not in ElementTree.tostring(root).decode()


def test_margin_bar_marks_differ_in_shape() -> None:
    inside, outside, uncounted, beyond = (
        draw_margin_bar(value, 26, 31, None, verdict)
        for value, verdict in ((28, "pass"), (32, "fail"), (28, "info"), (99, "fail"))
    )
    assert 'r="4.5" fill="#0b6157"' in inside
    assert "<circle" not in outside
    assert 'r="4.5" fill="#ffffff"' in uncounted
    assert "l-9 -6v12z" in beyond


def test_bar_on_paper_keeps_the_ratio_of_its_sides() -> None:
    """With another ratio, Typst crops the strip below the bar; the sizes have three digits."""
    source = (TEMPLATES / "elements.typ").read_text("utf-8")
    [(width, height)] = re.findall(r'svg\), format: "svg", width: ([0-9.]+)em, height: ([0-9.]+)em', source)
    assert abs(float(height) / float(width) - HEIGHT / WIDTH) < 1e-3
