"""Files of a case: case file, line, pantographs and damping models."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.damping_file import Damping, DampingFile, overlay_damping
from pantocheck.conformance.cases.force_rules import resolve_rule
from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.toml_file import read_model, validate_model

LONGEST_NAME = 200
"""Largest number of characters of a file name that is looked up in an invalid case file."""


def read_parts(path: Path, tree: dict[str, Any]) -> Case:
    """Read the files of a case.

    Parameters
    ----------
    path : Path
        Case file.
    tree : dict
        Its content.

    Returns
    -------
    Case
        Case whose files are valid, each by itself.

    Raises
    ------
    InputError
        A file cannot be read or is invalid; the error is that of the first such file.
    """
    file = _validate_case(path, tree)
    line = _read_line(path, file.line)
    if file.damping is not None:
        damping = _read_damping(path, file.damping, "damping") if isinstance(file.damping, str) else file.damping
        line = line.model_copy(update={"damping": overlay_damping(line.damping, damping)})
    pantographs = tuple(
        _read_pantograph(path, use.model, f"pantograph[{i}].model") for i, use in enumerate(file.pantograph, 1)
    )
    static_pantograph = None
    if file.apparent_mass is not None:
        static_pantograph = _read_pantograph(path, file.apparent_mass.model, "apparent_mass.model")
    models = dict(file.mass_drop.compared) if file.mass_drop is not None else {}
    models |= getattr(file.study, "models", {}) | getattr(file.study, "before", {})
    dampings = {name: _read_damping(path, model, f"damping model {name!r}") for name, model in models.items()}
    return Case(file, line, pantographs, file.limit, static_pantograph, dampings)


def list_part_errors(path: Path, tree: dict[str, Any]) -> Iterator[InputError]:
    """Errors of the line and the pantographs that a case file names, whether or not the case file is valid.

    Parameters
    ----------
    path : Path
        Case file.
    tree : dict
        Its content.

    Yields
    ------
    InputError
        Error of one file.
    """
    uses = tree.get("pantograph")
    readings: list[tuple[Callable[[str], object], object]] = [(partial(_read_line, path), tree.get("line"))]
    for i, use in enumerate(uses if isinstance(uses, list) else (), 1):
        if isinstance(use, dict):
            readings.append((partial(_read_pantograph, path, key=f"pantograph[{i}].model"), use.get("model")))
    for read, name in readings:
        if isinstance(name, str) and 0 < len(name) <= LONGEST_NAME:
            try:
                read(name)
            except InputError as error:
                yield error


def _validate_case(path: Path, tree: dict[str, Any]) -> CaseFile:
    return validate_model(tree, CaseFile, f"case '{path.name}'")


def _read_line(case_path: Path, name: str) -> LineFile:
    return read_model(_locate(case_path, name, "line"), LineFile, "reference line")


def _read_damping(case_path: Path, name: str, key: str) -> Damping:
    return read_model(_locate(case_path, name, key), DampingFile, "damping").damping


def _read_pantograph(case_path: Path, name: str, key: str) -> PantographFile:
    path = _locate(case_path, name, key)
    return resolve_rule(read_model(path, PantographFile, "pantograph"), f"pantograph '{path.name}'")


def _locate(case_path: Path, name: str, key: str) -> Path:
    """Path of a file named in a case: relative to the case file, or else to the library."""
    for folder in (case_path.parent, library_folder()):
        if (folder / name).is_file():
            return folder / name
    raise InputError(
        f"case '{case_path.name}', key {key}",
        f"there is no file {name!r}",
        f"Name a file relative to {case_path.parent} or to the library, e.g. en50318-2002/line.toml .",
    )
