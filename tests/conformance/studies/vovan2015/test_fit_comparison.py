"""Chart of the observability: the thresholds are those of the fit, and the caption explains them."""

import re
from types import SimpleNamespace

import pytest

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.drops import paired_shapes
from pantocheck.conformance.pages.damping_page import describe_observability, draw_observability
from pantocheck.conformance.results.damping_format import DampingResults, Observability
from pantocheck.conformance.studies.vovan2015 import mass_drop_study

OBSERVED = tuple(
    Observability(
        kind=kind,
        matrix="mass",
        largest_share=share,
        variance_inflation=1.0,
        std=0.1,
        plausible=0.1,
        plausible_over_std=ratio,
        residual_without=1.0,
        observable=observable,
    )
    for kind, share, ratio, observable in (
        ("contact_wire", 0.8, 40.0, True),
        ("dropper", 0.01, 10.0, False),  # well determined, but at most 1 % of the damping of a mode
        ("steady_arm", 0.0, 0.0, False),
    )
)
RESULTS = DampingResults.model_construct(coefficients=(), observability=OBSERVED, thresholds=paired_shapes.THRESHOLDS)


@pytest.fixture
def chart(monkeypatch: pytest.MonkeyPatch) -> Chart:
    monkeypatch.setattr(mass_drop_study, "build_damping_results", lambda *_: RESULTS)
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    (chart,) = mass_drop_study.build_fit_report(case, SimpleNamespace(modes=())).charts
    return chart


def test_observable_coefficients_are_counted_for_the_wires_and_for_the_rest() -> None:
    rows = [row.model_copy(update={"observable": True}) for row in OBSERVED]
    kinds = ("contact_wire", "messenger_wire", "dropper")
    counted = [row.model_copy(update={"kind": kind}) for row, kind in zip(rows, kinds, strict=True)]
    assert mass_drop_study.count_observable(counted) == {
        "observable_wire_coefficients": 2.0,
        "observable_other_coefficients": 1.0,
    }
    assert set(mass_drop_study.count_observable([]).values()) == {0.0}


def test_well_determined_coefficient_with_a_small_share_is_not_observable(chart: Chart) -> None:
    assert "above the dashed line it is observable" not in chart.caption
    assert f"{100 * paired_shapes.THRESHOLDS.largest_share:g} %" in chart.caption
    assert chart.marks[0].label == "needed"
    described = re.findall(r"(\w+) mass: [\d.e+-]+, (observable|not observable)", chart.alternative)
    assert dict(described) == {
        "contact_wire": "observable",
        "dropper": "not observable",
        "steady_arm": "not observable",
    }


def test_drawn_thresholds_are_those_of_the_fit(chart: Chart) -> None:
    assert chart.marks[0].low == paired_shapes.THRESHOLDS.plausible_over_std
    rows, thresholds = OBSERVED, paired_shapes.THRESHOLDS
    left, right = draw_observability.__wrapped__(rows, thresholds).axes
    assert set(left.lines[0].get_xdata()) == {100 * thresholds.largest_share}
    assert set(right.lines[0].get_xdata()) == {thresholds.plausible_over_std}
    description = describe_observability(thresholds)
    assert f"at least {100 * thresholds.largest_share:g} % of the damping of some mode" in description
    assert f"at least {thresholds.plausible_over_std:g} times its standard deviation" in description


def test_caption_names_the_smallest_drawn_ratio(chart: Chart) -> None:
    (bars,) = chart.series
    assert bars.y == [40.0, 10.0, mass_drop_study.SMALLEST_DRAWN_RATIO]
    assert (
        f"Values below {mass_drop_study.SMALLEST_DRAWN_RATIO:g} are drawn at {mass_drop_study.SMALLEST_DRAWN_RATIO:g}"
        in chart.caption
    )
