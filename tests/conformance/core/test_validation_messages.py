"""Validation messages: each mistake gives one message with file, key, content found and next step."""

import math
from pathlib import Path
from typing import Any

import pytest

from helpers.case_fixtures import EditedCase
from pantocheck.conformance.cases.library import load_case, read_limits
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.key_paths import parse_key
from pantocheck.conformance.core.validation_messages import append_table_number
from pantocheck.conformance.line.library_folder import library_folder

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
