"""Line to tables to line: the derived catenary is the same to the last bit."""

from pathlib import Path

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
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line


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
