"""Import of lines: units, positions and empty cells; every problem of all files is named with file, row and column."""

import tomllib
from pathlib import Path

import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from helpers.line_table_files import change_cell, export_tables
from helpers.static_records import LINE_PATH, read_unequal_line
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.line_columns import DROPPER_COLUMNS, SUPPORT_COLUMNS
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line

SHORT_BASE = """
title = "base"
[geometry]
span_m = 60.0
spans = 3
encumbrance_m = 1.2
stagger_contact_wire_m = 0.2
[contact_wire]
tension_N = 20e3
mass_kg_m = 1.35
[messenger_wire]
tension_N = 16e3
mass_kg_m = 1.07
[droppers]
x_m = [10.0, 30.0, 40.0]
stiffness_N_m = 1e5
[steady_arm]
static_share = "level"
length_m = 1.2
[messenger_support]
stiffness_N_m = 5e5
[damping]
"""


@pytest.fixture
def base(tmp_path: Path) -> Path:
    (tmp_path / "base.toml").write_text(SHORT_BASE)
    return tmp_path / "base.toml"


def write(folder: Path, name: str, text: str) -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def read_problems(base: Path, supports: Path, droppers: Path | None) -> dict[str, str]:
    """Content found, by place, of all problems of an import."""
    with pytest.raises(InputError) as caught:
        import_line(base, supports, droppers)
    assert all(problem.hint for problem in caught.value.problems)
    return {problem.where: problem.found for problem in caught.value.problems}


@pytest.fixture
def tables(tmp_path: Path) -> tuple[Path, Path]:
    """Tables of the line of the mass-drop tests, six spans."""
    return export_tables(tmp_path, read_unequal_line())


def test_positions_in_chainage_give_exact_span_lengths(base: Path) -> None:
    """Differences of decimal numbers: 100.1845 km - 100.126 km is 58.5 m and nothing else."""
    text = "name;x_km;stagger_contact_wire_mm\nA1;100;0\nM1;100,063;-200\nM2;100,126;250\nM3;100,1845;\nA2;100,2475;0\n"
    tree = import_line(base, write(base.parent, "s.csv", text), None)
    assert [span["length_m"] for span in tree["geometry"]["span_list"]] == [63.0, 63.0, 58.5, 63.0]
    line = LineFile.model_validate(tree)
    assert [limit.contact_wire_stagger for limit in line.layout.limits] == [0.0, -0.2, 0.25, -0.2, 0.0]


def test_positions_may_decrease_in_running_order(base: Path) -> None:
    text = "number,x_km\n0,7.2475\n1,7.1845\n2,7.126\n3,7.063\n"
    tree = import_line(base, write(base.parent, "s.csv", text), None)
    assert [span["length_m"] for span in tree["geometry"]["span_list"]] == [63.0, 58.5, 63.0]


def test_conversions_are_those_of_decimal_numbers(base: Path) -> None:
    """Thousandths of whole millimetres; many binary products, such as 9 * 0.001, are another number."""
    staggers = [*range(1, 200), 0]
    rows = [f"{number},50,{stagger}" for number, stagger in enumerate(staggers[:-1])]
    text = "\n".join(["number,span_m,stagger_contact_wire_mm", *rows, f"{len(rows)},,0"])
    tree = import_line(base, write(base.parent, "s.csv", text), None)
    supports = tree["geometry"]["support"]
    assert [support["stagger_contact_wire_m"] for support in supports] == [stagger / 1000 for stagger in staggers]


def test_empty_cells_take_the_values_of_the_base(base: Path) -> None:
    text = (
        "number,span_m,encumbrance_m,steady_arm_length_m,steady_arm_acts\n0,50,,,\n1,50,1.1,0.9,push\n2,50,,,\n3,,,,\n"
    )
    line = LineFile.model_validate(import_line(base, write(base.parent, "s.csv", text), None))
    # An end of the line without its own value has that of its next support.
    assert [limit.encumbrance for limit in line.layout.limits] == [1.1, 1.1, 1.2, 1.2]
    arms = map(line.steady_arm_at, line.layout.supports)
    assert [(arm.length_m, arm.acts) for arm in arms] == [(0.9, "push"), (1.2, "pull")]


def test_every_problem_of_all_files_is_named_with_row_and_column(tables: tuple[Path, Path]) -> None:
    supports, droppers = tables
    change_cell(supports, 3, "stagger_contact_wire_m", "0.2 m")
    change_cell(supports, 4, "encumbrance_m", "-1")
    change_cell(supports, 5, "steady_arm_acts", "pulls")
    change_cell(supports, 2, "span_m", "630")
    change_cell(supports, 8, "messenger_support_stiffness_N_m", "5e5")
    change_cell(droppers, 3, "x_m", "4.0")
    change_cell(droppers, 5, "x_m", "")
    change_cell(droppers, 12, "span", "9")
    change_cell(droppers, 28, "x_m", "58.5")
    problems = read_problems(LINE_PATH, supports, droppers)
    s, d = "table 'supports.csv', row", "table 'droppers.csv', row"
    assert problems == {
        f"{s} 3, column 'stagger_contact_wire_m'": "found '0.2 m'",
        f"{s} 2, column 'span_m'": "the span is 630 m, but the positions are 63 m apart",
        f"{d} 12, column 'span'": "there is no span 9",
        f"{d} 3, column 'x_m'": "4 m is not greater than the preceding 4.5 m",
        f"{d} 5, column 'x_m'": "x_m is missing",
        f"{d} 28, column 'x_m'": "58.5 m is not inside the span of 58.5 m",
        f"{s} 4, column 'encumbrance_m'": "-1 must be greater than 0.0",
        f"{s} 5, column 'steady_arm_acts'": "found 'pulls', expected 'pull' or 'push'",
        f"{s} 8, column 'messenger_support_stiffness_N_m'": "support 6 is an end of the line, with anchored wires",
    }


@pytest.mark.parametrize(
    ("text", "where", "found"),
    [
        ("stagger_m,span_m\n0,50\n0,\n", "row 1, column 'stagger_m'", "unknown column"),
        ("span_m,span_km\n50,0.05\n,\n", "row 1, column 'span_km'", "repeats the column span_m"),
        ("number,span_m\n0,50\n2,\n", "row 3, column 'number'", "found 2, expected 1"),
        ("number,span_m\n0,50\n1.0,\n", "row 3, column 'number'", "found '1.0'"),
        ("span_m\n50\n50\n", "row 3, column 'span_m'", "a span begins at the end of the line"),
        ("number,span_m\n0,50\n1,\n2,50\n3,\n", "row 3, column 'span_m'", "the span length is missing"),
        ("number,x_m\n0,0\n1,50\n2,50\n", "row 4, column 'x_m'", "the position runs backwards"),
        ("number,x_m\n0,0\n1,\n2,50\n", "row 3, column 'x_m'", "the position is missing"),
        ("number,span_m\n0,5\n1,\n", "row 2, column 'span_m'", "5 must be at least 10.0"),
        ("number;span_m\n0;50,5\n1;50.5\n2;\n", "row 2, column 'span_m'", "a decimal comma, but row 3 has a"),
        ("number;span_m\n0;1.050,5\n1;\n", "row 2, column 'span_m'", "a decimal comma, but row 2 has a decimal point"),
        ("number,span_m\n0,nan\n1,\n", "row 2, column 'span_m'", "found 'nan'"),
        ("number,encumbrance_m\n0,1\n1,1\n", "", "has neither span_m nor x_m"),
        ("number,span_m\n0,50\n", "", "has one row"),
    ],
)
def test_problem_of_a_support_is_named(base: Path, text: str, where: str, found: str) -> None:
    problems = read_problems(base, write(base.parent, "s.csv", text), None)
    place = f"table 's.csv', {where}" if where else "table 's.csv'"
    assert place in problems
    assert found in problems[place]


@pytest.mark.parametrize(
    ("text", "where", "found"),
    [
        ("span,x_m\n1,10\n2,10\n", "", "has no row for span 3"),
        ("span,x_m\n1,10\n2,10\n3,10\n,20\n", "row 5, column 'span'", "the number of the span is missing"),
        ("span,x_m\n1,10\n2,10\n3,10\n3,5\n", "row 5, column 'x_m'", "5 m is not greater than the preceding 10 m"),
        ("span,x_m,presag_m\n1,10,\n2,10,\n3,10,0\n3,20,\n", "row 5, column 'presag_m'", "presag_m is missing"),
        (
            "span,x_m,presag_m,contact_wire_height_m\n1,10,0,\n2,10,0,\n3,10,0,0\n",
            "row 4, column 'contact_wire_height_m'",
            "the height of the contact wire is given twice",
        ),
    ],
)
def test_problem_of_a_dropper_is_named(base: Path, text: str, where: str, found: str) -> None:
    supports = write(base.parent, "s.csv", "span_m\n50\n50\n50\n\n".replace("\n\n", '\n""\n'))
    supports.write_text("number,span_m\n0,50\n1,50\n2,50\n3,\n")
    problems = read_problems(base, supports, write(base.parent, "d.csv", text))
    place = f"table 'd.csv', {where}" if where else "table 'd.csv'"
    assert place in problems
    assert found in problems[place]


def test_common_droppers_that_do_not_fit_a_span_are_named_with_their_key(base: Path) -> None:
    supports = write(base.parent, "s.csv", "number,span_m\n0,50\n1,35\n2,\n")
    problems = read_problems(base, supports, None)
    assert problems == {
        "line 'base.toml' with s.csv, key droppers.x_m[3]": "40 m is not inside the span of 35 m",
    }


def test_values_of_the_base_are_not_lost_without_a_word(base: Path) -> None:
    tree = tomllib.loads(SHORT_BASE)
    tree["geometry"] = {
        "span_list": [{"length_m": 60.0, "droppers": {"x_m": [30.0]}}] * 3,
        "encumbrance_m": 1.2,
        "support": [{"number": 1, "encumbrance_m": 1.1, "steady_arm": {"length_m": 0.8}}],
        "gradient": [{"from_m": 0.0, "to_m": 60.0, "slope": 0.001}],
    }
    base.write_text(tomli_w.dumps(tree))
    supports = write(base.parent, "s.csv", "number,span_m,encumbrance_m\n0,60,1.2\n1,60,1.1\n2,60,\n3,,\n")
    problems = read_problems(base, supports, None)
    assert problems == {
        "line 'base.toml', key geometry.support": "supports have their own steady_arm_length_m, and the table of "
        "supports does not",
        "line 'base.toml', key geometry.gradient": "the table of supports replaces the gradients, but does not give "
        "every contact wire height",
        "line 'base.toml', key geometry.span_list": "spans have their own droppers",
    }


def test_problems_of_unreadable_files_are_joined(tmp_path: Path) -> None:
    base = write(tmp_path, "base.toml", SHORT_BASE.replace("tension_N = 20e3", "tension_kN = 20.0"))
    problems = read_problems(base, write(tmp_path, "s.csv", ""), tmp_path / "d.csv")
    assert list(problems.values())[:2] == ["unknown key", "is empty"]
    assert "cannot be read" in list(problems.values())[2]


def test_columns_follow_the_keys_of_a_line_file() -> None:
    assert SUPPORT_COLUMNS[:4] == ("number", "name", "x_m", "span_m")
    assert {"encumbrance_m", "steady_arm_vertical_damper_N_s_m", "messenger_support_along_track"} <= set(
        SUPPORT_COLUMNS
    )
    assert DROPPER_COLUMNS == ("span", "x_m", "presag_m", "contact_wire_height_m", "length_m")


# Tables of a line with any cells: they give a line, or an error with place and hint for every problem.
CELLS = st.one_of(
    st.sampled_from(
        ["", "x", "-1", "1e999", "1e-400", "0", "9" * 30, "3", "1,2", '"', "1.5.2", "63", "nan", "inf", "5.0"]
    ),
    st.floats().map(repr),
    st.text(max_size=4),
)
CHANGES = st.lists(st.tuples(st.sampled_from([0, 1]), st.integers(0, 60), st.integers(0, 15), CELLS), max_size=4)


@pytest.fixture(scope="module")
def texts(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Tables of the line of the mass-drop tests."""
    tables = export_tables(tmp_path_factory.mktemp("tables"), read_unequal_line())
    return [table.read_text(encoding="utf-8") for table in tables]


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(CHANGES)
def test_any_cells_give_a_line_or_an_error_with_a_place(
    tmp_path: Path, texts: list[str], changes: list[tuple[int, int, int, str]]
) -> None:
    rows = [[line.split(",") for line in text.splitlines()] for text in texts]
    for table, row, column, cell in changes:
        cells = rows[table][row % len(rows[table])]
        cells[column % len(cells)] = cell
    paths = [tmp_path / name for name in ("supports.csv", "droppers.csv")]
    for path, table_rows in zip(paths, rows, strict=True):
        text = "\n".join(",".join(cells) for cells in table_rows) + "\n"
        path.write_bytes(text.encode("utf-8", "surrogatepass"))
    try:
        LineFile.model_validate(import_line(LINE_PATH, *paths))
    except InputError as error:
        for problem in error.problems:
            assert problem.where.startswith(("table 'supports.csv'", "table 'droppers.csv'", "line 'line.toml'"))
            assert problem.hint
