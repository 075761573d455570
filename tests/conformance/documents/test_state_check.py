"""The state of a record follows from the outcomes of its checks; a raised state is found."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from helpers.graded_wave import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.documents.state_check import check_state
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.system import Delivered


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
