"""Lines as tables of supports and droppers, and back."""

from pathlib import Path
from typing import Any

from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.line_export import DecimalMark, export_droppers, export_supports
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line


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
