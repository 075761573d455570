"""Rows and state of the checks of a record: outcomes follow from numbers and thresholds, the state from outcomes."""

import math
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from helpers.graded_wave import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.check_row import MISGIVINGS, Measured
from pantocheck.conformance.documents.authenticity_check import DocumentCheck
from pantocheck.conformance.documents.row_check import REPEATED, check_rows, name_other_rows
from pantocheck.conformance.documents.state_check import check_state
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.check import Measure
from pantocheck.conformance.runs.force_content import FORCE_REMAINDER
from pantocheck.conformance.runs.record_checks import RECORD_CHECKS
from pantocheck.conformance.runs.system import Delivered

Tree = dict[str, Any]
CASES = ["en50318-2002/250", "en50318-2018/ac-simple/275-twin"]
"""One pantograph, and two."""


@pytest.fixture(scope="module", params=CASES)
def graded(request: pytest.FixtureRequest) -> Tree:
    case: Case = next(case for case in select_cases([request.param]) if case.id == request.param)
    return grade_case(case, Delivered(Wave().record(case)), "secondary").model_dump(mode="json")


def change_rows(graded: Tree, change: Callable[[Tree], None]) -> CaseResult:
    """The same result with changed rows; its state and remarks are those that follow from the stated outcomes."""
    content = CaseResult.model_validate(graded).model_dump(mode="json")
    for row in content["record"]["checks"]:
        change(row)
    return CaseResult.model_validate(content)


def list_found(result: CaseResult) -> dict[str, list[str]]:
    """Contradictions of the state, and those of the numbers with the embedded signals."""
    results = SimpleNamespace(cases=[result])
    checks: list[DocumentCheck] = [*check_rows(results), *name_other_rows(results, ())]
    assert name_other_rows(results, {result.id}) == []
    return {
        "state": list(check_state(result)),
        "signals": [line for check in checks if check.outcome == "contradicted" for line in check.details],
        "open": [line for check in checks if check.outcome == "open" for line in check.details],
    }


def test_outcome_is_the_worst_one_beyond_its_threshold() -> None:
    """On a threshold, the condition holds; a number that is not known lies beyond every threshold."""
    above = Measure("ratio", "", {"doubt": 0.5, "contradiction": 1.0})
    outcomes = [above.compare(number).kind for number in (0.5, 0.51, 1.0, 1.01, float("nan"), float("inf"))]
    assert outcomes == ["confirmed", "doubt", "doubt", "contradiction", "contradiction", "contradiction"]
    below = Measure("share", "", {"unchecked": 0.1}, "below")
    assert [below.compare(number).kind for number in (0.1, 0.09, float("nan"))] == [
        "confirmed",
        "unchecked",
        "unchecked",
    ]


def test_rows_of_a_record_hold_and_those_that_need_more_are_named(graded: Tree) -> None:
    found = list_found(CaseResult.model_validate(graded))
    assert (found["state"], found["signals"]) == ([], [])
    others = "motion, support passing, coincidence, roll-off" + (", copy" if graded["id"] == CASES[1] else "")
    assert found["open"] == [f"{graded['id']}: {others}; they need the whole record"]


def test_copy_among_the_embedded_signals_is_found(graded: Tree) -> None:
    """Both pantographs of the wave have the same force in every span; a row that states another force is found."""
    if graded["id"] != CASES[1]:
        return

    def change(row: Tree) -> None:
        if row["check"] == "copy":
            row["basis"] = FORCE_REMAINDER.compare(0.4, "pantograph 1").basis.model_dump(mode="json")

    found = list_found(change_rows(graded, change))
    assert found["state"] == []
    assert any("the force of pantograph 1 is a copy of that of pantograph 2" in line for line in found["signals"])


@pytest.mark.parametrize("check", [check.name for check in RECORD_CHECKS if check.measures])
def test_raised_outcome_number_and_threshold_are_found(graded: Tree, check: str) -> None:
    """Every number once beyond its threshold and once within it, and every threshold twice as wide."""
    row = next(row for row in graded["record"]["checks"] if row["check"] == check)
    if row["basis"]["kind"] != "measured":
        return
    limit = min(row["basis"]["thresholds"].values())
    wide = 2.0 if row["basis"]["side"] == "above" else 0.5
    is_confirmed = row["outcome"] == "confirmed"

    def cross(other: Tree) -> None:
        if other["check"] == check:
            other["basis"]["number"] = limit * (wide if is_confirmed else 1 / wide)

    def widen(other: Tree) -> None:
        if other["check"] == check:
            other["basis"]["thresholds"] = {key: wide * value for key, value in row["basis"]["thresholds"].items()}

    def turn(other: Tree) -> None:
        if other["check"] == check:
            other["outcome"], other["text"] = ("doubt", "late") if is_confirmed else ("confirmed", "")

    def hide(other: Tree) -> None:
        if other["check"] == check:
            other["basis"] = {"kind": "not measured", "cause": "holds"}

    changes = {cross: "follows from its number", widen: "are not those of the installed suite"}
    for change, text in (changes | {turn: "follows from its number", hide: "'holds' stated"}).items():
        assert any(
            f"check '{check}'" in line and text in line for line in list_found(change_rows(graded, change))["state"]
        )


def test_each_number_of_the_embedded_signals_is_compared(graded: Tree) -> None:
    """A tenth of the threshold nearer to it, or a tenth of the number above a threshold from below."""
    named = set()
    for check in REPEATED:

        def move(row: Tree, name: str = check.name) -> None:
            if row["check"] == name and row["basis"]["kind"] == "measured":
                row["basis"]["number"] += 0.1 * max(*row["basis"]["thresholds"].values(), row["basis"]["number"])

        found = list_found(change_rows(graded, move))
        named |= {check.name} if any(f"check '{check.name}'" in line for line in found["signals"]) else set()
    assert named == {check.name for check in REPEATED if check.measures}


@pytest.mark.parametrize(
    ("check", "basis", "text"),
    [
        ("mean force", {"cause": "named by another check"}, "no other check names a missing channel"),
        ("implied force", {"cause": "does not apply"}, "the results show that it applies"),
        ("dynamics", {"measure": "misfit of the motion behind a causal filter"}, "delivered without a filter"),
    ],
)
def test_cause_without_a_reason_is_found(graded: Tree, check: str, basis: Tree, text: str) -> None:
    kind = {"kind": "not measured"} if "cause" in basis else {}

    def change(row: Tree) -> None:
        if row["check"] == check:
            row["basis"] = (kind or row["basis"]) | basis

    found = list_found(change_rows(graded, change))
    assert any(f"check '{check}'" in line and text in line for line in found["state"])


def test_doubtful_record_of_two_pantographs_states_its_worst_part(two_pantograph_case: Case) -> None:
    """A force with 20 % more in the second pantograph: its gain is contradicted, by its own number."""
    record = Wave().record(two_pantograph_case)
    force = record.force.copy()
    force[1] *= 1.2
    rows = grade_case(two_pantograph_case, Delivered(replace(record, force=force)), "secondary").record.checks
    row = next(row for row in rows if row.outcome in MISGIVINGS)
    assert isinstance(row.basis, Measured)
    assert (row.check, row.basis.part, row.outcome) == ("dynamics", "pantograph 2", "contradiction")
    assert row.basis.number == pytest.approx(1 / 6, abs=0.01)


def test_utilisation_is_one_at_the_threshold() -> None:
    """The nearest threshold counts; a number of zero is infinitely far below the lowest one."""
    facts = {"measure": "gain", "unit": "", "thresholds": {"doubt": 2.0, "contradiction": 4.0}}
    for side, number, expected in (
        ("above", 2.0, 1.0), ("above", 4.0, 2.0), ("below", 4.0, 1.0), ("below", 2.0, 2.0), ("below", 0.0, math.inf)
    ):  # fmt: skip
        assert Measured.model_validate(facts | {"side": side, "number": number}).utilisation == expected


# The state of a record follows from the outcomes of its checks; a raised state is found.
@pytest.fixture(scope="module")
def unchecked(case_250: Case) -> dict[str, Any]:
    """Result of a record without contact height, whose dynamics check was not made."""
    record = Wave().record(case_250)
    bare = grade_case(case_250, Delivered(replace(record, contact_height=None)), "secondary")
    return bare.model_dump(mode="json")


def set_row(outcome: str, text: str) -> Callable[[dict[str, Any]], None]:
    def change(case: dict[str, Any]) -> None:
        row = next(row for row in case["record"]["checks"] if row["check"] == "dynamics")
        row["outcome"], row["text"] = outcome, text

    return change


def raise_state(case: dict[str, Any]) -> None:
    case["record"]["state"] = "consistent"
    case["record"]["reason"] = "every consistency check that applies confirms the record"


def raise_all(case: dict[str, Any]) -> None:
    """State, reason and rows agree; the notes still name the checks that were not made."""
    raise_state(case)
    for row in case["record"]["checks"]:
        row["outcome"], row["text"] = "confirmed", ""


def drop_row(case: dict[str, Any]) -> None:
    del case["record"]["checks"][0]


def drop_rows(case: dict[str, Any]) -> None:
    raise_state(case)
    case["record"]["checks"] = []


CHANGES: dict[str, tuple[Callable[[dict[str, Any]], None], str]] = {
    "state raised": (raise_state, "'unconfirmed' follows from its checks"),
    "state and rows raised": (raise_all, "a note says that it was not made, its row does not"),
    "row left out": (drop_row, "the checks of the record are motion"),
    "rows left out": (drop_rows, "but no check of it"),
    "confirmed with a text": (set_row("confirmed", "The head moves."), "does not fit its text"),
    "doubt without a warning": (set_row("doubt", "The head is late."), "its text is missing among the warnings"),
    "contradiction in the middle": (set_row("contradiction", "gain"), "stated behind a contradiction"),
    "not reached without a cause": (set_row("not reached", ""), "stated without a contradiction"),
}


def test_rows_of_a_graded_record_hold(unchecked: dict[str, Any]) -> None:
    case = CaseResult.model_validate(unchecked)
    assert case.record is not None
    assert case.record.state == "unconfirmed"
    assert list(check_state(case)) == []


@pytest.mark.parametrize("name", CHANGES)
def test_raised_state_is_found(unchecked: dict[str, Any], name: str) -> None:
    change, text = CHANGES[name]
    content = CaseResult.model_validate(unchecked).model_dump(mode="json")
    change(content)
    found = list(check_state(CaseResult.model_validate(content)))
    assert any(text in line for line in found), found
