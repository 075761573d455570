"""Validation messages: all problems of a file at once, each with file, key, content found and next step."""

import math
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from helpers.case_fixtures import EditedCase
from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.library import load_case, read_limits
from pantocheck.conformance.core.input_error import MOST_MESSAGES, InputError
from pantocheck.conformance.core.key_paths import parse_key
from pantocheck.conformance.core.sourced_table import InputTable, Problems, cross_check, validation_problem
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.core.validation_messages import append_table_number
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile

LINE, PANTOGRAPH, CASE = "line.toml", "pantograph.toml", "250.toml"


@pytest.mark.parametrize(
    ("file", "changes", "message"),
    [
        (LINE, {"contact_wire.tension_N": None, "contact_wire.tension_kN": 20},
         "contact_wire.tension_kN: unknown key.\n  Forces are given in newtons: did you mean tension_N = 20000.0 ?"),
        (LINE, {"contact_wire.mass_kg_m": None, "contact_wire.mass_g_m": 1350.0},
         "contact_wire.mass_g_m: unknown key.\n"
         "  Masses per length are given in kilograms per metre: did you mean mass_kg_m = 1.35 ?"),
        (LINE, {"droppers.x_m": None, "droppers.x_mm": [5000.0, 10.5]},
         "droppers.x_mm: unknown key.\n  Lengths are given in metres: did you mean x_m = [5.0, 0.0105] ?"),
        (LINE, {"contact_wire.tension_N": None, "contact_wire.tenson_N": 20000.0},
         "contact_wire.tenson_N: unknown key.\n  Did you mean tension_N ?"),
        (LINE, {"contact_wire.tension_N": None},
         "contact_wire.tension_N: missing.\n  It is: axial tension of one wire [N]."),
        (LINE, {"messenger_support": None, "messenger_suport": {"stiffness_N_m": 50000.0}},
         "messenger_suport: unknown key.\n  Did you mean messenger_support ?"),
        (PANTOGRAPH, {"chain.masses_kg": [15.0, -7.2]}, "chain.masses_kg[2]: -7.2 must be greater than 0.0."),
        (PANTOGRAPH, {"chain.damping_N_s_m": [90.0]}, "chain.damping_N_s_m: 1 values for 2 masses."),
        (PANTOGRAPH, {"chain.uplift_force_on": "knee"},
         "chain.uplift_force_on: there is no mass 'knee'.\n  Known names are frame, head."),
        (LINE, {"contact_wire.mass_kg_m": math.nan}, "contact_wire.mass_kg_m: nan is not a finite number."),
        (LINE, {"contact_wire.mass_kg_m": -math.inf}, "contact_wire.mass_kg_m: -inf is not a finite number."),
        (LINE, {"contact_wire.mass_kg_m": "1.35"}, "contact_wire.mass_kg_m: found '1.35', expected a number."),
        (LINE, {"point_mass": [{"x_m": 30.0, "mass_kg": 5.0}]},
         'point_mass[1].wire: missing.\n  It is: wire that carries the mass. Allowed: "contact_wire" or'),
        (LINE, {"droppers.x_m.8": 65.0}, "droppers.x_m[9]: 65 m is not inside the span of 60 m."),
        (LINE, {"droppers.x_m.1": 17.0, "droppers.x_m.2": 10.5},
         "droppers.x_m[3]: 10.5 m is not greater than the preceding 17 m."),
        (LINE, {"droppers.presag_m": [0.0] * 8}, "droppers.presag_m: 8 values for 9 droppers."),
        (LINE, {"droppers.axial_stiffness_EA_N": 200000.0},
         "droppers.stiffness_N_m: the stiffness of the droppers is given twice."),
        (LINE, {"geometry.spans": 10_000_000}, "geometry.spans: 10000000 must be at most 1000."),
        (LINE, {"geometry.span_m": 60000.0}, "geometry.span_m: 60000 must be at most 120.0."),
        (LINE, {"steady_arm.provisional": ["statics"]},
         "steady_arm.provisional: 'statics' is not a key of this table."),
        (CASE, {"trust": "certain"}, "trust: found 'certain', expected 'primary', 'secondary' or 'provisional'."),
        (CASE, {"evaluated_spans": [5, 7, 6]}, "evaluated_spans: [5, 7, 6] are not neighbouring spans."),
        (CASE, {"evaluated_spans": [5, 11]}, "evaluated_spans: span 11 does not exist.\n  The line has 10 spans."),
        (CASE, {"evaluated_spans": [1, 6]},
         "start_m: the last pantograph starts at 60 m, but the analysis section begins"),
        (CASE, {"filter.order": 5}, "filter.order: 5 is odd."),
        (CASE, {"speed_km_h": None, "speed_m_s": 69.4},
         "speed_m_s: unknown key.\n  Speeds are given in kilometres per hour: did you mean speed_km_h = 249.84 ?"),
        (CASE, {"limit.1.quantity": "std_force"},
         "limit[2].quantity: there is no quantity 'std_force'.\n  Did you mean std_force_N"),
        (CASE, {"limit.1.pantograph": 2}, "limit[2].pantograph: there is no pantograph 2."),
        (CASE, {"limit.1.lower": 36.0}, "limit[2].lower: 36 is above upper = 31."),
        (CASE, {"line": "lines.toml"}, "line: there is no file 'lines.toml'."),
    ],
)  # fmt: skip
def test_message_names_file_key_and_next_step(
    edited_case: EditedCase, file: str, changes: dict[str, Any], message: str
) -> None:
    path = edited_case(file, changes)
    with pytest.raises(InputError) as caught:
        load_case(path)
    kind = {LINE: "line", PANTOGRAPH: "pantograph", CASE: "case"}[file]
    assert str(caught.value).startswith(f"{kind} '{file}', key {message}")
    assert caught.value.hint


def test_number_of_a_table_follows_its_key() -> None:
    tree = {"support": [{"number": 2}, {"number": 5}]}
    assert (parse_key("support[1].x_m"), parse_key("support[0].x_m")) == (("support", 0, "x_m"), None)
    for item, number in ((1, 2), (2, 5)):
        assert append_table_number(f"support[{item}].x_m", tree) == f"support[{item}].x_m (number {number})"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("order = 6", "order = 6 = 7",
         "is not valid TOML: Expected newline or end of document after a statement (at line "),
        ('title = "EN', "title = EN", "is not valid TOML: Invalid value (at line 3, column 9)"),
        ("order = 6", f"order = {'9' * 5000}", "holds a number that is too long, or tables nested too deeply."),
        ("order = 6", "order = " + "[" * 100_000, "holds a number that is too long, or tables nested too deeply."),
    ],
)  # fmt: skip
def test_text_that_is_not_toml_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    text = (library_folder() / "en50318-2002" / CASE).read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / CASE
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_case(path)
    assert str(caught.value).startswith(f"case '250.toml': {message}")
    assert caught.value.hint


def test_bytes_missing_files_and_limits_of_the_line_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_bytes(b'id = "x"\n\xff\xfe')
    with pytest.raises(InputError, match="byte 10 is not UTF-8 text"):
        load_case(path)
    with pytest.raises(InputError, match="No such file"):
        load_case(tmp_path / "nothing.toml")
    path = tmp_path / "limits.toml"
    path.write_text(
        '[[limit]]\nquantity = "max_uplift_at_support_mm"\npantograph = 1\nupper = 60.0\n'
        'trust = "primary"\nsource = "own"\n'
    )
    with pytest.raises(
        InputError, match=r"key limit\[1\]\.pantograph: max_uplift_at_support_mm is not a quantity of a pantograph"
    ):
        read_limits(path)


# All problems of a file are reported at once, also contradictions between keys while other keys are invalid.
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
