"""Charts and tables of studies."""

import inspect
from collections.abc import Callable
from typing import Any

import matplotlib
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

from helpers.shown_page import certify
from pantocheck.conformance.core.figure_data import Chart, Mark, Series, TextTable
from pantocheck.conformance.pages.case_figures import draw_case_figures
from pantocheck.conformance.pages.document import Section
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.study_chart import draw_chart, find_common_range
from pantocheck.conformance.results.results_format import CaseResult

LINE = Series(label="computed", style="line", x=[1e-6, 1e-3, 1.0], y=[3.0, 2.0, 1.0])


POINTS = LINE.model_copy(update={"style": "points"})


def data(**parts: Any) -> Chart:
    default = {"caption": "c", "alternative": "a", "x_label": "x [s]", "y_label": "y [N]", "series": [LINE]}
    return Chart.model_validate(default | parts)


def draw(**parts: Any) -> str:
    return draw_chart(data(**parts))


def axes_of(**parts: Any) -> Axes:
    """The axes of the chart before they are rendered."""
    painter: Callable[..., Figure] = inspect.unwrap(draw_chart)
    return painter(data(**parts)).axes[0]


@pytest.mark.usefixtures("fresh_figures")
def test_chart_is_deterministic_whatever_the_settings_of_matplotlib() -> None:
    expected = draw()
    assert draw() == expected
    with matplotlib.rc_context({"font.family": "monospace", "axes.grid": False, "svg.fonttype": "path"}):
        assert draw() == expected
        assert matplotlib.rcParams["svg.fonttype"] == "path"
    assert ">x [s]</text>" in expected


@pytest.mark.parametrize(
    "change",
    [
        {"marks": [Mark(label="printed", axis="y", low=2.5)]},
        {"marks": [Mark(label="printed", axis="x", low=1e-4, high=1e-2)]},
        {"x_scale": "log"},
        {"series": [POINTS]},
        {"series": [LINE.model_copy(update={"error": [0.1, 0.2, 0.1]})]},
        {"series": [LINE.model_copy(update={"style": "boxes", "x": [1.0, 1.0, 2.0]})]},
        {"series": [LINE.model_copy(update={"style": "bars", "x": [0.0, 1, 2]})], "ticks": ["0-5", "5-20", "20-50"]},
        {"wide": False},
    ],
)
def test_chart_draws_every_element(change: dict[str, Any]) -> None:
    assert draw(**change) != draw()


def test_axes_and_error_bars_have_their_range() -> None:
    """An axis that starts at zero would hide half of a velocity; positive values start there."""
    assert axes_of().get_ylim()[0] == 0
    assert axes_of(series=[LINE.model_copy(update={"y": [-3.0, 2.0, 1.0]})]).get_ylim()[0] < -3
    # From 0, or 5 % of the range below the lowest value, to 5 % above the highest value of both charts.
    lower = LINE.model_copy(update={"y": [-1.0, 1.0, 1.0]})
    assert_allclose(find_common_range([data(), data()]), (0.0, 3.15), rtol=1e-12)
    assert_allclose(find_common_range([data(), data(series=[lower])]), (-1.2, 3.2), rtol=1e-12)
    (container,) = axes_of(series=[POINTS.model_copy(update={"error": [0.1, 0.2, 0.3]})]).containers
    (bars,) = container.lines[2]
    lengths = [upper - lower for (_, lower), (_, upper) in bars.get_segments()]
    assert_allclose(lengths, [0.2, 0.4, 0.6], rtol=1e-12)
    assert draw(series=[POINTS.model_copy(update={"error": [0.1, 0.2, 0.3]})]) != draw(series=[POINTS])


def test_charts_side_by_side_have_one_scale(results: dict[str, Any]) -> None:
    """Two narrow charts of one quantity; a chart of another quantity and a wide chart keep their own scale."""
    narrow, other = data(wide=False), data(wide=False, y_label="z [mm]")
    higher = data(wide=False, series=[LINE.model_copy(update={"y": [9.0, 2.0, 1.0]})])
    case = results["cases"][0] | {"charts": [narrow, higher, other, data()], "traces": {}, "uplift": []}
    figures = list(draw_case_figures(CaseResult.model_validate(case), 0, "case-1"))
    assert [figure.wide for figure in figures] == [False, False, False, True]
    common = (0.0, 1.05 * 9.0)
    expected = [draw_chart(narrow, common), draw_chart(higher, common), draw_chart(other), draw_chart(data())]
    assert [figure.svg for figure in figures] == expected
    painter: Callable[..., Figure] = inspect.unwrap(draw_chart)
    assert_allclose(painter(narrow, common).axes[0].get_ylim(), common)
    widths = [painter(data(wide=wide)).get_figwidth() for wide in (True, False)]
    assert widths[0] > 2 * widths[1]


def test_certificate_shows_tables_and_charts_of_a_study_escaped(results: dict[str, Any]) -> None:
    case = results["cases"][0]
    case["charts"] = [Chart(caption="Figure of a study", alternative="what it shows", x_label="x", y_label="y",
                            series=[LINE]).model_dump()]  # fmt: skip
    table = TextTable(caption="Findings", columns=["Finding", "Verdict"], rows=[["<b>less</b> in front", "reproduced"]])
    case["tables"] = [table.model_dump()]
    document = certify(results)
    text = render_html(document)
    assert "Figure of a study" in text
    assert "&lt;b&gt;less&lt;/b&gt; in front" in text
    [cases] = [block for block in document.blocks if isinstance(block, Section) and block.anchor == "case-1"]
    [section] = [block for block in cases.blocks if isinstance(block, Section) and block.heading == "Findings"]
    assert section.blocks[0].rows == (("<b>less</b> in front", "reproduced"),)
