"""Files of lines and pantographs that another file names: beside it, or in the library."""

from pathlib import Path

from pantocheck.conformance.cases.force_rules import resolve_rule
from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.toml_file import read_model


def locate_part(name: str, folder: Path, where: str) -> Path:
    """Path of a named file: relative to a folder, or else to the library.

    Args:
        name: Name of the file.
        folder: Folder of the file that contains the name.
        where: Place of the name in messages.

    Raises:
        InputError: There is no such file.
    """
    for place in (folder, library_folder()):
        if (place / name).is_file():
            return place / name
    hint = f"Name a file relative to {folder} or to the library, e.g. en50318-2002/line.toml ."
    raise InputError(where, f"there is no file {name!r}", hint)


def read_line_file(path: Path) -> LineFile:
    """Read a line file; InputError if it is invalid."""
    return read_model(path, LineFile, "line")


def read_pantograph_file(path: Path) -> PantographFile:
    """Read a pantograph file and resolve its force rule; InputError if it is invalid."""
    return resolve_rule(read_model(path, PantographFile, "pantograph"), f"pantograph '{path.name}'")
