"""Files of a report: one for each format, and the formats of a run that states none."""

from collections.abc import Sequence
from typing import Literal, get_args

from pantocheck.conformance.core.extras import is_installed, require_package
from pantocheck.conformance.core.input_error import InputError, suggest_names

Language = Literal["en", "de", "fr", "it", "es"]
"""Language of a certificate and of its summary."""

LANGUAGES: tuple[Language, ...] = get_args(Language)
"""All languages; the first one is that of the source texts."""

FILES = {
    "html": "certificate.html",
    "pdf": "certificate.pdf",
    "json": "results.json",
    "csv": "quantities.csv",
    "xlsx": "results.xlsx",
    "junit": "junit.xml",
    "md": "summary.md",
    "badge": "badge.svg",
    "annotations": "annotations.txt",
    "codequality": "codequality.json",
    "figures": "figures",
}
"""File that each format is written to; of the figures, their folder."""

ATTACHMENT = FILES["json"]
"""Name of the results inside a PDF."""

BLOCK_ID = "pantocheck-results"
"""Identity of the data block of an HTML page with the results, a script element that no browser executes."""

DEFAULT_FORMATS = ("html", "pdf", "json", "csv", "junit", "md")
"""Formats of a run that states none."""


def check_formats(stated: Sequence[str] | None) -> tuple[str, ...]:
    """Formats in the order of writing; results.json is always written.

    Args:
        stated: Formats that the user states. None: `DEFAULT_FORMATS`, without PDF if its extra is not installed
            (`remark_missing_formats` says so).

    Raises:
        InputError: Unknown format, or the extra of a stated format is not installed.
    """
    if stated is None:
        return tuple(name for name in _order_formats(DEFAULT_FORMATS) if name != "pdf" or is_installed("typst"))
    if "pdf" in stated:
        require_package("typst", "format 'pdf'")
    if "xlsx" in stated:
        require_package("openpyxl", "format 'xlsx'")
    return _order_formats(stated)


def _order_formats(names: Sequence[str]) -> tuple[str, ...]:
    for name in names:
        if name not in FILES:
            raise InputError(f"format '{name}'", "there is no such format", suggest_names(name, list(FILES)))
    return ("json", *(name for name in FILES if name in names and name != "json"))
