"""All problems of a file are reported at once, also contradictions between keys while other keys are invalid."""

from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from helpers.case_fixtures import EditedCase
from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.core.input_error import MOST_MESSAGES, InputError
from pantocheck.conformance.core.sourced_table import InputTable, Problems, cross_check, validation_problem
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.line_file import LineFile

IMPOSSIBLE_LINE: dict[str, Any] = {
    "geometry.span_m": 600.0,  # out of range
    "contact_wire.tension_N": None,  # the key in another unit explains the missing key
    "contact_wire.tension_kN": 20,
    "contact_wire.mass_kg_m": -1.35,
    "messenger_wire.number": 2,  # contradicts contact_wire.number
    "droppers.x_m": [5.0, 10.5, 10.5],
    "droppers.presag_m": [0.0, 0.01],
    "droppers.axial_stiffness_EA_N": 2e5,
    "steady_arm.static_share": "levl",
    "messenger_support": None,
    "damping.trust": "certain",
}


def find_keys(path: Path) -> list[str]:
    """Keys of all problems of the line file beside a case."""
    with pytest.raises(InputError) as caught:
        read_model(path.with_name("line.toml"), LineFile, "line")
    return [problem.where.rpartition(", key ")[2] for problem in caught.value.problems]


def test_impossible_line_is_refused_with_all_reasons(edited_case: EditedCase) -> None:
    """An equal dropper of every span is named once; a value that is invalid does not count as its default."""
    assert find_keys(edited_case("line.toml", IMPOSSIBLE_LINE)) == [
        "contact_wire.tension_kN", "geometry.span_m", "contact_wire.mass_kg_m", "droppers.x_m[3]", "droppers.presag_m",
        "droppers.stiffness_N_m", "steady_arm.static_share", "messenger_support", "damping.trust",
        "messenger_wire.number",
    ]  # fmt: skip
    assert find_keys(edited_case("line.toml", {"droppers.x_m.8": 65.0})) == ["droppers.x_m[9]"]
    # With the default, the droppers would have no stiffness, and the messenger wire one wire.
    changes = {"droppers.stiffness_N_m": "stiff", "messenger_wire.number": 3}
    assert find_keys(edited_case("line.toml", changes)) == ["messenger_wire.number", "droppers.stiffness_N_m"]


def test_text_of_the_error_has_one_message_per_problem(edited_case: EditedCase) -> None:
    path = edited_case("line.toml", {"contact_wire.mass_kg_m": 500, "droppers.x_m.8": 65.0})
    with pytest.raises(InputError) as caught:
        load_case(path)
    assert str(caught.value) == (
        "line 'line.toml', key contact_wire.mass_kg_m: 500 must be at most 10.0.\n"
        "  It is: mass per length of one wire [kg/m]. Allowed: a number at least 0.02, at most 10.\n"
        "line 'line.toml', key droppers.x_m[9]: 65 m is not inside the span of 60 m.\n"
        "  Give positions between 0 and 60 m, from the start of the span."
    )


def test_rules_of_listed_spans_run_beside_invalid_keys(edited_case: EditedCase) -> None:
    path = edited_case("line.toml", {"contact_wire.mass_kg_m": 500})
    spans = [{"length_m": 60.0}, {"length_m": 40.0, "droppers": "short"}, {"length_m": 54.0, "droppers": "shrt"}]
    geometry = {"span_list": spans, "schedule": {"short": {"x_m": [5.0, 45.0], "presag_m": [0.0]}}}
    edit_toml(path.with_name("line.toml"), {"geometry": geometry})
    assert find_keys(path) == [
        *("geometry.schedule.short.presag_m", "geometry.encumbrance_m", "geometry.span_list[3].droppers"),
        "contact_wire.mass_kg_m",
    ]


def test_long_lists_of_problems_are_counted(edited_case: EditedCase) -> None:
    path = edited_case("line.toml", {"droppers.x_m": [-1.0] * 70})
    with pytest.raises(InputError) as caught:
        load_case(path)
    lines = str(caught.value).splitlines()
    assert len(lines) == 2 * MOST_MESSAGES + 1
    # Also reported: 70 positions against 9 pre-sags cannot be compared, because no position is valid.
    assert lines[-1] == "... and 20 more. Correct these first."


class Pair(InputTable):
    """Table with two rules; the second one needs that the first one holds."""

    divisor: float
    limit: float = 1.0

    @cross_check
    def _check_divisor(self) -> Problems:
        if self.divisor == 0:
            yield validation_problem("divisor", "0", "Give another number.")

    @cross_check
    def _check_quotient(self) -> Problems:
        if 1 / self.divisor > self.limit:
            yield validation_problem("limit", "exceeded", "Raise it.")


class BrokenPair(Pair):
    """Table with a defect in a rule."""

    @cross_check
    def _check_divisor(self) -> Problems:
        yield from ()


def test_rule_that_cannot_run_after_another_problem_is_left_out_unless_it_is_defective() -> None:
    with pytest.raises(ValidationError) as caught:
        Pair.model_validate({"divisor": 0.0})
    assert [error["ctx"]["key"] for error in caught.value.errors()] == ["divisor"]
    assert Pair.model_validate({"divisor": 2.0}).divisor == 2.0
    with pytest.raises(ZeroDivisionError):
        BrokenPair.model_validate({"divisor": 0.0})
