"""Lines as tables: nothing is lost on the way back, and cells that a spreadsheet program changed are refused."""

from datetime import date
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from helpers.line_table_files import (
    LINES,
    export_and_import,
    export_tables,
    write_line_as_built,
    write_line_of_sections,
    write_listed_supports,
)
from helpers.workbooks import change_cells, convert_to_ods
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_export import export_workbook
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line


def write_sheets(folder: Path, base: Path) -> Path:
    path = folder / "line.xlsx"
    path.write_bytes(export_workbook(read_model(base, LineFile, "line")))
    return path


def import_without_source(base: Path, *tables: Path) -> str:
    """Text of the imported line file, without the names of its tables."""
    tree = import_line(base, tables[0], tables[1] if len(tables) > 1 else None)
    return tomli_w.dumps(tree | {"geometry": tree["geometry"] | {"source": ""}})


@pytest.mark.parametrize("base", LINES, ids=lambda path: path.parent.name)
def test_library_lines_come_back_from_sheets_as_from_text(tmp_path: Path, base: Path) -> None:
    """The text tables keep the catenary to the last bit (`test_round_trip`); sheets give the same line file."""
    wanted = import_without_source(base, *export_tables(tmp_path, read_model(base, LineFile, "line")))
    sheets = write_sheets(tmp_path, base)
    assert import_without_source(base, sheets) == wanted
    assert import_without_source(base, convert_to_ods(sheets)) == wanted


@pytest.mark.parametrize("write", [write_line_as_built, write_listed_supports, write_line_of_sections])
def test_lines_as_built_come_back_from_sheets_as_from_text(tmp_path: Path, write: Any) -> None:
    base = write(tmp_path)
    wanted = import_without_source(base, *export_tables(tmp_path, read_model(base, LineFile, "line")))
    assert import_without_source(base, write_sheets(tmp_path, base)) == wanted


def test_second_export_writes_the_same_bytes(tmp_path: Path) -> None:
    base = write_line_as_built(tmp_path)
    first = write_sheets(tmp_path, base).read_bytes()
    (tmp_path / "again.toml").write_text(tomli_w.dumps(import_line(base, tmp_path / "line.xlsx", None)))
    assert write_sheets(tmp_path, tmp_path / "again.toml").read_bytes() == first


@pytest.mark.parametrize(
    ("changes", "span"),
    [
        ({"D3": 55.5, "C3": None}, 55.5),
        ({"D3": "55,5"}, 55.5),
        ({"D3": " 55.5 "}, 55.5),
        ({"D3": "5.55e1"}, 55.5),
    ],
)
def test_changed_numbers_and_texts_are_read(tmp_path: Path, changes: dict[str, Any], span: float) -> None:
    """A number stored as text, with a decimal point or comma; without positions, lengths alone count."""
    base = write_line_as_built(tmp_path)
    path = write_sheets(tmp_path, base)
    positions = {f"C{row}": None for row in range(2, 7)}
    change_cells(path, "supports", positions | changes)
    assert import_line(base, path, None)["geometry"]["span_list"][1]["length_m"] == span


@pytest.mark.parametrize(
    ("changes", "place", "found"),
    [
        ({"D3": date(2026, 5, 1)}, "sheet 'supports', row 3, column 'span_m'", "the cell is a date"),
        ({"D3": "=D2+1"}, "sheet 'supports', row 3, column 'span_m'", "a formula without a stored result"),
        ({"D3": "1,234"}, "sheet 'supports', row 3, column 'span_m'", "found '1,234'"),
        ({"D3": "55,5", "D4": "47.9"}, "sheet 'supports', row 3, column 'span_m'", "has a decimal comma"),
        ({"A4": 2.5}, "sheet 'supports', row 4, column 'number'", "found '2.5'"),
        ({"P4": "shove"}, "sheet 'supports'", "shove"),
        ({"H4": -1}, "sheet 'supports', row 4, column 'encumbrance_m'", "must be greater than 0"),
    ],
)
def test_other_cells_are_refused_with_their_place(
    tmp_path: Path, changes: dict[str, Any], place: str, found: str
) -> None:
    base = write_line_as_built(tmp_path)
    with pytest.raises(InputError) as caught:
        import_line(base, change_cells(write_sheets(tmp_path, base), "supports", changes), None)
    assert any(place in problem.where and found in problem.message for problem in caught.value.problems), caught.value


def test_empty_rows_and_a_remark_above_the_head_are_skipped(tmp_path: Path) -> None:
    from openpyxl import load_workbook

    base = write_line_as_built(tmp_path)
    path = write_sheets(tmp_path, base)
    wanted = import_without_source(base, path)
    book = load_workbook(path)
    for sheet in book:
        sheet.insert_rows(1, 2)
        sheet["A1"] = "# survey of 1998"
        sheet.insert_rows(5)
    book.save(path)
    assert import_without_source(base, path) == wanted


# Line to tables to line: the derived catenary is the same to the last bit.
@pytest.mark.parametrize("base", LINES, ids=lambda path: path.parent.name)
def test_library_lines_keep_their_catenary(tmp_path: Path, base: Path) -> None:
    """With decimal points and with decimal commas."""
    original = build_catenary(read_model(base, LineFile, "line"))
    imported = [export_and_import(tmp_path, base, mark)[0] for mark in ("point", "comma")]
    assert imported[0] == imported[1]
    assert build_catenary(imported[0]) == original


@pytest.mark.parametrize("write", [write_line_as_built, write_listed_supports, write_line_of_sections])
def test_lines_as_built_keep_their_catenary(tmp_path: Path, write: object) -> None:
    base = write(tmp_path)  # type: ignore[operator]
    line, _ = export_and_import(tmp_path, base)
    original = read_model(base, LineFile, "line")
    assert build_catenary(line) == build_catenary(original)
    assert [schedule.length_m for schedule in line.dropper_schedules] == [
        schedule.length_m for schedule in original.dropper_schedules
    ]


def test_second_round_trip_writes_the_same_tables_and_file(tmp_path: Path) -> None:
    base = write_line_as_built(tmp_path)
    line, tree = export_and_import(tmp_path, base)
    tables = [(tmp_path / name).read_text() for name in ("supports.csv", "droppers.csv")]
    (tmp_path / "again.toml").write_text(tomli_w.dumps(tree))
    supports, droppers = export_tables(tmp_path, line)
    assert [supports.read_text(), droppers.read_text()] == tables
    again = import_line(tmp_path / "again.toml", supports, droppers)
    assert again["geometry"] | {"source": ""} == tree["geometry"] | {"source": ""}


def test_imported_file_states_common_values_once(tmp_path: Path) -> None:
    """All supports alike, staggers alternating: no table of a single support, and named schedules."""
    _, tree = export_and_import(tmp_path, library_folder() / "mass-drop-line" / "line.toml")
    geometry = tree["geometry"]
    assert "support" not in geometry
    assert sorted(geometry["schedule"]) == ["54 m", "58.5 m"]
    assert [span.get("droppers") for span in geometry["span_list"]] == [None, None, "58.5 m", None, "54 m", None]
    _, tree = export_and_import(tmp_path, library_folder() / "en50318-2018" / "ac-simple" / "line.toml")
    assert tree["geometry"]["stagger_contact_wire_m"] == 0.2
    assert "support" not in tree["geometry"]


def test_provenance_of_the_base_does_not_cover_the_tables(tmp_path: Path) -> None:
    line, _ = export_and_import(tmp_path, library_folder() / "en50318-2002" / "line.toml")
    assert line.geometry.trust == "provisional"
    assert line.geometry.source == "supports.csv and droppers.csv, other values from line.toml"
