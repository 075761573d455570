"""A report of headings, texts, tables and figures, as one HTML file and as PDF: that of a mass drop."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import typst

from pantocheck.conformance.input_files.atomic_writing import write_atomically
from pantocheck.conformance.reports.formats.html import build_environment
from pantocheck.conformance.reports.formats.pdf import FONTS, find_showable
from pantocheck.conformance.reports.page_text import clean_tree
from pantocheck.conformance.reports.words import TEMPLATES


@dataclass(frozen=True)
class Picture:
    """A figure: its SVG, what a reader who cannot see it should know, and its caption."""

    svg: str
    alternative: str
    caption: str


@dataclass(frozen=True)
class Grid:
    """A table: heads of the columns, rows of texts."""

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str


@dataclass(frozen=True)
class Section:
    """A heading and what stands under it."""

    heading: str
    texts: tuple[str, ...] = ()
    grids: tuple[Grid, ...] = ()
    pictures: tuple[Picture, ...] = ()
    code: str = ""


@dataclass(frozen=True)
class Document:
    """A report.

    Parameters
    ----------
    title : str
        What it is on.
    headline : str
        The result in a sentence.
    warnings : tuple[str, ...]
        What should make a reader careful.
    sections : tuple[Section, ...]
        The rest.
    """

    title: str
    headline: str
    warnings: tuple[str, ...]
    sections: tuple[Section, ...]


def write_html(document: Document, path: Path) -> None:
    """Write a report as one HTML file: no script, nothing fetched, every text escaped.

    Raises
    ------
    InputError
        It cannot be written.
    """
    text = build_environment().get_template("document.html").render(document=_plain(document))
    write_atomically(path, text.encode("utf-8"))


def write_pdf(document: Document, path: Path) -> None:
    """Write a report as PDF; it bears no date, so that the same report gives the same bytes.

    Raises
    ------
    InputError
        It cannot be written.
    """
    # typst takes a dictionary of files, which its type hints do not know.
    sources: Any = {
        "main.typ": (TEMPLATES / "document.typ").read_bytes(),
        "document.json": json.dumps(find_showable(_plain(document))).encode("ascii"),
    }
    made = typst.compile(sources, ignore_system_fonts=True, font_paths=[str(FONTS)])
    write_atomically(path, bytes(made))


def _plain(document: Document) -> dict[str, Any]:
    """The report as plain data, its texts cleaned; pictures and code are the project's own and stay as they are."""
    data = asdict(document)
    pictures = [[picture.pop("svg") for picture in section["pictures"]] for section in data["sections"]]
    codes = [section.pop("code") for section in data["sections"]]
    shown: dict[str, Any] = clean_tree(data)
    for section, svgs, code in zip(shown["sections"], pictures, codes, strict=True):
        section["code"] = code
        for picture, svg in zip(section["pictures"], svgs, strict=True):
            picture["svg"] = svg
    return shown
