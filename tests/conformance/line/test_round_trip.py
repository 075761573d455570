"""Line to tables to line: the derived catenary is the same to the last bit."""

import tomllib
from pathlib import Path

import pytest
import tomli_w

from helpers.line_table_files import export_and_import, export_tables
from helpers.listed_spans import list_spans, list_supports
from helpers.section_lines import section_tables
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line

LINES = sorted(library_folder().rglob("line.toml"))

AS_BUILT = """
title = "every value of its own"
[geometry]
span_list = [
    { length_m = 58.37 },
    { length_m = 61.1, droppers = { x_m = [7.3, 30.1, 52.9], contact_wire_height_m = [5.4, 5.47, 5.55] } },
    { length_m = 47.93, droppers = "short" },
    { length_m = 61.1, droppers = { x_m = [7.3, 53.9], presag_m = [0.01, 0.012], length_m = [1.1, 1.2] } },
]
contact_wire_height_m = 5.3
encumbrance_m = 1.41
stagger_contact_wire_m = 0.21
[geometry.schedule.short]
x_m = [5.1, 24.3]
[[geometry.support]]
number = 0
contact_wire_height_m = 5.4
[[geometry.support]]
number = 2
stagger_contact_wire_m = -0.27
stagger_messenger_m = 0.03
contact_wire_height_m = 5.317
encumbrance_m = 1.13
steady_arm = { acts = "push", length_m = 0.93, vertical_damper_N_s_m = 20.0 }
messenger_support = { stiffness_N_m = 2.1e5 }
[[geometry.gradient]]
from_m = 31.7
to_m = 171.3
slope = 0.0031
"""


def write_line_as_built(folder: Path) -> Path:
    """Line of four spans whose supports, spans and gradient have their own values; wires of the library."""
    parts = tomllib.loads((library_folder() / "en50318-2018" / "ac-simple" / "line.toml").read_text())
    parts["droppers"] |= {"x_m": [10.0, 30.0]}
    for key in ("presag_m", "length_m"):
        parts["droppers"].pop(key, None)
    (folder / "built.toml").write_text(tomli_w.dumps(parts | tomllib.loads(AS_BUILT)), encoding="utf-8")
    return folder / "built.toml"


def write_listed_supports(folder: Path) -> Path:
    """The line of EN 50318:2018 with every value of every support, and other values for the line."""
    tables = tomllib.loads((library_folder() / "en50318-2018" / "ac-simple" / "line.toml").read_text())
    (folder / "listed.toml").write_text(tomli_w.dumps(list_supports(list_spans(tables))), encoding="utf-8")
    return folder / "listed.toml"


@pytest.mark.parametrize("base", LINES, ids=lambda path: path.parent.name)
def test_library_lines_keep_their_catenary(tmp_path: Path, base: Path) -> None:
    """With decimal points and with decimal commas."""
    original = build_catenary(read_model(base, LineFile, "line"))
    imported = [export_and_import(tmp_path, base, mark)[0] for mark in ("point", "comma")]
    assert imported[0] == imported[1]
    assert build_catenary(imported[0]) == original


def write_line_of_sections(folder: Path) -> Path:
    """Two tension sections with an overlap of three spans, and a section insulator."""
    tables = section_tables("en50318-2018/ac-simple")
    insulator = {"x_m": 92.0, "wire": "contact_wire", "mass_kg": 12.0}
    (folder / "sections.toml").write_text(tomli_w.dumps(tables | {"point_mass": [insulator]}), encoding="utf-8")
    return folder / "sections.toml"


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
