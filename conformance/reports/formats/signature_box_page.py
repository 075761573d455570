"""Appearance of a visible signature, typeset by Typst as a page of its own."""

import json
from collections.abc import Sequence

from pantocheck.conformance.input_files.documentation_pages import TEMPLATES
from pantocheck.conformance.reports.formats.pdf import replace_missing_glyphs, typeset


def render_signature_box(lines: Sequence[str], width: int, height: int) -> bytes:
    """PDF of one untagged page with lines of text in a frame.

    Args:
        lines: Lines of text; each is shrunk to the width of the box.
        width, height: Size of the box [points].
    """
    data = {"lines": [replace_missing_glyphs(line) for line in lines], "width": width, "height": height}
    files = {
        "main.typ": (TEMPLATES / "signature-box.typ").read_bytes(),
        "box.json": json.dumps(data).encode("ascii"),
    }
    return typeset(files, pdf_tags=False)
