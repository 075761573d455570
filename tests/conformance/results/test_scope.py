"""Scope: state of every step of the procedure, derived from the results of the cases."""

from typing import Any

from pantocheck.conformance.results.results_format import STEPS, CaseResult, Results
from pantocheck.conformance.results.scope import build_scope


def make_case(results: dict[str, Any], **changes: Any) -> CaseResult:
    """The passing example case, changed."""
    example = Results.model_validate(results).cases[0]
    changes = {"steps": ["reference_models"], "library": "identical"} | changes
    return example.model_copy(update=changes)


def states(*cases: CaseResult) -> dict[str, str]:
    return {step.step: step.state for step in build_scope(cases)}


def test_every_step_is_listed_in_order_and_a_graded_case_does_its_step_only(results: dict[str, Any]) -> None:
    steps = ("pantograph_model", "static_check", "reference_models", "line_test", "limits_of_validity")
    found = [(step.step, step.state, step.cases) for step in build_scope([])]
    assert found == [(step, "not done", []) for step in steps]
    assert states(make_case(results)) == dict.fromkeys(STEPS, "not done") | {"reference_models": "done"}


def test_step_needs_a_complete_case_with_a_counted_limit_of_the_library(results: dict[str, Any]) -> None:
    changes: tuple[dict[str, Any], ...] = ({"library": "modified"}, {"criteria": [], "verdict": "info"})
    for change in changes:
        assert states(make_case(results, **change))["reference_models"] == "informative"
    for verdict in ("skip", "error"):
        assert states(make_case(results, verdict=verdict))["reference_models"] == "not done"


def test_step_is_as_good_as_its_best_case_and_names_all(results: dict[str, Any]) -> None:
    cases = [make_case(results, verdict="skip", id="b"), make_case(results, id="a")]
    [step] = [step for step in build_scope(cases) if step.step == "reference_models"]
    assert (step.state, step.cases) == ("done", ["b", "a"])


def test_apparent_mass_without_a_limit_leaves_the_pantograph_model_informative(results: dict[str, Any]) -> None:
    """Limits of dropper lengths say nothing about the pantograph."""
    case = make_case(results, steps=["pantograph_model", "static_check"])
    assert (states(case)["pantograph_model"], states(case)["static_check"]) == ("informative", "done")
