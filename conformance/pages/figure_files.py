"""Figures of a document as files: each as SVG, and the data behind it as comma-separated values."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from pantocheck.conformance.core.drawn_data import DrawnFigure, render_drawn_data
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.pages.document import Answers, Block, Document, Figure, Figures, Section
from pantocheck.conformance.pages.translation import translate_document

MOST_NAME_LETTERS = 40
"""Largest number of characters of the name of a figure behind its number."""

LETTERS = re.compile(r"[^a-z0-9]+")


def write_figures(document: Document, folder: Path) -> list[Path]:
    """Write the figures of a document in its language, numbered in their order; the data keep their English names.

    Raises:
        InputError: A file cannot be written.
    """
    plain, shown = (list(list_figures(part.blocks)) for part in (document, translate_document(document)))
    files = []
    for number, (figure, translated) in enumerate(zip(plain, shown, strict=True), 1):
        stem = folder / f"{number:02d}-{_name_figure(figure)}"
        files.append(stem.with_suffix(".svg"))
        write_atomically(files[-1], f'<?xml version="1.0" encoding="utf-8"?>\n{translated.svg}'.encode())
        if isinstance(figure.svg, DrawnFigure) and figure.svg.data:
            files.append(stem.with_suffix(".csv"))
            write_atomically(files[-1], render_drawn_data(figure.svg.data).encode())
    return files


def list_figures(blocks: Iterable[Block]) -> Iterator[Figure]:
    """Figures below some blocks, in the order of the page."""
    for block in blocks:
        match block:
            case Figures(figures=figures):
                yield from figures
            case Section(blocks=inner):
                yield from list_figures(inner)
            case Answers(sections=sections):
                yield from list_figures(sections)


def _name_figure(figure: Figure) -> str:
    """Name of a file by the place of a figure, else by its caption."""
    name = LETTERS.sub("-", (figure.anchor or figure.caption).lower()).strip("-")
    kept = name if len(name) <= MOST_NAME_LETTERS else name[:MOST_NAME_LETTERS].rpartition("-")[0]
    return kept or "figure"
