"""Search of a folder for input files."""

import os
from collections.abc import Iterator
from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.table_formats import CSV
from pantocheck.conformance.input_files.toml_file import read_toml
from pantocheck.conformance.line_tables.line_table_check import read_line_table
from pantocheck.conformance.own_files.file_kinds import list_keys
from pantocheck.conformance.schemas import READ_FORMATS

SKIPPED_FOLDERS = ("build", "node_modules", "__pycache__")
"""Names of folders with files of tools."""

ENVIRONMENT_FILE = "pyvenv.cfg"
"""File in the folder of a virtual environment."""


def list_input_files(folder: Path) -> Iterator[Path]:
    """List the input files of a folder and of the folders below it.

    Hidden folders, virtual environments and `SKIPPED_FOLDERS` below the folder are left out.

    Yields:
        TOML file with a key of any kind of input file, or that cannot be read; table of supports or droppers. A sidecar
        stands for its table.
    """
    for parent, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not _is_skipped(Path(parent, name)))
        yield from (path for name in sorted(names) if _is_input(path := Path(parent, name)))


def _is_skipped(folder: Path) -> bool:
    return folder.name.startswith(".") or folder.name in SKIPPED_FOLDERS or (folder / ENVIRONMENT_FILE).is_file()


def _is_input(path: Path) -> bool:
    suffix = path.suffix.lower()
    if suffix in CSV.suffixes:
        return not path.with_suffix(".toml").is_file() and read_line_table(path) is not None
    if suffix != ".toml":
        return False
    try:
        return not read_toml(path, "file").keys().isdisjoint(set().union(*map(list_keys, READ_FORMATS.values())))
    except InputError:
        return True
