"""Tables as spreadsheets export them: encodings, delimiters, quotes; damaged tables are refused with their rows."""

from pathlib import Path

import pytest

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.spreadsheet import MOST_ROWS, read_spreadsheet

TEXT = "name;x_m\nMast Süd;1,5\nMast 2;2,5\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_encodings_and_line_ends_of_spreadsheets_are_read(tmp_path: Path, encoding: str, end: str) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(TEXT.replace("\n", end).encode(encoding))
    table = read_spreadsheet(path)
    assert table.head.cells == ("name", "x_m")
    assert [row.cells for row in table.rows] == [("Mast Süd", "1,5"), ("Mast 2", "2,5")]


@pytest.mark.parametrize("delimiter", [";", ",", "\t"])
def test_delimiters_quotes_and_spaces_are_read(tmp_path: Path, delimiter: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f'"name"{delimiter} x_m \n"a{delimiter} b"{delimiter} 1.5\n', encoding="utf-8")
    table = read_spreadsheet(path)
    assert (table.delimiter, table.head.cells) == (delimiter, ("name", "x_m"))
    assert table.rows[0].cells == (f"a{delimiter} b", "1.5")


def test_rows_keep_the_numbers_of_the_spreadsheet(tmp_path: Path) -> None:
    """A preface and empty rows are skipped; they count."""
    path = tmp_path / "a.csv"
    path.write_text("sep=;\n# survey of 1998\n\na;b\n;\n1;2\n\n3;4\n", encoding="utf-8")
    table = read_spreadsheet(path)
    assert (table.head.number, [row.number for row in table.rows]) == (4, [6, 8])
    assert table.locate(table.rows[1], 0) == "table 'a.csv', row 8, column 'a'"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b"# only a remark\n", "is empty"),
        (b"a,b\n,\n", "has a head line but no rows"),
        (b";;\n;;\n", "has a head line but no rows"),
        (b"PK\x03\x04\x00\x00", "is not text"),
        (b"\xff\xfea\x00\x00", "is not text"),
        (b"a\x81b,c\n1,2\n", "is not text"),
        (b'a,b\n"1,2\n', "row 2: unexpected end of data"),
    ],
)
def test_other_content_is_refused(tmp_path: Path, content: bytes, message: str) -> None:
    (tmp_path / "a.csv").write_bytes(content)
    with pytest.raises(InputError, match=message):
        read_spreadsheet(tmp_path / "a.csv")


def test_number_and_width_of_rows_are_bounded(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("a,b\n" + "1,2\n" * MOST_ROWS)
    assert len(read_spreadsheet(tmp_path / "a.csv").rows) == MOST_ROWS
    for row in ("1,2\n", ",\n"):
        (tmp_path / "a.csv").write_text("a,b\n" + row * MOST_ROWS + "3,4\n")
        with pytest.raises(InputError, match="has more than 100000 rows"):
            read_spreadsheet(tmp_path / "a.csv")
    (tmp_path / "a.csv").write_text("a,b\n1,2,3\n1,2\n1\n")
    with pytest.raises(InputError) as caught:
        read_spreadsheet(tmp_path / "a.csv")
    assert [problem.where for problem in caught.value.problems] == ["table 'a.csv', row 2", "table 'a.csv', row 4"]
