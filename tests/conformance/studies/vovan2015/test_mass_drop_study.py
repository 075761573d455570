"""Report of the mass drops: identified damping ratios, and those of each damping model or of the case."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.drops.population import Population
from pantocheck.conformance.line.elements.damping import ModalDamping
from pantocheck.conformance.runs.system import StudyResult
from pantocheck.conformance.studies.vovan2015 import mass_drop_study

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
    drops = tuple(SimpleNamespace(decay=SimpleNamespace(last_slack=None)) for _ in case.file.mass_drop.drop)
    identification = SimpleNamespace(modes=(), warnings=())
    identified = SimpleNamespace(drops=drops, identification=identification, certain_modes=[])
    monkeypatch.setattr(mass_drop_study, "identify_drops", lambda _: identified)
    monkeypatch.setattr(mass_drop_study, "identify_tests", lambda *_: Population((), (), ()))
    monkeypatch.setattr(mass_drop_study, "build_fit_report", lambda *_: StudyResult())
    outcome = mass_drop_study.run_mass_drop_study(case)
    assert outcome.study is not None
    return outcome.study.charts[0]


def test_damping_ratios_of_each_model_are_drawn_in_percent(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    identified, *models = draw_frequencies(case, monkeypatch).series
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
