"""Verdicts of the procedure: claims need runs under their conditions, and missing steps never pass."""

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.criterion_fixtures import build_requirement
from pantocheck.conformance.core.verdicts import WORST_FIRST, Verdict, worst_verdict
from pantocheck.conformance.grading.criterion_grading import build_criterion
from pantocheck.conformance.grading.procedure_verdict import (
    _judge_case,
    decide_procedure,
    describe_closest,
    judge_claim,
    judge_procedure,
    require_steps_for_claim,
)
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.procedure_format import (
    STEP_NAMES,
    Evidence,
    Procedure,
    ProcedureStep,
    ValidityClaim,
)


def run(number: int, speed: float, line: str = "A", pantograph: str = "P", **changes: Any) -> Evidence:
    keys = {"passed": True, "spacing_m": [], "inputs": {}} | changes
    return Evidence(id=f"pair/{number}", line=line, pantographs=[pantograph], speed_km_h=speed, **keys)


def claim(kind: Any, name: str = "", claimed: tuple[float, float] | None = None) -> ValidityClaim:
    return ValidityClaim(kind=kind, name=name, unit="", claimed=claimed)


SPEEDS = claim("speed", claimed=(160.0, 200.0))


@pytest.mark.parametrize(
    ("evidence", "verified"),
    [
        ([run(1, 160), run(2, 200)], (160.0, 200.0)),
        ([run(1, 150), run(2, 210)], (150.0, 210.0)),
        ([run(1, 160), run(2, 190)], None),
        ([run(1, 200)], None),
        ([run(1, 160), run(2, 200, passed=False)], None),
        ([], None),
    ],
)
def test_speeds_between_passed_runs(evidence: list[Evidence], verified: tuple[float, float] | None) -> None:
    judged = judge_claim(SPEEDS, [SPEEDS], evidence)
    assert judged.verdict == ("skip" if verified is None else "pass")
    assert (judged.reason is None) == (verified is not None)
    if verified is not None:
        assert judged.verified == verified


def test_every_claimed_line_and_pantograph_needs_the_speeds() -> None:
    """Line B was tested at 160 km/h only, so that 160 to 200 km/h is not verified for both lines."""
    claims = [claim("line", "A"), claim("line", "B"), SPEEDS]
    evidence = [run(1, 160), run(2, 200), run(3, 160, "B")]
    assert judge_claim(SPEEDS, claims, evidence).verdict == "skip"
    assert judge_claim(SPEEDS, claims, [*evidence, run(4, 200, "B")]).verdict == "pass"
    both = [*claims, claim("pantograph", "Q")]
    assert judge_claim(SPEEDS, both, [*evidence, run(4, 200, "B")]).verdict == "skip"


def test_claims_on_lines_spacing_and_inputs_need_runs_that_have_them() -> None:
    line = claim("line", "A")
    assert judge_claim(line, [line], [run(1, 160, "B")]).verdict == "skip"
    assert judge_claim(line, [line], [run(1, 160, "A")]).evidence == ["pair/1"]
    unjudged = Evidence(id="1", line="A", pantographs=["P"], speed_km_h=160, spacing_m=[], inputs={})
    assert judge_claim(claim("line", "A"), [], [unjudged]).verdict == "skip"
    spacing = claim("spacing", claimed=(85.0, 200.0))
    single = [run(1, 160)]
    assert judge_claim(spacing, [spacing], single).verdict == "skip"
    pairs = [run(2, 160, spacing_m=[85.0]), run(3, 160, spacing_m=[200.0, 100.0])]
    assert judge_claim(spacing, [spacing], pairs).verified == (85.0, 200.0)
    change = claim("change", "line.contact_wire.tension_N", (18e3, 20e3))
    stated = [run(4, 160, inputs={change.name: tension}) for tension in (18e3, 20e3)]
    assert judge_claim(change, [change], single).verdict == "skip"
    assert judge_claim(change, [change], stated).verdict == "pass"


@given(st.lists(st.tuples(st.floats(100, 300), st.sampled_from("AB"), st.booleans()), max_size=6), st.data())
def test_a_removed_run_never_verifies_a_claim(conditions: list[tuple[float, str, bool]], data: st.DataObject) -> None:
    claims = [claim("line", "A"), SPEEDS]
    evidence = [run(n, speed, line, passed=passed) for n, (speed, line, passed) in enumerate(conditions)]
    kept = data.draw(st.lists(st.sampled_from(evidence), unique_by=id)) if evidence else []
    for item in claims:
        if judge_claim(item, claims, evidence).verdict != "pass":
            assert judge_claim(item, claims, kept).verdict != "pass"


def build_procedure(**states: str) -> Procedure:
    steps = [
        ProcedureStep(step=name, required=name != "line_test", state=states.get(name, "done")) for name in STEP_NAMES
    ]
    return Procedure(title="Test", digest="sha256:0", steps=steps)


def test_missing_steps_prevent_a_pass_and_informative_ones_decide_nothing() -> None:
    """A step without criteria is `info`, one that was not done `skip`; `error` if its data could not be used."""
    for state, verdict in (("done", "info"), ("not done", "skip"), ("error", "error")):
        decided = decide_procedure(build_procedure(static_check=state), [], accepted=False)
        assert decided.steps[1].verdict == verdict
        assert judge_procedure(decided.steps) == verdict
    steps = [
        ProcedureStep(step="line_test", required=False, state="error", verdict="error"),
        ProcedureStep(step="static_check", required=True, state="done", verdict="pass"),
    ]
    assert judge_procedure(steps) == "pass"
    assert judge_procedure(steps[:1]) == "info"


def test_every_claim_is_decided() -> None:
    claims = [claim("line", name) for name in "AB"]
    decided = decide_procedure(build_procedure().model_copy(update={"claims": claims}), [], accepted=False)
    assert [(item.name, item.verdict) for item in decided.claims] == [("A", "skip"), ("B", "skip")]


def judge_line(states: dict[str, str], verdicts: dict[str, Any]) -> ValidityClaim:
    """Claim on a line with a passed run, after five steps with these verdicts; without one, a step passes."""
    steps = [
        ProcedureStep(step=name, required=False, state=states.get(name, "done"), verdict=verdicts.get(name, "pass"))
        for name in STEP_NAMES[:-1]
    ]
    line = claim("line", "A")
    return require_steps_for_claim(judge_claim(line, [line], [run(1, 160)]), steps)


@pytest.mark.parametrize(("number", "name"), list(enumerate(STEP_NAMES[:-1], 1)))
def test_a_claim_rests_on_every_step(number: int, name: str) -> None:
    """It is not verified without one of them, whether the dossier requires it or not."""
    assert judge_line({}, {}).verdict == "pass"
    judged = judge_line({name: "not done"}, {name: "skip"})
    assert (judged.verdict, judged.verified, judged.evidence) == ("skip", None, ["pair/1"])
    assert judged.reason == f"rests on runs only; step {number} ({name.replace('_', ' ')}) not done"


@pytest.mark.parametrize("first", WORST_FIRST)
@pytest.mark.parametrize("second", WORST_FIRST)
def test_a_removed_step_never_improves_a_claim(first: Verdict, second: Verdict) -> None:
    """A claim is at most as good as every step; a step that fails leaves it `skip`, as a removed one does."""
    verdicts = {"pantograph_model": first, "static_check": second}
    before = judge_line({}, verdicts).verdict
    assert before == max(worst_verdict([first, second]), "skip", key=WORST_FIRST.index)
    for name in STEP_NAMES[:-1]:
        after = judge_line({name: "not done"}, verdicts | {name: "skip"}).verdict
        assert WORST_FIRST.index(after) <= WORST_FIRST.index(before)


def test_an_exact_value_on_its_limit_has_no_margin() -> None:
    """An element length of 0.5 m as declared is not close to a limit; a smaller or uncertain one is compared."""
    requirement = build_requirement("largest_element_m", None, 0.5, trust="primary", pantograph=LINE)
    exact, smaller = (build_criterion(requirement, value, None, "primary") for value in (0.5, 0.4))
    assert exact.margin == 0
    assert describe_closest([(None, exact)])["margin"] is None
    assert describe_closest([(None, exact), (None, smaller)])["margin"] == pytest.approx(0.2)
    assert describe_closest([(None, exact.model_copy(update={"uncertainty": 0.01}))])["margin"] == 0


def test_acceptance_changes_the_verdict_of_unconfirmed_cases_alone() -> None:
    cases: list[Any] = [SimpleNamespace(verdict=verdict, library="identical") for verdict in WORST_FIRST]
    judged = {
        (case.verdict, accepted): _judge_case(case, True, accepted) for case in cases for accepted in (True, False)
    }
    assert {key: found for key, found in judged.items() if found != key[0]} == {("unconfirmed", True): "pass"}
