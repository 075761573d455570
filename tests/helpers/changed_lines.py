"""Line files of few spans with changes, from the line of EN 50318:2002."""

from pathlib import Path
from typing import Any

import pytest

from helpers.toml_edit import change_keys, write_toml
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model, read_toml
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


def refuse_line(folder: Path, tables: dict[str, Any]) -> str:
    """Problems of a line file with these tables, which must have one."""
    path = write_toml(folder / "line.toml", tables)
    with pytest.raises(InputError) as error:
        read_model(path, LineFile, "line")
    return str(error.value)
