"""Start that a record states against the start of its case."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from numpy.testing import assert_allclose

from helpers.converged_fixtures import StateConverged
from helpers.short_cases import change_case
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.results_building import build_results, utc_now
from pantocheck.conformance.grading.start_agreement import compare_starts
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import StartTable
from pantocheck.conformance.results.results_format import SystemIdentity
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered

IDENTITY = SystemIdentity(name="wave", version="1", kind="record")
START: dict[str, Any] = {"place_m": 60.0, "ramp_m": 0.0, "state": "equilibrium_under_uplift_forces"}


def delivered(case: Case, start: StartTable | None) -> Delivered:
    return replace(Wave().run(case), start=start)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"place_m": 60.2}, "its last pantograph starts at 60.2 m, that of the case at 60 m"),
        ({"ramp_m": 30.0}, "its ramp is 30 m long, that of the case 0 m"),
        ({"state": "line_at_rest"}, "its state is 'line_at_rest', that of the case 'equilibrium_under_uplift_forces'"),
    ],
)
def test_every_difference_is_named(case_250: Case, changes: dict[str, Any], text: str) -> None:
    agreement = compare_starts(case_250, StartTable(**(START | changes)))
    assert agreement.state == "differs"
    assert agreement.text == f"The start of the record differs: {text}."


def test_start_within_a_decimetre_is_that_of_the_last_pantograph(case_250: Case, two_pantograph_case: Case) -> None:
    """0.05 m lie inside the tolerance of 0.1 m."""
    agreement = compare_starts(case_250, StartTable(**(START | {"place_m": 60.05, "ramp_m": 0.05})))
    assert agreement.state == "as in the case"
    assert compare_starts(two_pantograph_case, StartTable(**START)).state == "as in the case"
    first = StartTable(**(START | {"place_m": two_pantograph_case.start_positions[0]}))
    assert "starts at 210 m, that of the case at 60 m" in compare_starts(two_pantograph_case, first).text


@pytest.mark.parametrize(("start", "close"), [(START, False), (START | {"ramp_m": 30.0}, True), (None, False)])
def test_stated_difference_can_make_a_verified_value_close(
    state_converged: StateConverged, case_250: Case, start: dict[str, Any] | None, close: bool
) -> None:
    """The mean of 119 N, 1.3 N inside the limits, changes by 4 N with the start; limits and verdict stay the same."""
    run = delivered(case_250, None if start is None else StartTable(**start))
    other = Delivered(Wave(mean=123.0).record(case_250))
    state_converged(case_250, {1: {"mean_force_N": 119.0}})
    result = grade_case(case_250, replace(run, starts=(other,)), "secondary")
    (row,) = result.verification.criteria
    assert (bool(row.close), "start" in row.components, row.verdict) == (close, close, "pass")
    assert_allclose((row.lower, row.upper), (119.0 - 1.309, 119.0 + 1.309), rtol=1e-12)
    assert find_discrepancies(build_results([result], IDENTITY, "secondary", utc_now())) == []


@pytest.mark.parametrize(
    ("start", "state", "place"),
    [
        (StartTable(**START), "as in the case", None),
        (StartTable(**(START | {"ramp_m": 30.0})), "differs", "warnings"),
        (None, "not stated", "notes"),
    ],
)
def test_result_shows_the_start(case_250: Case, start: StartTable | None, state: str, place: str | None) -> None:
    """A difference is a warning, silence is a note, and the verdict depends on neither."""
    result = grade_case(case_250, delivered(case_250, start), "secondary")
    assert result.record.start == state
    shown = {name for name in ("warnings", "notes") if result.record.start_text in getattr(result, name)}
    assert shown == ({place} if place else set())
    assert result.verdict == grade_case(case_250, delivered(case_250, None), "secondary").verdict


def test_reference_simulator_states_the_start_of_the_case_and_its_model_uncertainty(case_250: Case) -> None:
    coarse = change_case(case_250, mesh=(5.0, 0.005))
    run = ReferenceSimulator().run_unrefined(coarse)
    assert run.start == StartTable(**START)
    effect, contact = grade_case(coarse, run, "secondary").model_uncertainty
    assert contact.startswith("Contact of head and wire in place of that of the case (")
    assert effect.startswith("Messenger wire of constant tension")


@pytest.mark.parametrize("start", [START, START | {"state": "other", "ramp_m": 12.5}, None])
def test_start_of_a_sidecar_reaches_the_system(case_250: Case, tmp_path: Path, start: dict[str, Any] | None) -> None:
    record = delivered(case_250, None).record
    write_record(tmp_path / "250.csv", record, case=case_250.id, further={"start": start})
    expected = None if start is None else StartTable(**start)
    assert read_record(tmp_path / "250.csv")[1].start == expected
    outcome = open_record_folder(tmp_path).run(case_250)
    assert outcome.start == expected
