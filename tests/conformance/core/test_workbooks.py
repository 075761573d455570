"""Workbooks: cells are read right or refused with their place; written texts are no formulas; equal bytes."""

import io
import re
import struct
import sys
import zipfile
from datetime import date, time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from openpyxl import load_workbook
from openpyxl.packaging.relationship import Relationship
from openpyxl.workbook.external_link import ExternalLink

from helpers.workbooks import change_parts, convert_to_ods, store_results, write_ods, write_rows
from pantocheck.conformance.core.extras import MissingPackage
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import read_tables
from pantocheck.conformance.core.spreadsheet import read_spreadsheet
from pantocheck.conformance.core.workbook_reading import MAX_UNPACKED_BYTES, list_sheet_names, read_sheet
from pantocheck.conformance.core.workbook_writing import SheetColumn, WrittenSheet, write_workbook

TABLE: list[list[Any]] = [
    ["# survey", None],
    [None, None],
    ["number", "x_m"],
    [0, 1.5],
    [],
    [1, 0.123456789012345],
    [2, 1e-7],
]


@pytest.mark.parametrize("convert", [Path, convert_to_ods])
def test_numbers_keep_their_digits_and_rows_their_numbers(tmp_path: Path, convert: Any) -> None:
    """A preface and empty rows are skipped;"""
    path = convert(write_rows(tmp_path / "a.xlsx", TABLE))
    table = read_spreadsheet(path)
    assert (table.head.number, table.head.cells) == (3, ("number", "x_m"))
    assert [(row.number, row.cells) for row in table.rows] == [
        (4, ("0", "1.5")),
        (6, ("1", "0.123456789012345")),
        (7, ("2", "1e-07")),
    ]
    assert table.rows[0].numbers == {0, 1}
    assert table.locate(table.rows[1], 1) == f"table '{path.name}', sheet 'supports', row 6, column 'x_m'"


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (date(2020, 5, 1), "is a date"),
        (time(1, 30), "is a date"),
        (True, "is a truth value"),
        ("=A2*2", "is a formula without a stored result"),
    ],
)
def test_uncertain_cells_are_refused_with_their_place(tmp_path: Path, value: Any, message: str) -> None:
    path = write_rows(tmp_path / "a.xlsx", [["number", "x_m"], [0, 1.5], [1, value]])
    with pytest.raises(InputError) as caught:
        read_spreadsheet(path)
    assert caught.value.where == "table 'a.xlsx', sheet 'supports', row 3, column 'x_m'"
    assert message in caught.value.found


def test_formulas_are_read_by_their_stored_results(tmp_path: Path) -> None:
    path = write_rows(tmp_path / "a.xlsx", [["number", "x_m"], [0, 1.5], [1, "=B2*2"], [2, 4.5]])
    table = read_spreadsheet(store_results(path, "3"))
    assert [row.cells[1] for row in table.rows] == ["1.5", "3", "4.5"]
    change_parts(path, lambda _, part: re.sub(rb'"B3"[^>]*>', b'"B3" t="e">', part).replace(b"<v>3", b"<v>#REF!"))
    with pytest.raises(InputError, match=r"row 3, column 'x_m': the cell is the error #REF!"):
        read_spreadsheet(path)


def test_percentages_and_merged_cells_are_refused(tmp_path: Path) -> None:
    """Merged cells of a title do not matter; the first one of a merged range holds the value."""
    rows = [["# title", None], ["number", "x_m"], [0, 0.05], [1, 7], [None, None], [2, 8], [3, 9]]
    path = write_rows(tmp_path / "a.xlsx", rows)
    book = load_workbook(path)
    book.active["B3"].number_format = "0 %"
    for cells in ("A1:B1", "B4:B5", "B7:B8"):
        book.active.merge_cells(cells)
    book.save(path)
    with pytest.raises(InputError) as caught:
        read_spreadsheet(path)
    places = [problem.where.partition("'supports', ")[2] for problem in caught.value.problems]
    assert places == ["row 3, column 'x_m'", "row 5, column 'x_m'", "row 8, column 'x_m'"]
    merged = ["the cell is merged with others"] * 2
    assert [problem.found for problem in caught.value.problems] == ["the cell is a percentage", *merged]


def test_cells_of_ods_are_refused_like_those_of_xlsx(tmp_path: Path) -> None:
    cells = (
        '<table:table-cell office:value-type="date" office:date-value="2020-05-01"/>',
        '<table:table-cell calcext:value-type="error"><text:p>#NAME?</text:p></table:table-cell>',
        '<table:table-cell table:formula="of:=1"/>',
        '<table:table-cell office:value-type="percentage" office:value="0.05"/>',
        "<table:covered-table-cell/>",
    )
    head = '<table:table-cell office:value-type="string"><text:p>x_m</text:p></table:table-cell>'
    rows = "".join(f"<table:table-row>{cell}</table:table-row>" for cell in (head, *cells))
    with pytest.raises(InputError) as caught:
        read_spreadsheet(write_ods(tmp_path / "a.ods", f'<table:table table:name="s">{rows}</table:table>'))
    assert [problem.found.removeprefix("the cell is ") for problem in caught.value.problems] == [
        "a date",
        "the error #NAME?",
        "a formula without a stored result",
        "a percentage",
        "merged with others",
    ]


def test_sheet_is_chosen_by_its_name(tmp_path: Path) -> None:
    path = write_rows(tmp_path / "a.xlsx", [["x_m"], [1]], "Supports ")
    book = load_workbook(path)
    book.create_sheet("droppers").append(["span"])
    book.save(path)
    assert list_sheet_names(path, "a") == ["Supports ", "droppers"]
    assert read_spreadsheet(path, "supports").rows[0].cells == ("1",)
    with pytest.raises(InputError, match="has several sheets"):
        read_spreadsheet(path)
    with pytest.raises(InputError, match="Name the sheet 'sensors'"):
        read_spreadsheet(path, "sensors")


def write_bomb(path: Path) -> Path:
    """Part of 100 MB that takes 100 kB."""
    return change_parts(path, lambda _, part: part, **{"xl/media/a.bin": b"\0" * 100_000_000})


def lie_about_size(path: Path) -> Path:
    """The same, with a directory that states 10 bytes for every part."""
    content = bytearray(write_bomb(path).read_bytes())
    place = content.find(b"PK\x01\x02")
    while place >= 0:
        content[place + 24 : place + 28] = struct.pack("<I", 10)
        place = content.find(b"PK\x01\x02", place + 4)
    path.write_bytes(content)
    return path


def add_doctype(path: Path) -> Path:
    text = b'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "aaaa">]>'
    return change_parts(path, lambda name, part: text + part if "sheet1" in name else part)


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (write_bomb, f"At most 2000 parts and {MAX_UNPACKED_BYTES} bytes are read"),
        (lie_about_size, "is damaged, or is not a workbook"),
        (add_doctype, "has a document type definition"),
        (lambda path: change_parts(path, lambda _, part: part.decode("latin-1").encode("utf-16")), "or is not UTF-8"),
        (lambda path: change_parts(path, lambda _, part: part[: len(part) // 2]), "is damaged, or is not a workbook"),
        (lambda path: path.write_bytes(b"PK no archive") and path, "is damaged, or is not a workbook"),
    ],
)
def test_hostile_and_damaged_workbooks_are_refused(tmp_path: Path, damage: Any, message: str) -> None:
    path = damage(write_rows(tmp_path / "a.xlsx", [["x_m"], [1]]))
    with pytest.raises(InputError, match=message):
        read_spreadsheet(path)


def test_rows_far_away_are_refused_before_they_take_memory(tmp_path: Path) -> None:
    path = write_rows(tmp_path / "a.xlsx", [["x_m"], [1]])
    change_parts(path, lambda _, part: part.replace(b' r="2"', b' r="99999999"').replace(b'"A2"', b'"A99999999"'))
    with pytest.raises(InputError, match="Delete the empty rows"):
        read_spreadsheet(path)
    row = '<table:table-row table:number-rows-repeated="99999999"><table:table-cell office:value-type="string">'
    wide = write_ods(
        tmp_path / "a.ods",
        f'<table:table table:name="s">{row}<text:p>x</text:p></table:table-cell></table:table-row></table:table>',
    )
    with pytest.raises(InputError, match="Delete the empty rows"):
        read_spreadsheet(wide)


def test_links_to_other_files_are_not_followed(tmp_path: Path) -> None:
    path = write_rows(tmp_path / "a.xlsx", [["x_m"], [1]])
    book = load_workbook(path)
    link = ExternalLink()
    target = "http://localhost:9/other.xlsx"
    link.file_link = Relationship(type="externalLinkPath", Target=target, TargetMode="External")
    book._external_links.append(link)
    book.save(path)
    assert any("externalLink" in name for name in zipfile.ZipFile(path).namelist())
    assert read_sheet(path, "a").rows[1].cells[0].text == "1"


def test_measured_tables_are_read_from_sheets(tmp_path: Path) -> None:
    """A column of texts is missing; a text that is a number counts, even alone; an empty cell is a missing value."""
    rows = [["x_m", "height_m", "remark"], [1.5, "5.25", date(2020, 5, 1)], ["2,5", None, "a"], [3, "nan", None]]
    path = write_rows(tmp_path / "a.xlsx", rows)
    for each in (path, convert_to_ods(write_rows(tmp_path / "b.xlsx", [row[:2] for row in rows]))):
        (table,) = read_tables(each, (), 100)
        assert [column.name for column in table.columns][:2] == ["x_m", "height_m"]
        np.testing.assert_array_equal(table.values[:, :2], [[1.5, 5.25], [2.5, np.nan], [3.0, np.nan]])
    for value, message in ((date(2020, 5, 1), "is a date"), ("1,234", "'1,234' is not a number")):
        with pytest.raises(InputError, match=message):
            read_tables(write_rows(path, [["x_m"], [1.5], [value]]), (), 100)
    with pytest.raises(InputError, match="holds more than 3 numbers"):
        read_tables(write_rows(path, rows), (), 3)


SHEET = WrittenSheet(
    "s",
    (
        *(SheetColumn("text"), SheetColumn("acts", "direction", ("pull", "push"))),
        SheetColumn("x", "", (), "a positive number", (">0",)),
    ),
    [["=1+1", "pull", 0.1 + 0.2], ["@a", None, 3], ["+z", "push", None], ["-a\x01\ud800", None, None]],
    is_filled_in=True,
)


def test_texts_are_never_formulas_and_numbers_keep_their_digits(tmp_path: Path) -> None:
    (tmp_path / "a.xlsx").write_bytes(write_workbook([SHEET]))
    sheet = load_workbook(tmp_path / "a.xlsx").active
    assert [cell.value for cell in sheet["A"]] == ["text", "=1+1", "@a", "+z", "-a\ufffd\ufffd"]
    assert {cell.data_type for cell in sheet["A"]} == {"s"}
    assert all(cell.quotePrefix for cell in sheet["A"][1:])
    assert [cell.value for cell in sheet["C"]] == ["x", 0.1 + 0.2, 3, None, None]
    checks = [(check.type, str(check.sqref), check.formula1) for check in sheet.data_validations.dataValidation]
    assert checks == [("list", "B2:B2001", '"pull,push"'), ("custom", "C2:C2001", "AND(ISNUMBER(C2),C2>0)")]


def test_same_sheets_give_the_same_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    first = write_workbook([SHEET])
    monkeypatch.setenv("TZ", "Pacific/Auckland")
    assert write_workbook([SHEET]) == first
    archive = zipfile.ZipFile(io.BytesIO(first))
    assert {part.date_time for part in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    assert set(re.findall(rb"\d{4}-\d\d-\d\dT", archive.read("docProps/core.xml"))) == {b"1980-01-01T"}


def test_missing_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_rows(tmp_path / "a.xlsx", [["x_m"], [1]])
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(MissingPackage, match=r"pip install 'pantocheck\[sheets\]'"):
        read_spreadsheet(path)
    with pytest.raises(MissingPackage):
        read_tables(path, (), 100)
