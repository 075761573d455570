"""Report of the mass drops: identified damping ratios, and those of each damping model or of the case."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.lines import simple_line
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.drops.damping_model import THRESHOLDS
from pantocheck.conformance.drops.population import Population
from pantocheck.conformance.line.elements.damping import ModalDamping
from pantocheck.conformance.pages.damping_page import describe_observability, draw_observability
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.damping_format import DampingResults, Observability
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.runs.system import StudyResult
from pantocheck.conformance.studies.vovan2015 import mass_drop_study
from pantocheck.model import Kind, Rayleigh

RATIOS = {"initial": 0.03, "updated": 0.02, "updated-modal": 0.0125}


@pytest.fixture
def case() -> Case:
    """Three spans, modes below 3 Hz, coarse elements; all modes of a damping model have the same damping ratio."""
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    steps = case.file.discretisation.model_copy(update={"element_m": 4.5})
    mass_drop = case.file.mass_drop.model_copy(update={"highest_Hz": 3.0})
    line = case.line.model_copy(update={"geometry": case.line.geometry.shorten(3)})
    dampings = {
        name: case.dampings[name].model_copy(
            update={"modal": (ModalDamping(from_Hz=0.0, to_Hz=10.0, damping_ratio=ratio),)}
        )
        for name, ratio in RATIOS.items()
    }
    file = case.file.model_copy(update={"discretisation": steps, "mass_drop": mass_drop})
    return replace(case, file=file, line=line, dampings=dampings)


def draw_frequencies(case: Case, monkeypatch: pytest.MonkeyPatch) -> Chart:
    """First chart of the study with drops that are not simulated."""
    drops = tuple(
        SimpleNamespace(decay=SimpleNamespace(last_slack=None), record=None) for _ in case.file.mass_drop.drop
    )
    identification = SimpleNamespace(modes=(), warnings=())
    identified = SimpleNamespace(drops=drops, identification=identification, certain_modes=[])
    monkeypatch.setattr(mass_drop_study, "identify_drops", lambda _: identified)
    monkeypatch.setattr(mass_drop_study, "identify_tests", lambda *_: Population((), (), ()))
    monkeypatch.setattr(mass_drop_study, "build_fit_report", lambda *_: StudyResult())
    monkeypatch.setattr(mass_drop_study, "compute_statements", lambda *_: {})
    study = mass_drop_study.run_mass_drop_study(case).study
    assert ("reference_over_identified_damping" in study.findings[LINE]) == bool(case.dampings)
    return study.charts[0]


def test_damping_ratios_of_each_model_are_drawn_in_percent(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    chart = draw_frequencies(case, monkeypatch)
    assert chart.marks[0].low == 1.0  # per cent, printed bound of all ratios
    identified, *models = chart.series
    assert identified.label == "identified"
    assert [series.label for series in models] == list(RATIOS)
    for series, ratio in zip(models, RATIOS.values(), strict=True):
        # The lowest mode lies near 0.87 Hz; three spans have at least as many modes below 3 Hz.
        assert len(series.x) >= 3
        assert np.all(np.diff(series.x) > 0)
        assert series.x[-1] <= 3.0
        assert_allclose(series.y, 100 * ratio)


def test_damping_ratios_of_the_case_are_drawn_without_models(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    series = draw_frequencies(replace(case, dampings={}), monkeypatch).series
    assert [drawn.label for drawn in series] == ["identified", "damping of the case"]


def test_modes_are_drawn_at_the_number_of_their_group() -> None:
    modes = [Mode(frequency_Hz=1.0, damping_ratio=0.01, damping_ratio_std=1e-4, sensor_shape=(), group=2)]
    (series,) = mass_drop_study._draw_groups([*modes, modes[0].model_copy(update={"group": None})], []).series
    assert (series.x, series.y) == ([2.0], [1.0])


def test_fitted_coefficient_is_compared_with_the_simulated_one() -> None:
    fitted = SimpleNamespace(kind="contact_wire", matrix="mass", value=0.12, low_95=0.1, high_95=0.14)
    line = simple_line(damping=dict.fromkeys(Kind, Rayleigh(0.1, 0.0)))
    (row,) = mass_drop_study._coefficient_table(SimpleNamespace(coefficients=[fitted]), line).rows
    assert row[1:] == ["0.1", "0.12", "0.1 to 0.14", "+20.0 %"]


# Chart of the observability: the thresholds are those of the fit, and the caption explains them.
ROW = Observability(
    kind="dropper", matrix="mass", largest_share=0.0, variance_inflation=1.0, std=0.1, plausible=0.1,
    plausible_over_std=1.0, residual_without=1.0, observable=False,
)  # fmt: skip
OBSERVED = tuple(
    ROW.model_copy(update={"kind": kind, "largest_share": share, "plausible_over_std": ratio, "observable": observable})
    for kind, share, ratio, observable in (
        ("contact_wire", 0.8, 40.0, True),
        ("dropper", 0.01, 10.0, False),  # well determined, but at most 1 % of the damping of a mode
        ("steady_arm", 0.0, 0.0, False),
    )
)
KINDS = ("contact_wire", "dropper", "steady_arm")
RESULTS = DampingResults.model_construct(coefficients=(), observability=OBSERVED, thresholds=THRESHOLDS)


@pytest.fixture
def chart(monkeypatch: pytest.MonkeyPatch) -> Chart:
    monkeypatch.setattr(mass_drop_study, "build_damping_results", lambda *_: RESULTS)
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    (chart,) = mass_drop_study.build_fit_report(case, SimpleNamespace(modes=())).charts
    return chart


def test_observable_coefficients_are_counted_and_small_shares_are_not(chart: Chart) -> None:
    rows = [row.model_copy(update={"observable": True}) for row in OBSERVED]
    kinds = ("contact_wire", "messenger_wire", "dropper")
    counted = [row.model_copy(update={"kind": kind}) for row, kind in zip(rows, kinds, strict=True)]
    found = mass_drop_study.count_observable(counted)
    assert found == {"observable_wire_coefficients": 2.0, "observable_other_coefficients": 1.0}
    assert set(mass_drop_study.count_observable([]).values()) == {0.0}
    assert "above the dashed line it is observable" not in chart.caption
    assert f"{100 * THRESHOLDS.largest_share:g} %" in chart.caption
    assert chart.marks[0].label == "needed"
    described = re.findall(r"(\w+) mass: [\d.e+-]+, (observable|not observable)", chart.alternative)
    assert described == [(kind, "observable" if kind == "contact_wire" else "not observable") for kind in KINDS]


def test_thresholds_and_smallest_ratio_are_those_of_the_fit_and_of_its_caption(chart: Chart) -> None:
    assert chart.marks[0].low == THRESHOLDS.plausible_over_std
    rows, thresholds = OBSERVED, THRESHOLDS
    left, right = draw_observability.__wrapped__(rows, thresholds).axes
    assert set(left.lines[0].get_xdata()) == {100 * thresholds.largest_share}
    assert set(right.lines[0].get_xdata()) == {thresholds.plausible_over_std}
    description = describe_observability(thresholds)
    assert f"at least {100 * thresholds.largest_share:g} % of the damping of some mode" in description
    assert f"at least {thresholds.plausible_over_std:g} times its standard deviation" in description
    (bars,) = chart.series
    assert bars.y == [40.0, 10.0, mass_drop_study.SMALLEST_DRAWN_RATIO]
    assert (
        f"Values below {mass_drop_study.SMALLEST_DRAWN_RATIO:g} are drawn at {mass_drop_study.SMALLEST_DRAWN_RATIO:g}"
        in chart.caption
    )
