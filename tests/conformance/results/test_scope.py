"""Scope: state of every step of the procedure, derived from the results of the cases."""

from typing import Any

import pytest

from pantocheck.conformance.results.results_format import STEPS, CaseResult, Results
from pantocheck.conformance.results.scope import build_scope


def make_case(results: dict[str, Any], **changes: Any) -> CaseResult:
    """The passing example case, changed."""
    example = Results.model_validate(results).cases[0]
    changes = {"steps": ["reference_models"], "library": "identical"} | changes
    return example.model_copy(update=changes)


def states(*cases: CaseResult) -> dict[str, str]:
    return {step.step: step.state for step in build_scope(cases)}


def test_every_step_is_listed_in_the_order_of_the_procedure() -> None:
    assert [(step.step, step.state, step.cases) for step in build_scope([])] == [
        ("pantograph_model", "not done", []),
        ("static_check", "not done", []),
        ("reference_models", "not done", []),
        ("line_test", "not done", []),
        ("limits_of_validity", "not done", []),
    ]


def test_graded_reference_case_does_its_step_only(results: dict[str, Any]) -> None:
    assert states(make_case(results)) == dict.fromkeys(STEPS, "not done") | {"reference_models": "done"}


@pytest.mark.parametrize("change", [{"library": "modified"}, {"criteria": [], "verdict": "info"}])
def test_step_without_a_counted_limit_of_the_library_is_informative(
    results: dict[str, Any], change: dict[str, Any]
) -> None:
    assert states(make_case(results, **change))["reference_models"] == "informative"


@pytest.mark.parametrize("verdict", ["skip", "error"])
def test_step_without_a_complete_case_is_not_done(results: dict[str, Any], verdict: str) -> None:
    assert states(make_case(results, verdict=verdict))["reference_models"] == "not done"


def test_step_is_as_good_as_its_best_case_and_names_all(results: dict[str, Any]) -> None:
    cases = [make_case(results, verdict="skip", id="b"), make_case(results, id="a")]
    [step] = [step for step in build_scope(cases) if step.step == "reference_models"]
    assert (step.state, step.cases) == ("done", ["b", "a"])


def test_apparent_mass_without_a_limit_leaves_the_pantograph_model_informative(results: dict[str, Any]) -> None:
    """Limits of dropper lengths say nothing about the pantograph."""
    case = make_case(results, steps=["pantograph_model", "static_check"])
    assert (states(case)["pantograph_model"], states(case)["static_check"]) == ("informative", "done")
