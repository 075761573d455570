"""Formats of a report: what each is called and which module writes it, loaded only when it is asked for."""

from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from pantocheck.conformance.input_files.atomic_writing import write_atomically
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.suggestions import suggest_names
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

_WRITERS = {
    "html": ("html", "write_certificate_html"),
    "pdf": ("pdf", "write_certificate_pdf"),
    "junit": ("junit", "write_junit"),
    "md": ("markdown", "write_markdown"),
    "badge": ("badge", "write_badge"),
}
"""Module and function that write each format; a module is loaded only when its format is asked for."""


def check_formats(names: Sequence[str]) -> tuple[str, ...]:
    """Formats in the order they are written; results.json always is.

    Raises
    ------
    InputError
        There is no such format.
    """
    for name in names:
        if name not in FILES:
            raise InputError(f"format '{name}'", "there is no such format", suggest_names(name, list(FILES)))
    return ("json", *(name for name in FILES if name in names and name != "json"))


def find_writer(name: str) -> Callable[[dict[str, Any], Path], None]:
    """Function that writes results in a format other than json."""
    module, function = _WRITERS[name]
    write: Callable[[dict[str, Any], Path], None] = getattr(
        import_module(f"pantocheck.conformance.reports.formats.{module}"), function
    )
    return write


def write_all(results: Results, folder: Path, formats: Sequence[str]) -> list[Path]:
    """Write results in several formats; where each was written.

    Raises
    ------
    InputError
        a file cannot be written.
    """
    content = results.to_dict()
    for name in formats:
        if name == "json":
            write_atomically(folder / FILES[name], results.to_json())
        else:
            find_writer(name)(content, folder / FILES[name])
    return [folder / FILES[name] for name in formats]
