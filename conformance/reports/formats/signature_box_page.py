"""Appearance of a visible signature, typeset by Typst as a page of its own."""

import json
from collections.abc import Sequence
from typing import Any

import typst

from pantocheck.conformance.reports.formats.pdf import FONTS, replace_missing_glyphs
from pantocheck.conformance.reports.words import TEMPLATES


def render_signature_box(lines: Sequence[str], width: int, height: int) -> bytes:
    """PDF of one untagged page with lines of text in a frame.

    Parameters
    ----------
    lines : sequence of str
        Lines of text; each is shrunk to the width of the box.
    width, height : int
        Size of the box [points].
    """
    data = {"lines": [replace_missing_glyphs(line) for line in lines], "width": width, "height": height}
    # typst takes a dictionary of files, which its type hints do not know.
    files: Any = {
        "main.typ": (TEMPLATES / "signature-box.typ").read_bytes(),
        "box.json": json.dumps(data).encode("ascii"),
    }
    return bytes(typst.compile(files, ignore_system_fonts=True, font_paths=[str(FONTS)], pdf_tags=False))
