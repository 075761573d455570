"""Figures of a certificate."""

import math
from typing import Any

import matplotlib
import pytest

from pantocheck.conformance.core.figure_data import Traces, UpliftTrace
from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.pages.case_figures import draw_force, draw_uplift
from pantocheck.conformance.results.results_format import CaseResult


def test_uplift_figure_names_few_supports_and_no_two_curves_look_alike() -> None:
    """A legend of eleven names would halve the width of the figure."""
    supports = [UpliftTrace(support_m=55.0 * i, time_s=[0, 1, 2], uplift_mm=[0, 40 + i % 7, 0]) for i in range(11)]
    named = draw_uplift.__wrapped__(supports, []).axes[0].get_legend().get_texts()
    assert [text.get_text() for text in named] == ["other supports", "largest: support at 330 m"]
    # Colour and dashes of every named curve differ from those of all others.
    supports = [UpliftTrace(support_m=55.0 * i, time_s=[0, 1, 2], uplift_mm=[0, 40 + i, 0]) for i in range(8)]
    lines = draw_uplift.__wrapped__(supports, []).axes[0].lines
    assert len({(line.get_color(), line.get_linestyle()) for line in lines}) == len(lines) == 8


def test_force_figure_has_ticks_at_the_supports(passing: dict[str, Any]) -> None:
    trace = Traces.model_validate(passing["cases"][0]["traces"]["1"])
    axes = draw_force.__wrapped__(trace, []).axes[0]
    assert list(axes.get_xticks()) == trace.supports_m == [240, 300, 360]
    # The example has 0.98 x 24 N at the span-passing frequency; two spans hold two periods: no leakage.
    trace = passing["cases"][0]["traces"]["1"]["spectrum"]
    peak = max(zip(trace["amplitude_N"], trace["frequency_Hz"], strict=True))
    assert peak[1] == pytest.approx(250 / 3.6 / 60, rel=0.01)
    assert math.isclose(peak[0], 24 * 0.98, rel_tol=0.02)


@pytest.mark.parametrize("reference", [False, True])
def test_legend_of_a_head_with_two_strips_lies_inside_the_figure(passing: dict[str, Any], reference: bool) -> None:
    """Eight curves and levels need two rows above the axes."""
    trace = Traces.model_validate(passing["cases"][0]["traces"]["1"])
    half = [force / 2 for force in trace.force_N]
    trace = trace.model_copy(update={"strip_forces_N": [half, half]})
    with matplotlib.rc_context(fname=TEMPLATES / "figure.mplstyle"):
        figure = draw_force.__wrapped__(trace, trace.force_N if reference else [])
        figure.draw_without_rendering()
    legend = figure.axes[0].get_legend()
    assert {"front strip", "rear strip"} < {text.get_text() for text in legend.get_texts()}
    size, box = figure.bbox, legend.get_window_extent()
    assert box.y1 <= size.y1
    assert box.x1 <= size.x1


@pytest.mark.usefixtures("fresh_figures")
def test_figures_do_not_depend_on_the_settings_of_matplotlib(passing: dict[str, Any]) -> None:
    case = CaseResult.model_validate(passing["cases"][0])
    expected = draw_uplift(case.uplift, case.criteria)
    with matplotlib.rc_context({"font.family": "monospace", "axes.grid": False, "svg.fonttype": "path"}):
        assert draw_uplift(case.uplift, case.criteria) == expected
        assert matplotlib.rcParams["svg.fonttype"] == "path"
    assert ">time [s]</text>" in expected
    assert "dc:date" not in expected
