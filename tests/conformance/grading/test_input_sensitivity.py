"""Sentences on the resolving power, and conditions of the values, in the result of a case."""

import datetime
from typing import Any

import pytest

from helpers.short_cases import change_case
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_studies import (
    ConditionsFile,
    ResolvingPowerFile,
    find_resolving_power,
    read_study,
)
from pantocheck.conformance.documents.library_check import compare_with_case
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.input_sensitivity import (
    NAMED_INPUTS,
    describe_power,
    describe_studies,
    format_ceiling,
    list_conditions,
)
from pantocheck.conformance.grading.reading_grades import list_reading_remarks
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.runs.resolution import read_effects
from verification.speed.passage_lines import QUANTITIES

HEAD = {"name": "mass of the head", "group": "pantograph", "unit": "%"}
SPRING = {"name": "spring of the base", "group": "pantograph", "unit": "%"}


def state_power(*rows: dict[str, Any]) -> ResolvingPowerFile:
    """File with given rows."""
    head = {"schema": "pantocheck.resolving-power/1", "case": "a", "case_digest": "d", "limits_digest": "l"}
    head |= {"date": datetime.date(2026, 1, 2), "command": "c", "rule": "simple"}
    return ResolvingPowerFile.model_validate({**head, "processor_s": 1.0, "input": rows})


def test_sentences_state_the_noticed_and_the_missed_errors() -> None:
    bounds = {"up": {"passed": 11.0, "noticed": 11.21}, "down": {"passed": 4.0, "noticed": 4.25}}
    alone = {"up_criteria": {"passed": 90.0}, "down_criteria": {"passed": 50.0, "noticed": 52.0}}
    missed = {"up": {"passed": 100.0}, "down": {"passed": 90.0}}
    noticed, rest = describe_power(state_power(HEAD | bounds | alone, SPRING | missed))
    how = "computed on 2026-01-02 with the reference simulator, one wrong input at a time, decision rule simple"
    assert noticed == (
        f"Resolving power ({how}): both verdicts together notice mass of the head wrong by −4.3 % or +12 %. "
        "The EN 50318 criteria alone notice mass of the head wrong by −52 %."
    )
    assert rest == "Not noticed up to the largest error that was tried: spring of the base (−90 to +100 %)."


def test_input_that_one_direction_reveals_is_not_called_missed() -> None:
    (sentence,) = describe_power(state_power(HEAD | {"up": {"passed": 1.0, "noticed": 2.0}, "down": {"passed": 90.0}}))
    assert sentence.endswith("both verdicts together notice mass of the head wrong by +2 %.")
    assert list(describe_power(state_power(HEAD | {"not_applicable": "zero"}))) == []


@pytest.mark.parametrize(
    ("error", "text"), [(2.25, "2.3"), (2.2, "2.2"), (0.1875, "0.19"), (112.0, "120"), (18.0, "18")]
)
def test_noticed_error_is_never_rounded_down(error: float, text: str) -> None:
    assert format_ceiling(error) == text
    assert float(text) >= error


def test_studies_of_the_library_case_and_of_changed_ones(case_250: Case) -> None:
    """Other inputs leave out both studies; other limits leave out the resolving power alone."""
    assert set(NAMED_INPUTS) <= {row.name for row in find_resolving_power(case_250.id).input}
    own = describe_studies(case_250)
    assert own[0].startswith("Resolving power (computed on ")
    assert own[1].startswith("Not noticed up to")
    assert len(list_conditions(case_250)) == 11
    unlimited = case_250.without_limits()
    (other,) = describe_studies(unlimited)
    assert "belongs to another version of this case: to other inputs or limits" in other
    assert list_conditions(unlimited) == list_conditions(case_250)
    changed = change_case(case_250, speed_km_h=260.0)
    assert [text.split(" that the library")[0] for text in describe_studies(changed)] == [
        "The conditions of the values",
        "The resolving power",
    ]
    assert list_conditions(changed) == []
    assert describe_studies(change_case(case_250, id="own/case")) == []


def test_certificate_with_other_sentences_differs_from_the_library(case_250: Case) -> None:
    result = grade_case(case_250, Wave().run(case_250), "secondary")
    assert list(compare_with_case(case_250, result)) == []
    limited = result.model_copy(update={"input_studies": describe_studies(case_250.without_limits())})
    assert list(compare_with_case(case_250, limited)) == []
    bettered = result.model_copy(update={"input_studies": ["Every error is noticed."]})
    assert list(compare_with_case(case_250, bettered)) == [
        "the sentences on errors of the inputs differ from those of the library"
    ]
    fewer = result.model_copy(update={"conditions": result.conditions[1:]})
    assert list(compare_with_case(case_250, fewer)) == ["the conditions of the values differ from those of the library"]


def test_model_uncertainty_of_the_contact_is_the_largest_stored_change() -> None:
    """Rounded up to two digits, so that no stored change exceeds it, and by less than a tenth."""
    [effect] = [effect for effect in read_effects() if effect.along_track is None]
    largest: dict[str, float] = {}
    for path in (library_folder() / "conditions").rglob("*.toml"):
        for condition in read_study(path, ConditionsFile).condition:
            for row in condition.change if condition.group == "contact" else ():
                largest[row.quantity] = max(largest.get(row.quantity, 0.0), abs(row.change_pct))
    assert effect.relative_pct.keys() == set(QUANTITIES)
    for quantity, size in effect.relative_pct.items():
        assert largest[quantity] <= size <= 1.1 * largest[quantity], quantity


def test_value_that_another_contact_moves_over_a_limit_is_marked(case_250: Case) -> None:
    """26.5 N is 2 % above the lower limit of 26 N; twice the spring takes 4.3 % of it, a constraint 9 % of 29.5 N."""
    result = grade_case(case_250, Wave().run(case_250), "secondary")
    [std] = [row for row in result.criteria if row.quantity == "std_force_N"]
    near = std.model_copy(update={"value": 26.5})
    remarks = list_reading_remarks(near, [], result.conditions)
    assert any(
        text.startswith(
            "with contact stiffness +100 %, an effect computed with the reference simulator, the value is 25."
        )
        for text in remarks
    )
    assert all(text.endswith("outside the limits") for text in remarks)
    assert list_reading_remarks(near.model_copy(update={"value": 29.5}), [], result.conditions) == []
    others = [row for row in result.conditions if not row.is_contact]
    assert list_reading_remarks(near, [], others) == []
