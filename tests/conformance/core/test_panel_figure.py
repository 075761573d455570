"""Figures of panels: scales and letters as those of matplotlib, curves within a line width, texts that stay texts."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from matplotlib.ft2font import FT2Font, LoadFlags
from matplotlib.ticker import MaxNLocator, ScalarFormatter

from pantocheck.conformance.core.font_file import find_fonts, measure_text, read_advances, replace_missing_glyphs
from pantocheck.conformance.core.panel_figure import PanelFigure
from pantocheck.conformance.core.panel_marks import DASHES, MARKER_CORNERS, LineStyle, thin_path
from pantocheck.conformance.core.panel_scale import AxisScale, label_ticks, list_round_numbers

INK = LineStyle("#000000")


@given(st.integers(-(10**6), 10**6), st.integers(1, 10**6), st.integers(1, 9))
def test_ticks_are_those_of_matplotlib(begin: int, hundredths: int, intervals: int) -> None:
    """Both choose multiples of 1, 2, 2.5 and 5; matplotlib adds one tick outside at each end."""
    low, width = begin / 100, 1.00031 * hundredths / 100  # a step that is round itself may round either way
    assume(abs(low) < 50 * width)  # beyond, matplotlib takes an offset off
    high = low + width
    found = list_round_numbers(low, high, intervals)
    locator = MaxNLocator(nbins=intervals, steps=[1, 2, 2.5, 5, 10])
    space = 1e-8 * width
    expected = [tick for tick in locator.tick_values(low, high) if low - space <= tick <= high + space]
    assert found == pytest.approx(expected, abs=1e-7 * width + 1e-9 * abs(low))


@pytest.mark.parametrize("ticks", [[0.0, 2.5, 5.0], [-20.0, 0.0, 20.0], [0.0, 0.25, 0.5], [100.0, 200.0], [1e-3, 2e-3]])
def test_labels_are_those_of_matplotlib(ticks: list[float]) -> None:
    formatter = ScalarFormatter(useOffset=False)
    formatter.create_dummy_axis()
    formatter.set_scientific(False)
    formatter.set_locs(ticks)
    assert label_ticks(ticks) == [formatter(tick) for tick in ticks]


def test_scale_holds_its_data_and_its_stated_ticks() -> None:
    scale = AxisScale(margin=0.05)
    scale.include([10.0, 30.0, float("nan")])
    assert scale.find_ends() == (9.0, 31.0)
    scale.limits, scale.ticks = (0, None), [0, 40]
    assert scale.find_ends() == (0, 40)
    flat = AxisScale()
    flat.include([3.0])
    assert flat.find_ends()[0] < 3.0 < flat.find_ends()[1]


def test_glyphs_and_widths_are_those_of_the_font() -> None:
    font = FT2Font(str(find_fonts() / "DejaVuSans.ttf"))
    font.set_size(2048, 72)
    advances, characters = read_advances(), font.get_charmap()
    assert set(advances) == set(characters)
    for code in list(characters)[::50]:
        width = font.load_char(code, flags=LoadFlags.NO_SCALE).linearHoriAdvance / 65536 / 2048
        assert advances[code] == pytest.approx(width, abs=1e-9), chr(code)
    assert measure_text("ii", 10.0) == pytest.approx(20 * advances[ord("i")])
    assert replace_missing_glyphs("σ – \U0001f985") == "σ – \N{REPLACEMENT CHARACTER}"


def test_thinned_curve_lies_within_a_tenth_of_a_point() -> None:
    """Three passes of 0.02 pt; the thinnest line of a figure is 0.5 pt wide."""
    x = np.linspace(0, 450, 4000)
    y = 60 + 40 * np.sin(x / 5) + np.where(x > 300, 3 * np.sin(7 * x), 0)
    shown = thin_path(np.column_stack((x, y)))
    assert len(shown) < 0.6 * x.size
    steps = np.diff(shown, axis=0)
    part = np.clip(np.searchsorted(shown[:, 0], x, side="right") - 1, 0, len(steps) - 1)
    offset = np.column_stack((x, y)) - shown[part]
    across = offset[:, 0] * steps[part, 1] - offset[:, 1] * steps[part, 0]
    assert (abs(across) / np.hypot(*steps[part].T)).max() < 0.1
    spike = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 50.0], [3.0, 0.0], [4.0, 0.0]])
    assert [2.0, 50.0] in thin_path(spike).tolist()
    back = np.array([[0.0, 0.0], [5.0, 0.0], [2.0, 0.0]])
    assert len(thin_path(back)) == 3


def test_points_lie_at_their_data_and_texts_stay_texts() -> None:
    figure = PanelFigure(2.0, 1.0)
    panel = figure.add_axes(0.5, 0.25, 1.0, 0.5)
    panel.x_scale.limits, panel.y_scale.limits = (0, 10), (0, 1)
    panel.plot([0, 5, 10], [0, 1, 0.5], INK, "a < b & c")
    for number, marker in enumerate([*MARKER_CORNERS, "o"]):
        panel.plot([number % 10], [0.5], LineStyle("#123456", linestyle="", marker=marker))
    panel.axhspan(0.2, 0.4, "#aaaaaa", label="band")
    panel.text(5, 1.05, "<script>\n&", frame=("data", "panel"))
    panel.name_axes("x", "y")
    panel.add_legend(2)
    root = ElementTree.fromstring(figure.write())
    x = {text.text: float(text.get("x", "")) for text in root.iter("{http://www.w3.org/2000/svg}text")}
    assert {"a < b & c", "band", "<script>", "&", "x", "y"} <= set(x)
    # Space between the columns, handle and gap of a legend, in font sizes.
    space = measure_text("a < b & c", 7.5) + (1.4 + 2.2 + 0.8) * 7.5
    assert x["band"] - x["a < b & c"] == pytest.approx(space, abs=0.01)
    # The panel is 72 pt wide and 36 pt high; its left upper corner is at (36, 18).
    [curve] = [path for path in root.iter() if path.get("d") == "M36 54L72 18L108 36"]
    assert curve.get("stroke") == "#000000"
    areas = [path.get("d") for path in root.iter() if path.get("fill") == "#aaaaaa"]
    assert areas[0] == "M36 46.8L108 46.8L108 39.6L36 39.6z"
    assert len([path for path in root.iter() if path.get("fill") == "#123456"]) == len(MARKER_CORNERS) + 1
    assert 'y="12.78">band<' in figure.write()  # 2 % of the height and 0.6 of the size 7.5 pt above the panel
    assert not re.search(r"nan|inf", figure.write())


def test_markers_are_symmetric_and_every_dash_is_seen() -> None:
    for name in MARKER_CORNERS.keys() - set("<>"):
        shape = {(round(x, 9), round(y, 9)) for x, y in MARKER_CORNERS[name]}
        assert shape == {(-x, y) for x, y in shape}, name
    assert min(part for dashes in DASHES.values() for part in dashes) >= 1


def test_curve_breaks_where_a_value_is_missing() -> None:
    figure = PanelFigure(1.0, 1.0)
    panel = figure.add_axes(0.0, 0.0, 1.0, 1.0)
    panel.x_scale.limits, panel.y_scale.limits = (0, 72), (0, 72)
    panel.plot([0, 1, 2, 30, 40], [0, 9, float("nan"), 5, 72], INK)
    assert 'd="M0 72L1 63M30 67L40 0"' in figure.write()
