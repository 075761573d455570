"""Figure of the bands: heights of the bars, limits of the verification or of a source, and missing values."""

import re
from typing import Any

import pytest

from helpers.example_results import example, with_reference
from pantocheck.conformance.pages.band_figure import FOOT, TOP, draw_bands
from pantocheck.conformance.results.results_format import CaseResult, Results

SOLID = re.compile(r'<rect x="[\d.]+" y="([\d.]+)" width="24" height="([\d.]+)" fill="#')


def build_case(**changes: Any) -> CaseResult:
    case = Results.model_validate(with_reference()).cases[0]
    values = {"rms_0_5_N": 10.0, "rms_5_20_N": 20.0, "rms_20_50_N": 5.0} | changes
    quantities = {"1": case.quantities["1"] | values}
    return case.model_copy(update={"quantities": quantities, "uncertainty": {}, "traces": {"1": case.traces["1"]}})


def test_heights_of_the_bars_are_in_the_ratio_of_the_values() -> None:
    """Without limits, the highest of 10, 20 and 5 N fills the figure; coordinates have two decimals."""
    [figure] = draw_bands(build_case().model_copy(update={"verification": None, "criteria": []}))
    heights = [float(height) for _, height in SOLID.findall(figure.svg)]
    assert heights == pytest.approx([(FOOT - TOP) * value / 20 for value in (10, 20, 5)], abs=0.01)
    assert "Pantograph 1: 0 to 5 Hz: 10.00 N; 5 to 20 Hz: 20.00 N; 20 to 50 Hz: 5.000 N." in figure.alternative
    assert "Grey" not in figure.caption


def test_limits_of_the_verification_lie_behind_the_bars() -> None:
    case = build_case()
    row = Results.model_validate(example()).cases[0].criteria[0]
    limits = row.model_copy(
        update={"quantity": "rms_20_50_N", "pantograph": 1, "lower": 20.0, "upper": 40.0, "baseline": None}
    )
    [figure] = draw_bands(case.model_copy(update={"verification": None, "criteria": [limits]}))
    assert figure.caption.endswith("Grey: limits.")
    [(height, top)] = re.findall(r'<rect height="([\d.]+)" y="([\d.]+)"', figure.svg)
    assert float(top) == pytest.approx(TOP, abs=0.01)
    assert float(height) == pytest.approx((FOOT - TOP) / 2, abs=0.01)


def test_missing_values_have_no_bar() -> None:
    names = ("rms_0_5_N", "rms_5_20_N", "rms_20_50_N")
    [figure] = draw_bands(build_case(rms_20_50_N=None).model_copy(update={"verification": None, "criteria": []}))
    assert len(SOLID.findall(figure.svg)) == 2
    assert not list(draw_bands(build_case(**dict.fromkeys(names))))
