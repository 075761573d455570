"""Line files of few spans with changes, from the line of EN 50318:2002."""

from typing import Any

from helpers.toml_edit import change_keys
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile


def changed_tables(changes: dict[str, Any], spans: int = 3) -> dict[str, Any]:
    """Tables of the line of EN 50318:2002 with few spans and changed keys."""
    tables = read_toml(library_folder() / "en50318-2002" / "line.toml", "line")
    change_keys(tables, {"geometry.spans": spans} | changes)
    return tables


def changed_line(changes: dict[str, Any], spans: int = 3) -> LineFile:
    """Line of EN 50318:2002 with few spans and changed keys."""
    return LineFile.model_validate(changed_tables(changes, spans))
