"""Formats of a report: what each is called and which module writes it, loaded only when it is asked for."""

from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from pantocheck.conformance.input_files.atomic_writing import write_in_place
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.suggestions import nearest
from pantocheck.conformance.results.results_format import Results

FILES = {
    "html": "certificate.html",
    "pdf": "certificate.pdf",
    "json": "results.json",
    "junit": "junit.xml",
    "md": "summary.md",
    "badge": "badge.svg",
}
"""File that each format is written to."""

_MODULES = {"html": "html", "pdf": "pdf", "junit": "junit", "md": "markdown", "badge": "badge"}


def checked_formats(names: Sequence[str]) -> tuple[str, ...]:
    """Formats in the order they are written; results.json always is.

    Raises
    ------
    InputError : there is no such format
    """
    for name in names:
        if name not in FILES:
            raise InputError(f"format '{name}'", "there is no such format", nearest(name, list(FILES)))
    return ("json", *(name for name in FILES if name in names and name != "json"))


def writer(name: str) -> Callable[[dict[str, Any], Path], None]:
    """Function that writes results in a format other than json."""
    write: Callable[[dict[str, Any], Path], None] = import_module(
        f"pantocheck.conformance.reports.formats.{_MODULES[name]}"
    ).write
    return write


def write_all(results: Results, folder: Path, formats: Sequence[str]) -> list[Path]:
    """Write results in several formats; where each was written.

    Raises
    ------
    InputError : a file cannot be written
    """
    content = results.to_dict()
    for name in formats:
        if name == "json":
            write_in_place(folder / FILES[name], results.to_json())
        else:
            writer(name)(content, folder / FILES[name])
    return [folder / FILES[name] for name in formats]
