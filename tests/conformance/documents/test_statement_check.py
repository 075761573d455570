"""Statements that other parts determine: reasons, places and dates are found where they do not follow."""

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from pydantic import ValidationError

from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.documents.document_reading import ResultsFile
from pantocheck.conformance.documents.statement_check import FAST_CLOCK, check_date
from pantocheck.conformance.documents.verification import verify_certificate
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.results_building import TIME_FORMAT
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.results.results_format import Results

Tree = dict[str, Any]
NOTE = "Verified by an independent assessor."


def case_of(tree: Tree) -> Tree:
    case: Tree = tree["cases"][0]
    return case


def failing(tree: Tree) -> Tree:
    return next(row for row in case_of(tree)["criteria"] if row["verdict"] == "fail")


CHANGES: dict[str, tuple[Callable[[Tree], object], str]] = {
    "case twice": (lambda t: t["cases"].append(case_of(t)), "the case en50318-2002/250 occurs 2 times"),
    "note": (lambda t: case_of(t)["notes"].append(NOTE), "is not in the library"),
    "future": (lambda t: t.update(started="2999-01-01T00:00:00Z"), "in the future: the clock of this machine shows"),
    "date": (lambda t: t.update(started="yesterday"), "'yesterday' is not a time such as"),
    "reason of a case": (lambda t: case_of(t).update(reason="passed"), "does not follow from the checks of the record"),
    "demand": (lambda t: case_of(t)["record"].update(demanded=False), "which only a profile can state"),
    "reason": (lambda t: failing(t).update(reason=None), "reason 'None' stated, '"),
    "place": (lambda t: failing(t).update(where={"record": "A"}), "which only a comparison has"),
    "uncertain limit": (lambda t: failing(t).update(limit_uncertainty=None), "which only a comparison has"),
    "change along the line": (lambda t: failing(t).update(spread=7.0), "change along the line 7 stated"),
    "verification twice": (
        lambda t: case_of(t)["verification"]["criteria"].append(case_of(t)["verification"]["criteria"][-1]),
        "a criterion of the verification occurs twice",
    ),
    "criterion twice": (
        lambda t: case_of(t)["criteria"].append(case_of(t)["criteria"][-1]), "a criterion of the case occurs twice"
    ),
    "supports": (
        lambda t: case_of(t)["signals"]["line_supports_m"].pop(), "the supports of the embedded signals differ"
    ),
    "second formulation": (
        lambda t: case_of(t)["verification"].update(confirmed_by="a line"), "verification: omitted quantities, second"
    ),
    "source of verification": (
        lambda t: case_of(t)["verification"]["criteria"][0].update(source="a line"), "trust or source of the limit",
    ),
    "edition": (lambda t: case_of(t).update(edition=None), "edition: EN 50318:2002 in the library, nothing"),
    "weakened limit": (lambda t: case_of(t)["limit_changes"].append("A"), "but the limits are those of the library"),
    "digest of limits": (lambda t: case_of(t).update(limits_digest="A"), "digest of the limits: another one"),
    "conditions": (lambda t: case_of(t).update(conditions=[]), "the conditions of the values differ"),
    "height": (
        lambda t: case_of(t)["signals"]["pantographs"]["1"].update(contact_height_m=None),
        "confirmed without a contact height",
    ),
}  # fmt: skip


def list_contradictions(tree: Tree) -> tuple[str, ...]:
    results = Results.model_validate(tree)
    return verify_certificate(ResultsFile("results.json", results.to_json(), results)).discrepancies


class OffsetWave(Wave):
    """The wave with a zero error of its uplift sensors, whose uplift is refused and not embedded."""

    def record(self, case: Case) -> Record:
        record = super().record(case)
        assert record.support_uplift is not None
        return replace(record, support_uplift=record.support_uplift + 0.02)


def test_genuine_results_have_no_contradiction(wave_results: Results, case_250: Case) -> None:
    assert list_contradictions(wave_results.to_dict()) == ()
    faulty = run_cases([case_250], OffsetWave())
    assert faulty.cases[0].signals is not None
    assert not faulty.cases[0].signals.uplift
    assert list_contradictions(faulty.to_dict()) == ()


def test_note_of_a_modified_copy_is_its_own(wave_results: Results) -> None:
    tree = wave_results.to_dict()
    case_of(tree).update(library="modified", notes=[*case_of(tree)["notes"], NOTE])
    assert not any(NOTE in line for line in list_contradictions(tree))


@pytest.mark.parametrize("name", CHANGES)
def test_statement_that_does_not_follow_is_found(name: str, wave_results: Results) -> None:
    change, text = CHANGES[name]
    tree = wave_results.to_dict()
    change(tree)
    found = list_contradictions(tree)
    assert any(text in line for line in found), found


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda row: row["draws"].pop(), "lists of 999 and 1000 numbers, expected one length"),
        (lambda row: row.update(limit_uncertainty=-1.0), "greater than or equal to 0"),
        (lambda row: row["components"].update(start=-1.0), "greater than or equal to 0"),
    ],
)
def test_joint_sample_or_width_without_meaning_is_refused(
    change: Callable[[Tree], object], text: str, wave_results: Results
) -> None:
    tree = wave_results.to_dict()
    change(case_of(tree)["criteria"][0])
    with pytest.raises(ValidationError, match=text):
        Results.model_validate(tree)


def test_date_may_be_a_day_ahead_of_the_clock() -> None:
    """A minute before and after the accepted difference: the test needs less time than that."""
    limit = datetime.now(UTC) + FAST_CLOCK
    for minutes, count in ((-1, 0), (1, 1)):
        assert len([*check_date((limit + timedelta(minutes=minutes)).strftime(TIME_FORMAT))]) == count
    assert list(check_date(None)) == []
