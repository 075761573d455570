"""Figures of a certificate."""

import math
from typing import Any
from xml.etree import ElementTree

import pytest

from pantocheck.conformance.core.figure_data import Traces, UpliftTrace
from pantocheck.conformance.core.font_file import measure_text
from pantocheck.conformance.core.panel_figure import TICK_SIZE
from pantocheck.conformance.pages.case_figures import draw_force, draw_uplift


def test_uplift_figure_names_few_supports_and_no_two_curves_look_alike() -> None:
    """A legend of eleven names would halve the width of the figure."""
    supports = [UpliftTrace(support_m=55.0 * i, time_s=[0, 1, 2], uplift_mm=[0, 40 + i % 7, 0]) for i in range(11)]
    assert [label for label, _ in draw_uplift.__wrapped__(supports, []).axes[0].legend] == [
        "other supports",
        "largest: support at 330 m",
    ]
    # Colour and dashes of every named curve differ from those of all others.
    supports = [UpliftTrace(support_m=55.0 * i, time_s=[0, 1, 2], uplift_mm=[0, 40 + i, 0]) for i in range(8)]
    curves = draw_uplift.__wrapped__(supports, []).axes[0].curves
    assert len({(curve.style.color, curve.style.linestyle) for curve in curves}) == len(curves) == 8


def test_force_figure_has_ticks_at_the_supports(passing: dict[str, Any]) -> None:
    trace = Traces.model_validate(passing["cases"][0]["traces"]["1"])
    axes = draw_force.__wrapped__(trace, []).axes[0]
    assert axes.x_scale.list_ticks() == (trace.supports_m, ["240", "300", "360"])
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
    figure = draw_force.__wrapped__(trace, trace.force_N if reference else [])
    panel = figure.axes[0]
    assert {"front strip", "rear strip"} < {label for label, _ in panel.legend}
    texts = list(ElementTree.fromstring(figure.write()).iter("{http://www.w3.org/2000/svg}text"))
    for label, _ in panel.legend:
        [text] = [text for text in texts if text.text == label]
        assert float(text.attrib["y"]) - TICK_SIZE > 0
        assert float(text.attrib["x"]) + measure_text(label, TICK_SIZE) < 72 * figure.width
