"""Other starts and sections with which the uncertainty of a case is determined."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from helpers.section_lines import section_line
from helpers.short_cases import change_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.cases.start_and_section import (
    has_short_run_in,
    list_earlier_sections,
    list_other_starts,
    run_in_spans,
    shift_section,
    span_length,
)
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.runs import case_run, reference_simulator
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered
from pantocheck.model import discretise
from pantocheck.model.description.failures import SimulationError


def case_named(name: str) -> Case:
    (case,) = (case for case in select_cases([name]) if case.id == name)
    return case


def test_run_in_counts_from_the_first_pantograph_and_determines_the_sections() -> None:
    """The 2002 model starts at 60 m, its section at 240 m; the first of two pantographs starts 200 m ahead."""
    assert run_in_spans(case_named("en50318-2002/250")) == pytest.approx(3.0)
    assert run_in_spans(case_named("en50318-2018/ac-simple/320")) == pytest.approx(29.0)
    assert run_in_spans(case_named("en50318-2018/ac-simple/320-twin")) == pytest.approx(29.0 - 200 / 55)
    # 320 km/h: run-in of 29 spans, so that sections of span 30-39 down to 17-26 keep at least half of it.
    case = case_named("en50318-2018/ac-simple/320")
    assert list_other_starts(case) == ()
    sections = list_earlier_sections(case)
    assert len(sections) == 14
    assert sections[0] == (29 * 55.0, 39 * 55.0)
    assert sections[-1] == (16 * 55.0, 26 * 55.0)
    assert (sections[-1][0] - case.start_positions[0]) / 55 >= run_in_spans(case) / 2


def test_other_starts_of_a_short_run_in(case_250: Case) -> None:
    starts = list_other_starts(case_250)
    assert [start.case.start for start in starts] == pytest.approx([20.0, 40.0, 80.0, 100.0, 120.0, 60.0, 60.0])
    run_in_s = 180.0 / case_250.speed
    assert [start.ramp_s for start in starts] == pytest.approx([0.0] * 5 + [run_in_s / 4, run_in_s / 2])
    assert all(start.case.analysis_section == case_250.analysis_section for start in starts)
    assert all(start.case.end == case_250.end for start in starts)


@pytest.mark.parametrize(
    ("start", "places"),
    [
        (30.0, [10.0, 50.0, 70.0, 90.0]),  # 10 m before the line is left out
        (190.0, [150.0, 170.0, 210.0, 230.0]),  # 250 m lies inside the section
        (240.0, [200.0, 220.0]),  # no run-in, hence no ramp
    ],
)
def test_other_starts_lie_on_the_line_before_the_section(case_250: Case, start: float, places: list[float]) -> None:
    shifted = [
        other.case.start for other in list_other_starts(change_case(case_250, start_m=start)) if not other.ramp_s
    ]
    assert shifted == pytest.approx(places)


def test_other_starts_lie_outside_of_overlaps(case_250: Case) -> None:
    """An overlap from 60 m to 240 m: starts at 80 m, 100 m and 120 m are left out, that at its beginning is not."""
    case = replace(case_250, line=section_line(spans=(4, 9)))
    assert case.line.overlaps == ((60.0, 240.0),)
    assert [start.case.start for start in list_other_starts(case)] == pytest.approx([20.0, 40.0, 60.0, 60.0])


@pytest.mark.parametrize(("start", "short"), [(0.5, True), (20.0, True), (-0.0, False)])
def test_run_in_of_ten_spans_is_long(start: float, short: bool) -> None:
    """Sections that begin at span 11; the start lies at 0 m or later."""
    case = change_case(case_named("en50318-2018/ac-simple/275"), evaluated_spans=(11, 20), start_m=start)
    assert has_short_run_in(case) is short


def test_short_run_in_has_the_sections_of_its_case_and_quarters_of_a_span(case_250: Case) -> None:
    assert list_earlier_sections(case_250) == ()
    compared = change_case(case_250, compared_spans=(3, 8))
    assert list_earlier_sections(compared) == compared.shifted_sections
    shifted = shift_section(case_250.analysis_section, span_length(case_250))
    assert [start for start, _ in shifted] == pytest.approx([195.0, 210.0, 225.0, 255.0, 270.0, 285.0])
    assert {end - start for start, end in shifted} == {120.0}


def test_section_in_metres_is_that_of_its_spans_and_has_earlier_ones(case_250: Case) -> None:
    """Spans 5 and 6 of 60 m; other starts and the end of the run are the same."""
    metres = change_case(case_250, evaluated_spans=None, evaluated_m=(240.0, 360.0))
    assert (metres.analysis_section, metres.analysed_spans) == (case_250.analysis_section, (5, 6))
    assert (metres.end, span_length(metres)) == (case_250.end, 60.0)
    starts, expected = ([other.case.start for other in list_other_starts(case)] for case in (metres, case_250))
    assert starts == expected
    # Section from the middle of span 30 to that of span 40: its mean span is 55 m.
    case = case_named("en50318-2018/ac-simple/320")
    metres = change_case(case, evaluated_spans=None, compared_spans=None, evaluated_m=(1622.5, 2172.5))
    assert list_earlier_sections(metres)[:2] == ((1567.5, 2117.5), (1512.5, 2062.5))
    assert len(list_earlier_sections(metres)) == int(run_in_spans(metres) / 2)


@pytest.mark.parametrize(
    ("section", "spans"), [((230.0, 250.0), (4, 5)), ((241.0, 290.0), (5, 5)), ((0.0, 600.0), (1, 10))]
)
def test_section_in_metres_has_spans(case_250: Case, section: tuple[float, float], spans: tuple[int, int]) -> None:
    assert change_case(case_250, evaluated_spans=None, evaluated_m=section).analysed_spans == spans


# Further runs of the reference simulator, from which the uncertainty follows: two meshes and other starts.
@pytest.fixture(scope="module")
def case() -> Case:
    """Two pantographs 60 m apart on six spans of the 2002 model, analysis section in spans 4 and 5: a run-in of 1 span.

    The elements of 1 m make the four meshes of this test cheap.
    """
    loaded = load_case(library_folder() / "en50318-2002" / "250.toml")
    keys = {"evaluated_spans": (4, 5), "spacing_m": (60.0,), "run_out_m": 0.0, "pantograph": loaded.file.pantograph * 2}
    return replace(change_case(loaded, 6, (1.0, 1e-3), **keys), pantographs=loaded.pantographs * 2)


@pytest.fixture(scope="module")
def delivered(case: Case) -> Delivered:
    return ReferenceSimulator().run(case)


def test_runs_have_other_meshes_and_starts(case: Case, delivered: Delivered) -> None:
    steps = [(run.run.element_m, run.run.dt_s) for run in (delivered.coarse, delivered, delivered.refined)]
    assert steps == [(2.0, 0.002), (1.0, 0.001), (0.5, 0.0005)]
    starts = [run.record for run in delivered.starts]
    assert len(starts) == len(list_other_starts(case)) == 6
    step = case.speed * 0.001
    places = [record.position[1, 0] - step for record in starts if record is not None]
    assert places == pytest.approx([20.0, 40.0, 80.0, 100.0, 60.0, 60.0])
    first = [np.abs(record.force[:, 0]).max() for record in starts if record is not None]
    assert min(first[:4]) > 100  # the static force acts at once
    assert max(first[4:]) < 1  # a ramp begins without contact force


def test_both_pantographs_have_an_uncertainty_from_mesh_start_and_section(case: Case, delivered: Delivered) -> None:
    """Every force quantity of both; the two pantographs differ, because the second runs in the wake of the first."""
    found = CaseEvaluation(case, delivered).uncertainty
    for pantograph in (1, 2):
        for quantity in ("mean_force_N", "std_force_N", "rms_20_50_N", "max_force_N", "min_force_N"):
            parts = found.list_components(pantograph, quantity)
            assert parts.keys() == {"discretisation", "start", "section", "sampling", "resolution"}
            assert parts["start"] > 0  # type: ignore[operator]
    assert found.combined[1]["std_force_N"] != found.combined[2]["std_force_N"]


def test_coarse_run_that_does_not_converge_leaves_two_meshes(
    case: Case, delivered: Delivered, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The run of the case counts all the same; the half-width has the large safety factor."""

    def deliver(case: Case, discretisation: Discretisation, uplift_forces: Any = None, *_: Any, **__: Any) -> Any:
        if discretisation.element_m > 1.0:
            raise SimulationError("the forces of a time step did not converge")
        return (delivered if uplift_forces is None else delivered.refined), (120.0, 120.0), None

    monkeypatch.setattr(reference_simulator, "_deliver", deliver)
    monkeypatch.setattr(reference_simulator, "_deliver_starts", lambda *_: ())
    without = ReferenceSimulator().run(case)
    assert without.coarse is None
    found = CaseEvaluation(case, replace(without, starts=())).uncertainty
    assert "doubled" not in found.components["discretisation"].basis
    values = [CaseEvaluation(case, replace(run, refined=None)).values.evaluation.values[2]["std_force_N"]
              for run in (delivered, delivered.refined) if run is not None]  # fmt: skip
    expected = 3 * abs(values[0] - values[1])  # type: ignore[operator]
    assert found.list_components(2, "std_force_N")["discretisation"] == pytest.approx(expected, rel=1e-12)


def test_runs_are_reproducible(case: Case, delivered: Delivered) -> None:
    """The same start twice gives the same samples, whether the line served other runs before or is new."""
    start = list_other_starts(case)[-1]
    discretisation = case.file.discretisation
    line = discretise(build_catenary(case.line), discretisation.element_m)
    (again,) = case_run.run_starts([start], line, discretisation, (120.0, 120.0))
    before = delivered.starts[-1].record
    np.testing.assert_array_equal(again.force, before.force)
