"""Bad input: each mistake gives one message that names file, key, what was found and what to do."""

import pytest

from pantocheck.conformance.cases.library import load_case, read_limits
from pantocheck.conformance.input_files.input_error import InputError

LINE, PANTOGRAPH, CASE = "line.toml", "pantograph.toml", "250.toml"


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        (
            LINE,
            "tension_N = 20e3",
            "tension_kN = 20",
            "reference line 'line.toml', key contact_wire.tension_kN: unknown key.\n"
            "  Forces are given in newtons: did you mean tension_N = 20000.0 ?",
        ),
        (
            LINE,
            "mass_kg_m = 1.35",
            "mass_g_m = 1350.0",
            "reference line 'line.toml', key contact_wire.mass_g_m: unknown key.\n"
            "  Masses per length are given in kilograms per metre: did you mean mass_kg_m = 1.35 ?",
        ),
        (
            LINE,
            "x_m = [5.0, ",
            "x_mm = [5000.0, ",
            "reference line 'line.toml', key droppers.x_mm: unknown key.\n"
            "  Lengths are given in metres: did you mean x_m = [5.0, 0.0105, ",
        ),
        (
            LINE,
            "tension_N = 20e3",
            "tenson_N = 20e3",
            "reference line 'line.toml', key contact_wire.tenson_N: unknown key.\n  Did you mean tension_N ?",
        ),
        (
            LINE,
            "tension_N = 20e3",
            "",
            "reference line 'line.toml', key contact_wire.tension_N: missing.\n  It is: axial tension of one wire [N].",
        ),
        (
            LINE,
            "[messenger_support]",
            "[messenger_suport]",
            "reference line 'line.toml', key messenger_suport: unknown key.\n  Did you mean messenger_support ?",
        ),
        (
            PANTOGRAPH,
            "masses_kg = [15.0, 7.2]",
            "masses_kg = [15.0, -7.2]",
            "pantograph 'pantograph.toml', key chain.masses_kg[2]: -7.2 must be greater than 0.0.",
        ),
        (
            PANTOGRAPH,
            "damping_N_s_m = [90.0, 10.0]",
            "damping_N_s_m = [90.0]",
            "pantograph 'pantograph.toml', key chain.damping_N_s_m: 1 values for 2 masses.",
        ),
        (
            PANTOGRAPH,
            'uplift_force_on = "frame"',
            'uplift_force_on = "knee"',
            "pantograph 'pantograph.toml', key chain.uplift_force_on: no mass has the name 'knee'.\n"
            "  The names are: frame, head.",
        ),
        (
            LINE,
            "mass_kg_m = 1.35",
            "mass_kg_m = nan",
            "reference line 'line.toml', key contact_wire.mass_kg_m: nan is not a finite number.",
        ),
        (
            LINE,
            "mass_kg_m = 1.35",
            "mass_kg_m = -inf",
            "reference line 'line.toml', key contact_wire.mass_kg_m: -inf is not a finite number.",
        ),
        (
            LINE,
            "mass_kg_m = 1.35",
            'mass_kg_m = "1.35"',
            "reference line 'line.toml', key contact_wire.mass_kg_m: found '1.35', expected a number.",
        ),
        (
            LINE,
            "49.5, 55.0]",
            "49.5, 65.0]",
            "reference line 'line.toml', key droppers.x_m[9]: the dropper at 65 m lies outside its span of 60 m.",
        ),
        (
            LINE,
            "10.5, 17.0",
            "17.0, 10.5",
            "reference line 'line.toml', key droppers.x_m[3]: 10.5 m does not follow 17 m.",
        ),
        (
            LINE,
            "presag_m = [0.0, ",
            "presag_m = [",
            "reference line 'line.toml', key droppers.presag_m: 8 values for 9 droppers.",
        ),
        (
            LINE,
            "mass_kg = 0.0",
            "mass_kg = 0.0\naxial_stiffness_EA_N = 2e5",
            "reference line 'line.toml', key droppers.stiffness_N_m: the stiffness of a dropper must be given once.",
        ),
        (
            LINE,
            "spans = 10",
            "spans = 10000000",
            "reference line 'line.toml', key geometry.spans: 10000000 must be at most 1000.",
        ),
        (
            LINE,
            "span_m = 60.0",
            "span_m = 60000.0",
            "reference line 'line.toml', key geometry.span_m: 60000 must be at most 120.0.",
        ),
        (
            LINE,
            'provisional = ["static_share"]',
            'provisional = ["statics"]',
            "reference line 'line.toml', key steady_arm.provisional: 'statics' is not a key of this table.",
        ),
        (
            CASE,
            'trust = "secondary"',
            'trust = "certain"',
            "case '250.toml', key trust: found 'certain', expected 'primary', 'secondary' or 'provisional'.",
        ),
        (
            CASE,
            "evaluated_spans = [5, 6]",
            "evaluated_spans = [5, 7, 6]",
            "case '250.toml', key evaluated_spans: [5, 7, 6] are not neighbouring spans.",
        ),
        (
            CASE,
            "evaluated_spans = [5, 6]",
            "evaluated_spans = [5, 11]",
            "case '250.toml', key evaluated_spans: span 11 does not exist.\n  The line has 10 spans.",
        ),
        (
            CASE,
            "evaluated_spans = [5, 6]",
            "evaluated_spans = [1, 6]",
            "case '250.toml', key start_m: the last pantograph starts at 60 m, not before the evaluated spans",
        ),
        (
            CASE,
            "order = 6",
            "order = 5",
            "case '250.toml', key filter.order: 5 is odd.",
        ),
        (
            CASE,
            "speed_km_h = 250.0",
            "speed_m_s = 69.4",
            "case '250.toml', key speed_m_s: unknown key.\n"
            "  Speeds are given in kilometres per hour: did you mean speed_km_h = 249.84 ?",
        ),
        (
            CASE,
            'quantity = "std_force_N"',
            'quantity = "std_force"',
            "case '250.toml', key limit[2].quantity: there is no quantity 'std_force'.\n  Did you mean std_force_N",
        ),
        (
            CASE,
            'quantity = "std_force_N"\npantograph = 1',
            'quantity = "std_force_N"\npantograph = 2',
            "case '250.toml', key limit[2].pantograph: there is no pantograph 2.",
        ),
        (
            CASE,
            "lower = 26.0",
            "lower = 36.0",
            "case '250.toml', key limit[2].lower: 36 is above upper = 31.",
        ),
        (
            CASE,
            'line = "line.toml"',
            'line = "lines.toml"',
            "case '250.toml', key line: there is no file 'lines.toml'.",
        ),
        (
            CASE,
            "order = 6\n",
            "order = 6 = 7\n",
            "case '250.toml': is not valid TOML: Expected newline or end of document after a statement (at line ",
        ),
        (
            CASE,
            "order = 6\n",
            f"order = {'9' * 5000}\n",
            "case '250.toml': holds a number or a nesting that is too long to read.",
        ),
    ],
)
def test_one_mistake_one_message(own_case, file, old, new, message):
    with pytest.raises(InputError) as caught:
        load_case(own_case(file, old, new))
    assert str(caught.value).startswith(message)
    assert caught.value.hint


def test_malformed_toml_names_line_and_column(own_case):
    path = own_case(CASE, 'title = "EN', "title = EN")
    with pytest.raises(InputError, match=r"at line 3, column 9"):
        load_case(path)


def test_file_that_is_not_text(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b'id = "x"\n\xff\xfe')
    with pytest.raises(InputError, match="byte 10 is not UTF-8 text"):
        load_case(path)


def test_deep_nesting_does_not_crash(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text("a = " + "[" * 100_000)
    with pytest.raises(InputError, match="too long to read"):
        load_case(path)


def test_absent_file(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        load_case(tmp_path / "nothing.toml")


def test_limit_for_a_line_quantity_has_no_pantograph(tmp_path):
    path = tmp_path / "limits.toml"
    path.write_text(
        '[[limit]]\nquantity = "max_uplift_at_support_mm"\npantograph = 1\nupper = 60.0\n'
        'trust = "primary"\nsource = "own"\n'
    )
    with pytest.raises(InputError, match=r"key limit\[1\]\.pantograph: max_uplift_at_support_mm belongs to the line"):
        read_limits(path)
