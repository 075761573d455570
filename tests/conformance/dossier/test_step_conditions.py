"""Parameters and conditions of the runs: each run counts, each declared part is listed."""

from types import SimpleNamespace
from typing import Any

import pytest

from helpers.example_results import passing_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.dossier.dossier_file import ParameterTable
from pantocheck.conformance.dossier.line_test_step import LINE_TEST_PROFILE
from pantocheck.conformance.dossier.model_steps import check_parameters
from pantocheck.conformance.dossier.run_reading import run_and_read
from pantocheck.conformance.dossier.step_result import list_inputs
from pantocheck.conformance.results.results_format import CaseResult


def build_dossier(parameters: dict[str, Any], *claimed: str) -> Any:
    """Parts of a dossier that the steps read."""
    return SimpleNamespace(
        file=SimpleNamespace(
            parameters=ParameterTable(**parameters),
            trust="secondary",
            validity=SimpleNamespace(change=[SimpleNamespace(key=key) for key in claimed]),
        )
    )


def build_run(**facts: Any) -> CaseResult:
    case = CaseResult.model_validate(passing_case())
    return case.model_copy(update={"run": case.run.model_copy(update=facts)})


def test_declared_parameters_bound_every_run() -> None:
    """The second run has the largest element, the largest step and the shortest time."""
    dossier = build_dossier({"element_m": 0.5, "time_step_s": 0.001, "shortest_run_s": 10.0, "start": "at rest"})
    good = build_run(element_m=0.4, dt_s=0.0005, simulated_s=12.0)
    worse = build_run(element_m=0.6, dt_s=0.002, simulated_s=9.0)
    step = check_parameters(dossier, [good, worse])
    assert [(row.value, row.verdict) for row in step.criteria] == [(0.6, "fail"), (0.002, "fail"), (9.0, "fail")]
    assert [item.name for item in step.parameters] == [
        "largest_element_m", "largest_time_step_s", "shortest_run_s", "start",
    ]  # fmt: skip
    assert [row.verdict for row in check_parameters(dossier, [good, good]).criteria] == ["pass"] * 3


def test_inputs_and_parameters_of_a_claim_are_listed(case_250: Case) -> None:
    """An input of pantographs that differ, one that does not exist, and a text have no number."""
    line, pantographs = case_250.line, case_250.pantographs
    tension, force = "line.contact_wire.tension_N", "pantograph.chain.masses_kg.2"
    dossier = build_dossier({}, tension, force, "pantograph.chain.masses_kg.9", "line.title", "speed_km_h")
    chain = pantographs[0].chain
    expected = {tension: line.contact_wire.tension_N, force: chain.masses_kg[1]}
    assert list_inputs(dossier, line, pantographs) == expected
    step = check_parameters(build_dossier({"start": "at rest"}), [build_run()])
    assert {row.quantity: row.verdict for row in step.criteria} == dict.fromkeys(
        ("largest_element_m", "largest_time_step_s", "shortest_run_s"), "skip"
    )
    step = check_parameters(build_dossier({"element_m": 1.0}), [build_run(element_m=0.5)])
    (start,) = (row for row in step.criteria if row.quantity == "start")
    assert (start.verdict, start.reason) == ("skip", "the dossier does not declare it")


def test_run_with_another_filter_than_the_line_tests_is_refused(case_250: Case, tmp_path: Any) -> None:
    profile = load_profile(LINE_TEST_PROFILE)
    other = profile.model_copy(update={"filter": profile.filter.model_copy(update={"cutoff_Hz": 19.0})})
    nothing: Any = None
    with pytest.raises(InputError, match="is not that of the line tests"):
        run_and_read(case_250, "up", nothing, nothing, other, tmp_path / "run.h5")
