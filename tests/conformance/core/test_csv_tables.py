"""CSV tables: delimiter and decimal mark, comments and blank lines, bounds, and the place of every fault."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from pantocheck.conformance.core import csv_table
from pantocheck.conformance.core.csv_table import read_csv_table, write_csv_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import MeasuredTable
from pantocheck.conformance.core.text_reading import find_text_layout
from pantocheck.conformance.core.text_settings import TextSettings

EXPECTED = [[0.0, 1.0], [0.5, -2.5], [1.0, 1e3]]


def read(folder: Path, text: str, largest: int = 100) -> MeasuredTable:
    (folder / "r.csv").write_text(text, encoding="utf-8")
    (table,) = read_csv_table(folder / "r.csv", (), largest)
    return table


@pytest.mark.parametrize(
    "text",
    [
        "a,b\n0,1\n0.5,-2.5\n1,1e3\n", "a;b\n0;1\n0.5;-2.5\n1;1e3\n", "a;b\n0;1\n0,5;-2,5\n1;1e3\n",
        "a\tb\n0\t1\n0,5\t-2,5\n1\t1e3\n", '"a" , "b"\n0,1\n0.5,-2.5\n1,1e3\n',
        "# of the 3rd test\n#;x\n\na,b\n0,1\n\n0.5,-2.5\n  \n1,1e3\n\n", "\ufeffa,b\r\n0,1\r\n0.5,-2.5\r\n1,1e3",
    ],
)  # fmt: skip
def test_dialects_comments_and_blank_lines_give_one_table(text: str, tmp_path: Path) -> None:
    table = read(tmp_path, text)
    assert_array_equal(table.values, EXPECTED)
    assert [column.name for column in table.columns] == ["a", "b"]


def test_names_of_columns_need_a_head_line(tmp_path: Path) -> None:
    table = read(tmp_path, "0,1\n0.5,-2.5\n1,1e3\n")
    assert_array_equal(table.values, EXPECTED)
    assert [column.name for column in table.columns] == [None, None]
    assert [column.name for column in read(tmp_path, "1,b\n0,1\n").columns] == ["1", "b"]
    # A record at rest begins with whole numbers.
    assert_array_equal(read(tmp_path, "a;b\n0;0\n0;0\n0;0\n0,5;1,5\n").values[-1], [0.5, 1.5])
    rest = "0;0\n" * 2000
    assert_array_equal(read(tmp_path, f"a;b\n{rest}0,5;1,5\n", 10_000).values[-1], [0.5, 1.5])
    # One with a decimal mark above whole numbers is no name.
    assert_array_equal(read(tmp_path, "1.5\n522\n24\n331\n").values[:, 0], [1.5, 522, 24, 331])
    # A time stamp beside numbers, a trailing separator, and a missing number.
    table = read(tmp_path, "Uhr;a;b;\n12:00:01,5;1,5;2;\n12:00:01,6;;3;\n12:00:01,7;1,7;4;\n12:00:01,8;1,8;5;\n")
    assert_array_equal(table.values[:, 1:3], [[1.5, 2], [np.nan, 3], [1.7, 4], [1.8, 5]])
    assert np.isnan(table.values[:, [0, 3]]).all()


@pytest.mark.parametrize(
    ("text", "where", "found"),
    [
        ("a;b\n0;0\n1;1\n2\n3;3\n", "line 4", "has 1 of 2 values"),
        ("a;b\n0;0\n1;1\n2\n", "line 4", "has 1 of 2 values"),
        ("a;b\n0;0\n1\n2;2\n", "line 3", "has 1 of 2 values"),
        ("a,b\n0,0\n1,1,1\n", "line 3", "has 3 values, expected 2"),
        ("a,b\n0,0\n1, x \n", "line 3, column 2", "'x' is not a number"),
        (f"a,b\n0,0\n{'y' * 50},1\n", "line 3, column 1", f"'{'y' * 40}' is not a number"),
        ("0,0.5\n1,x\n2,0.5\n3,0.5\n", "line 2, column 2", "'x' is not a number"),
        ("# c\n\na,b\n0,0\n\nx,1\n", "line 6, column 1", "'x' is not a number"),
        ("a,b\n0,0\n# end\n", "line 3", "has 1 of 2 values"),
        ("a,b\n", "", "holds a head line but no samples"),
        ("# only\n# comments\n", "", "holds no line of data"),
    ],
)
def test_fault_is_named_with_its_line_and_column(text: str, where: str, found: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    assert caught.value.where == ", ".join(filter(None, ("record 'r.csv'", where)))
    assert caught.value.found == found


@pytest.mark.parametrize(
    ("row", "advice"), [("1", "may have stopped within it"), ("1,5,2", "write decimals with points")]
)
def test_short_line_and_long_line_have_their_own_advice(row: str, advice: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=advice):
        read(tmp_path, f"a,b\n0,0\n{row}\n")


@pytest.mark.parametrize("text", ["a,b\n0,1\n2,3\n4,5\n", "0,1.5\n2,3\n4,5.5\n"])
def test_table_may_have_as_many_numbers_as_allowed(text: str, tmp_path: Path) -> None:
    assert read(tmp_path, text, 6).values.size == 6
    with pytest.raises(InputError, match="more than 5 numbers"):
        read(tmp_path, text, 5)


def test_line_may_be_as_long_as_allowed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nine characters and the end of the line are ten."""
    monkeypatch.setattr(csv_table, "LONGEST_ROW", 11)
    assert read(tmp_path, "a,b\n0,1234567\n").values[0, 1] == 1234567
    monkeypatch.setattr(csv_table, "LONGEST_ROW", 10)
    with pytest.raises(InputError, match=r"record 'r\.csv', line 2: is too long\.\n  A line has at most 10 characters"):
        read(tmp_path, "a,b\n0,1234567\n")


@pytest.mark.parametrize("digits", [9, 12])
def test_written_numbers_have_the_stated_digits(digits: int, tmp_path: Path) -> None:
    """Rounding to d significant digits changes a number by at most 5 in the next digit."""
    values = np.random.default_rng(1).uniform(1, 10, (50, 2))
    write_csv_table(tmp_path / "r.csv", ["a", "b"], values, digits)
    (table,) = read_csv_table(tmp_path / "r.csv", (), 100)
    error = np.abs(table.values - values).max()
    assert 0.5 * 10.0 ** (1 - digits) * 0.5 < error <= 0.5 * 10.0 ** (1 - digits) * (1 + 1e-3)
    assert [column.name for column in table.columns] == ["a", "b"]


LOGGER = "Messzug 7\nStrecke;NBS Nord\n\nZeit;Kraft 1\ns;kN\n0,00;0,112\n0,01;0,098\n0,02;0,101\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_head_lines_units_and_encodings_of_a_logger(encoding: str, tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_bytes(LOGGER.replace("Kraft 1", "Kraft vorn, Lösung µ").encode(encoding))
    (table,) = read_csv_table(tmp_path / "r.csv", (), 100)
    assert_array_equal(table.values, [[0, 0.112], [0.01, 0.098], [0.02, 0.101]])
    assert [(column.name, column.unit) for column in table.columns] == [("Zeit", "s"), ("Kraft vorn, Lösung µ", "kN")]
    lines = [(number, text) for number, text in enumerate(LOGGER.splitlines(), 1) if text]
    assert find_text_layout(lines, "r", TextSettings(header_lines=3)).preface == ("Messzug 7", "Strecke;NBS Nord")
    with pytest.raises(InputError, match="r, line 2: is stated to hold the names, but 2 lines stand"):
        find_text_layout(lines, "r", TextSettings(header_lines=1))


@pytest.mark.parametrize("separator", [",", ";", "\t", "|", " ", "   "])
@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("head", [True, False])
def test_every_separator_and_decimal_mark_is_read_or_refused(
    separator: str, decimal: str, head: bool, tmp_path: Path
) -> None:
    """Random numbers with three decimals: the table is found again; only a comma cannot be both marks."""
    values = np.round(np.random.default_rng(3).uniform(-200, 200, (30, 3)), 3)
    values[:, 0] = np.arange(30) / 200
    rows = [separator.join(f"{value:.3f}".replace(".", decimal) for value in row) for row in values]
    text = "\n".join([separator.join("abc"), *rows] if head else rows)
    if separator == decimal:
        with pytest.raises(InputError):
            read(tmp_path, text)
    else:
        assert_array_equal(read(tmp_path, text).values, values)


@pytest.mark.parametrize(
    ("text", "found", "settings"),
    [
        ("0,1\n2,3\n4,5\n", "can be read in two ways: one column", {"separator": ","}),
        ("a;b\n1,234;2,345\n1,235;2,346\n", "may separate decimals or thousands", {"decimal": ","}),
        ("a;b\n1.234;2.345\n1.235;2.346\n", "may separate decimals or thousands", {"decimal": "."}),
        ("Zug;7\nZeit;Kraft\n0;1\n2;3\n4;5\n", "may all hold the names", {"header_lines": 1}),
        ("x;y;z\nZeit;Kraft;Weg\nsek;kp;Meile\n0;1;2\n2;3;4\n4;5;6\n", "may all hold", {"header_lines": 1}),
    ],
)
def test_ambiguous_layout_names_the_key_that_decides(
    text: str, found: str, settings: dict[str, object], tmp_path: Path
) -> None:
    """No reading is chosen silently; the stated key gives the intended one."""
    with pytest.raises(InputError, match=found) as caught:
        read(tmp_path, text)
    assert next(iter(settings)) in str(caught.value)
    (table,) = read_csv_table(tmp_path / "r.csv", (), 100, TextSettings.model_validate(settings))
    assert table.columns[0].name in {"a", "Zeit", None}
    assert np.abs(table.values).max() < 10


def test_marks_after_the_first_lines_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="may separate decimals or thousands"):
        read(tmp_path, "a;b\n" + "0;0\n" * 2000 + "1,000;0\n", 10_000)
    with pytest.raises(InputError, match=r"line 7, column 2: '0\.5' is not a number"):
        read(tmp_path, "a;b\n" + "0,1;0,1\n" * 5 + "0,1;0.5\n" + "0,1;0,1\n" * 9)


def test_stated_encoding_is_used(tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_bytes("ä,b\n0,1.5\n1,2.5\n".encode("cp850"))
    (table,) = read_csv_table(tmp_path / "r.csv", (), 100, TextSettings(encoding="cp850"))
    assert table.columns[0].name == "ä"
    with pytest.raises(InputError, match="is not text in the encoding utf-8"):
        read_csv_table(tmp_path / "r.csv", (), 100, TextSettings(encoding="utf-8"))
