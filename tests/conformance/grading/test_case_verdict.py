"""Verdict of a case and of a run: no pass without a counted limit and a consistent record."""

from pathlib import Path
from typing import Any, get_args
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.command_line import pantocheck
from helpers.converged_fixtures import StateConverged
from helpers.example_results import example, passing_case
from pantocheck.conformance.app.commands.command_output import EXIT_CODES
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.criterion import CaseVerification
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.verdicts import WORST_FIRST, Verdict
from pantocheck.conformance.documents.verification import find_gaps
from pantocheck.conformance.execution.plan import Plan, PreparedPlan, prepare_plan
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.case_selection import VerdictChoice, choose_verdicts
from pantocheck.conformance.grading.case_verdict import Participation, judge_baseline, judge_case, read_participation
from pantocheck.conformance.pages.ci_reports import render_junit
from pantocheck.conformance.pages.verdict_reasons import build_headline
from pantocheck.conformance.results.case_facts_format import BaselineComparison, RecordFacts, RecordState
from pantocheck.conformance.results.procedure_format import Procedure, ProcedureStep
from pantocheck.conformance.results.results_format import CaseResult, Results, VerdictName
from pantocheck.conformance.results.results_reading import read_results

CODE = "published passing code (Wang et al.)"
PUBLISHED = (
    *("run", "en50318-2002/*", "--system", "record:en50318-2002/known-passing-code"),
    *("--verdicts", "criteria", "--formats", "json,junit"),
)

grades = st.lists(st.sampled_from(["pass", "fail", "skip", "error", "info"]), max_size=5)


def record(state: RecordState, demanded: bool = True) -> RecordFacts:
    return RecordFacts(state=state, reason="reason", demanded=demanded)


@pytest.mark.parametrize(
    ("criteria", "state", "verdict"),
    [
        (["pass", "info"], "consistent", "pass"),
        (["pass", "info"], "unconfirmed", "unconfirmed"),
        (["pass"], "contradicted", "error"),
        (["info", "info"], "consistent", "info"),
        (["info"], "unconfirmed", "info"),
        ([], "consistent", "info"),
        (["pass", "skip", "info"], "consistent", "skip"),
        (["pass", "skip"], "unconfirmed", "skip"),
        (["fail", "skip"], "unconfirmed", "fail"),
    ],
)
def test_case_is_as_good_as_its_worst_row(criteria: list[Verdict], state: RecordState, verdict: Verdict) -> None:
    assert judge_case(criteria, record(state)) == verdict


@given(grades, st.sampled_from(get_args(RecordState)))
def test_pass_needs_a_counted_criterion_and_a_verified_record(criteria: list[Verdict], state: RecordState) -> None:
    passes = judge_case(criteria, record(state)) == "pass"
    assert passes == ("pass" in criteria and set(criteria) <= {"pass", "info"} and state == "consistent")


def test_only_pass_ends_with_exit_code_0_and_the_worst_case_decides() -> None:
    assert {verdict: EXIT_CODES[verdict] for verdict in WORST_FIRST} == {
        "pass": 0, "unconfirmed": 1, "info": 3, "skip": 1, "undecided": 1, "fail": 1, "error": 2
    }  # fmt: skip
    cases: list[tuple[str, Verdict]] = [("a", "pass"), ("b", "unconfirmed"), ("c", "fail")]
    assert Participation().judge_run(cases, "mine") == "fail"
    assert Participation(information=("c",)).judge_run(cases, "mine") == "unconfirmed"
    assert Participation(("c",), ("mine",)).judge_run(cases, "mine") == "pass"
    assert Participation(("c",), ("other",)).judge_run(cases, "mine") == "unconfirmed"
    assert Participation(("a", "b", "c")).judge_run(cases, "mine") == "info"
    assert judge_case(["pass"], record("unconfirmed", demanded=False)) == "pass"
    assert judge_case(["pass"], record("contradicted", demanded=False)) == "error"
    assert [judge_baseline([], values) for values in (0, 1)] == ["info", "pass"]


def test_record_of_a_run_is_verified_and_its_loss_is_noticed(wave: Any, case_250: Case) -> None:
    """With its height the record is consistent; without it, the motion cannot be checked."""
    results = run_cases([case_250], wave()).to_dict()
    assert results["cases"][0]["record"]["state"] == "consistent"
    results["cases"][0]["record"] = None
    assert any("the state of the record is missing" in text for text in find_gaps(Results.model_validate(results)))


def test_published_statistics_are_unconfirmed_unless_accepted_by_name(tmp_path: Path) -> None:
    def exit_code(*arguments: str) -> int:
        return pantocheck(*PUBLISHED, "--out", tmp_path, *arguments).exit_code

    def junit() -> ElementTree.Element:
        return ElementTree.parse(tmp_path / "junit.xml").getroot()

    assert exit_code() == 1
    assert junit().get("failures") == "2"
    assert exit_code("--accept-unconfirmed", "another code") == 1
    assert exit_code("--trust", "primary") == 3  # no limit counts
    assert exit_code("--accept-unconfirmed", CODE) == 0
    # Ten quantities of each case are verified for information; the records are accepted.
    assert (junit().get("failures"), junit().get("skipped")) == ("0", "22")


def test_published_statistics_do_not_meet_the_converged_solution(tmp_path: Path) -> None:
    """Verification is requested by default of another system; its result is shown as it comes out."""
    arguments = (*PUBLISHED[:4], "--accept-unconfirmed", CODE, "--formats", "json", "--out", tmp_path)
    assert pantocheck(*arguments).exit_code == 1
    results = read_results(tmp_path / "results.json")
    assert (results.verdict, results.criteria_verdict, results.verification_verdict) == ("fail", "pass", "fail")


def test_headline_names_what_keeps_the_result_from_being_better(passing: dict[str, Any]) -> None:
    first = passing["cases"][0]
    informative = [first | {"id": str(i), "verdict": "info", "criteria": []} for i in range(4)]
    results = passing | {"verdict": "info", "cases": [first, *informative]}
    assert build_headline(Results.model_validate(results)) == "1 of 5 cases passes, 4 have no limit that counts."
    shown = results | {"verdict": "pass", "information": ["0", "1", "2", "3"]}
    assert build_headline(Results.model_validate(shown)) == (
        "All 16 values with a limit that counts in 1 case lie inside the limits of the case as printed by Wang et al. "
        "(secondary source). "
        "For information, not part of the verdict: 0, 1, 2, 3."
    )
    unconfirmed = passing | {"cases": [first | {"verdict": "unconfirmed"}]}
    assert build_headline(Results.model_validate(unconfirmed)) == "0 of 1 case passes, 1 has an unconfirmed record."
    name = passing["system"]["name"]
    accepted = build_headline(Results.model_validate(unconfirmed | {"accepted_unconfirmed": [name]}))
    assert accepted.endswith(f"Accepted by the user: unconfirmed records of {name}.")


def test_junit_passes_only_what_counts_in_the_default_run(results: dict[str, Any]) -> None:
    """A limit that does not count is skipped; so is a failure in a case for information."""
    root = ElementTree.fromstring(render_junit(Results.model_validate(results)))
    assert "the limit is provisional" in "".join(e.get("message", "") for e in root.iter("skipped"))
    informative = Results.model_validate(results | {"information": ["en50318-2002/300"]})
    shown = ElementTree.fromstring(render_junit(informative))
    assert (root.get("failures"), shown.get("failures")) == ("1", "0")
    assert any(e.get("message", "").startswith("for information: failure: ") for e in shown.iter("skipped"))
    secondary, provisional = (prepare_plan(Plan(trust=trust)) for trust in ("secondary", "provisional"))
    ids = {case.id for case in secondary.cases}
    assert {"en50318-2002/250", "en50318-2018/ac-simple/static"} <= ids
    assert not ids & {"en50318-2018/ac-simple/320", "vovan2015/contact-force"}
    assert "en50318-2018/ac-simple/320" in {case.id for case in provisional.cases}
    assert secondary.participation.information == ()


CASE, RESULTS = CaseResult.model_validate(passing_case()), Results.model_validate(example())
VERDICTS = st.sampled_from(WORST_FIRST)
REQUESTS = st.sampled_from([("criteria",), ("verification",), ("criteria", "verification")])


def case_result(
    case_id: str, criteria: Verdict, verification: Verdict | None, drift: Verdict | None = None
) -> CaseResult:
    """Result of a case with two verdicts and, if stated, a criterion of its drift from a baseline."""
    other = None
    if verification is not None:
        other = CaseVerification(
            verdict=verification, reason=None, confirmed_by="another code", digest="", omitted=[], criteria=[]
        )
    row = CASE.criteria[0].model_copy(update={"verdict": drift, "baseline": 1.0})
    changes = {"id": case_id, "verdict": criteria, "criteria_verdict": criteria, "verification": other}
    return CASE.model_copy(update=changes | {"criteria": [] if drift is None else [row]})


def decide(participation: Participation, *cases: CaseResult) -> Results:
    return participation.decide_run(RESULTS.model_copy(update={"cases": list(cases)}))


def rank(verdict: Verdict | None) -> int:
    """Place of a verdict, the worst at 0; no verdict is none."""
    return len(WORST_FIRST) if verdict is None else WORST_FIRST.index(verdict)


@given(VERDICTS, st.none() | VERDICTS, REQUESTS)
def test_case_is_as_good_as_the_worst_requested_verdict(
    criteria: Verdict, verification: Verdict | None, requested: tuple[VerdictName, ...]
) -> None:
    """An error of the criteria is an error of the case, whichever verdict is requested."""
    decided = Participation(requested=requested).decide_case(case_result("a", criteria, verification))
    chosen = [criteria] if "criteria" in requested or criteria == "error" else []
    chosen += [verification] if "verification" in requested and verification is not None else []
    expected = min(chosen, key=rank) if chosen else "info"
    lacking = "verification" in requested and verification is None
    assert decided.verdict == ("unconfirmed" if expected == "pass" and lacking else expected)


@given(VERDICTS, st.none() | VERDICTS, st.none() | VERDICTS, REQUESTS)
def test_verification_never_lifts_the_criteria(
    criteria: Verdict, verification: Verdict | None, other: Verdict | None, requested: tuple[VerdictName, ...]
) -> None:
    results, without = (
        decide(Participation(requested=requested), case_result("a", criteria, entry)) for entry in (verification, other)
    )
    assert results.criteria_verdict == without.criteria_verdict == criteria
    if "criteria" in requested:
        assert rank(results.verdict) <= rank(criteria)
    if "verification" in requested:
        assert rank(results.verdict) <= rank(verification or "unconfirmed")
    if requested == ("criteria",):
        assert results.verdict == criteria


@given(st.lists(st.tuples(VERDICTS, st.none() | VERDICTS), min_size=1, max_size=4), REQUESTS)
def test_decision_is_stable(pairs: list[tuple[Verdict, Verdict | None]], requested: tuple[VerdictName, ...]) -> None:
    """A certificate is verified by the same decision on its stated results."""
    cases = [case_result(str(number), *pair) for number, pair in enumerate(pairs)]
    results = decide(Participation(requested=requested, verification_only=("0",)), *cases)
    assert read_participation(results).decide_run(results) == results


def test_case_without_a_limit_or_verdict_that_counts_is_informative() -> None:
    alone = decide(Participation(requested=("verification",)), case_result("a", "pass", None))
    assert (alone.verdict, alone.verification_verdict, alone.criteria_verdict) == ("info", None, "pass")
    both = decide(Participation(requested=("criteria", "verification")), case_result("a", "pass", None))
    assert (both.verdict, both.cases[0].verdict) == ("unconfirmed", "unconfirmed")
    cases = case_result("a", "pass", "pass"), case_result("b", "info", "pass")
    both = ("criteria", "verification")
    assert decide(Participation(requested=both), *cases).verdict == "pass"  # that of the judged case
    only = decide(Participation(requested=both, verification_only=("b",)), *cases)
    assert (only.verdict, only.criteria_verdict, only.verification_verdict) == ("pass", "pass", "pass")
    shown = decide(Participation(requested=both, information=("b",)), cases[0], case_result("b", "fail", "fail"))
    assert (shown.verdict, shown.criteria_verdict, shown.verification_verdict) == ("pass", "pass", "pass")


def test_widened_limit_of_one_case_leaves_the_run_without_a_pass() -> None:
    """The pass of another case does not hide a limit of the library that the user widened."""
    row = CASE.criteria[0].model_copy(update={"verdict": "info", "doubt": "the limit of the library is widened"})
    widened = case_result("b", "info", None).model_copy(update={"criteria": [row]})
    assert decide(Participation(), case_result("a", "pass", None), widened).verdict == "info"
    assert decide(Participation(information=("b",)), case_result("a", "pass", None), widened).verdict == "pass"
    assert decide(Participation(), case_result("a", "fail", None), widened).verdict == "fail"


def test_drift_and_accepted_records_count_for_both_verdicts() -> None:
    drifted = case_result("a", "fail", "pass", drift="fail")
    assert decide(Participation(requested=("verification",)), drifted).verdict == "fail"
    failed = case_result("a", "fail", "pass")
    assert decide(Participation(requested=("verification",)), failed).verdict == "pass"
    both, name = ("criteria", "verification"), RESULTS.system.name
    case = case_result("a", "unconfirmed", "unconfirmed")
    assert decide(Participation(requested=both), case).verdict == "unconfirmed"
    assert decide(Participation(requested=both, accepted_unconfirmed=(name,)), case).verdict == "pass"


@pytest.mark.parametrize("state", ["consistent", "unconfirmed"])
def test_accepted_system_still_needs_the_verification_of_every_case(state: RecordState) -> None:
    """The verification of another case does not stand for a missing one."""
    both, name = ("criteria", "verification"), RESULTS.system.name
    accepting = Participation(requested=both, accepted_unconfirmed=(name,))
    verified = case_result("a", "unconfirmed", "unconfirmed")
    lacking = case_result("b", "unconfirmed" if state == "unconfirmed" else "pass", None)
    lacking = lacking.model_copy(update={"record": record(state)})
    decided = decide(accepting, verified, lacking)
    assert (decided.verdict, decided.verification_verdict) == ("unconfirmed", "pass")
    assert build_headline(decided).startswith("1 of 2 cases passes, 1 passes the criteria without a verification")
    step = ProcedureStep(step="line_test", required=True, state="done", cases=["a", "b"])
    dossier = decided.model_copy(update={"procedure": Procedure(title="Test", digest="sha256:0", steps=[step])})
    assert accepting.decide_run(dossier).verdict == "unconfirmed"
    shown = Participation((lacking.id,), (name,), both)
    assert decide(shown, verified, lacking).verdict == "pass"
    assert decide(Participation(accepted_unconfirmed=(name,)), verified, lacking).verdict == "pass"


@given(VERDICTS, st.none() | VERDICTS, VERDICTS, REQUESTS, st.booleans())
def test_baseline_never_improves_a_verdict(
    criteria: Verdict, verification: Verdict | None, drift: Verdict, requested: tuple[VerdictName, ...], listed: bool
) -> None:
    """Whether its criteria are listed or only its verdict is stated; the other verdicts do not depend on it."""
    participation = Participation(requested=requested, accepted_unconfirmed=(RESULTS.system.name,))
    plain = case_result("a", criteria, verification)
    comparison = BaselineComparison(verdict=drift, name="b.json", drift_pct=1.0, values=8, drifted=1)
    row = case_result("a", criteria, verification, drift).criteria
    compared = plain.model_copy(update={"baseline": comparison, "criteria": row if listed else []})
    without, results = decide(participation, plain), decide(participation, compared)
    assert rank(results.verdict) <= rank(without.verdict)
    assert rank(results.cases[0].verdict) <= rank(without.cases[0].verdict)
    assert rank(results.cases[0].verdict) <= rank(drift)
    assert results.criteria_verdict == without.criteria_verdict
    assert results.verification_verdict == without.verification_verdict
    assert read_participation(results).decide_run(results) == results


# Selection: requested verdicts by system, and the cases of a run without a list of cases.


TWIN, PRINTED = "en50318-2018/ac-simple/320-twin", "en50318-2002/250"
BOTH = ("criteria", "verification")


@pytest.fixture
def verifiable(state_converged: StateConverged, case_250: Case) -> None:
    """Converged values for a case with published limits and for one without any."""
    for name in (PRINTED, TWIN):
        renamed = case_250.file.model_copy(update={"id": name})
        state_converged(Case(renamed, case_250.line, case_250.pantographs, ()), {})


@pytest.mark.parametrize(
    ("choice", "system", "expected"),
    [
        (None, "builtin", ("criteria",)),
        (None, "record:folder", BOTH),
        (None, "command:program", BOTH),
        ("both", "builtin", BOTH),
        ("verification", "builtin", ("verification",)),
        ("criteria", "record:folder", ("criteria",)),
    ],
)
def test_requested_verdicts_by_system(choice: VerdictChoice | None, system: str, expected: tuple[str, ...]) -> None:
    assert choose_verdicts(choice, system) == expected


def ids(prepared: PreparedPlan) -> set[str]:
    return {case.id for case in prepared.cases}


@pytest.mark.usefixtures("verifiable")
def test_default_run_of_another_system_takes_the_cases_with_converged_values() -> None:
    builtin, foreign = (prepare_plan(Plan(system=system)) for system in ("builtin", "record:folder"))
    assert ids(foreign) - ids(builtin) == {TWIN}
    assert builtin.participation.requested == ("criteria",)
    assert builtin.participation.verification_only == ()
    assert foreign.participation.requested == BOTH
    assert foreign.participation.verification_only == (TWIN,)
    assert foreign.participation.information == builtin.participation.information


@pytest.mark.usefixtures("verifiable")
def test_verification_takes_no_other_case_than_required_or_named_ones() -> None:
    """The static check that the twin requires has no converged values here: it is shown for information."""
    prepared = prepare_plan(Plan(verdicts="verification"))
    assert ids(prepared) == {PRINTED, TWIN, "en50318-2018/ac-simple/static"}
    assert prepared.participation.information == ("en50318-2018/ac-simple/static",)
    # A case that the user names has no limit that counts: the criteria stay informative.
    assert prepare_plan(Plan(cases=(TWIN,), verdicts="both")).participation.verification_only == ()


def test_default_run_without_converged_values_needs_a_limit(state_converged: StateConverged) -> None:
    with pytest.raises(InputError, match="no limit counts"):
        prepare_plan(Plan(verdicts="verification"))
