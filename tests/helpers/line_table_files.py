"""Lines as tables of supports and droppers, and back."""

import tomllib
from pathlib import Path
from typing import Any

import tomli_w

from helpers.listed_spans import list_spans, list_supports
from helpers.section_lines import section_tables
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_export import DecimalMark, export_droppers, export_supports
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


def write_line_of_sections(folder: Path) -> Path:
    """Two tension sections with an overlap of three spans, and a section insulator."""
    tables = section_tables("en50318-2018/ac-simple")
    insulator = {"x_m": 92.0, "wire": "contact_wire", "mass_kg": 12.0}
    (folder / "sections.toml").write_text(tomli_w.dumps(tables | {"point_mass": [insulator]}), encoding="utf-8")
    return folder / "sections.toml"


def export_tables(folder: Path, line: LineFile, mark: DecimalMark = "point") -> tuple[Path, Path]:
    """Write the tables of a line; return the paths of supports and droppers."""
    supports, droppers = folder / "supports.csv", folder / "droppers.csv"
    supports.write_text(export_supports(line, mark), encoding="utf-8")
    droppers.write_text(export_droppers(line, mark), encoding="utf-8")
    return supports, droppers


def export_and_import(folder: Path, base: Path, mark: DecimalMark = "point") -> tuple[LineFile, dict[str, Any]]:
    """Line of a base file after its way through tables, and the content of its file."""
    supports, droppers = export_tables(folder, read_model(base, LineFile, "line"), mark)
    tree = import_line(base, supports, droppers)
    return LineFile.model_validate(tree), tree


def change_cell(path: Path, row: int, column: str, text: str) -> None:
    """Replace a cell of a table with commas; rows count from 1, the head line."""
    lines = path.read_text(encoding="utf-8").splitlines()
    index = lines[0].split(",").index(column)
    cells = lines[row - 1].split(",")
    cells[index] = text
    lines[row - 1] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
