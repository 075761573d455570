"""A document as PDF, typeset by Typst; with embedded results it is PDF/A-3a."""

import json
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.font_file import find_fonts, replace_missing_glyphs
from pantocheck.conformance.core.look import read_look
from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.pages.document import Document, encode_attachment, to_plain
from pantocheck.conformance.pages.translation import collect_marked, translate, translate_document, translate_tree
from pantocheck.conformance.pages.words import bind_page_units, change_texts, read_words
from pantocheck.conformance.results.report_files import ATTACHMENT


def render_pdf(document: Document) -> bytes:
    """PDF of a document.

    The same document gives the same bytes. A document without results bears no date. A character without a glyph is
    printed as U+FFFD; the embedded results keep it.
    """
    words = read_words()
    files = {name: (TEMPLATES / name).read_bytes() for name in ("page.typ", "elements.typ")}
    data = {
        "document": bind_page_units(to_plain(replace(translate_document(document), results=None, scenes=()))),
        "attachment": None,
        "look": read_look(),
        "verdicts": translate_tree(words["verdict"], document.language),
        "trusts": translate_tree(words["trust"], document.language),
        "texts": collect_marked(b"".join(files.values()).decode(), document.language)
        | {name: translate(name, document.language).text for name in words["trust"]},
    }
    if document.results is not None:
        data["attachment"] = ATTACHMENT
        files[ATTACHMENT] = encode_attachment(document.results)
    files["main.typ"] = files.pop("page.typ")
    files["page.json"] = json.dumps(change_texts(data, replace_missing_glyphs)).encode("ascii")
    return typeset(files) if document.results is None else typeset(files, pdf_standards="a-3a", timestamp=document.date)


def typeset(files: dict[str, bytes], **options: Any) -> bytes:
    """PDF of a source `main.typ` with its other files, with the fonts of the suite alone.

    Raises:
        InputError: The extra `pdf` is not installed.
    """
    with refuse_missing_package("a report as PDF"):
        import typst
    # typst takes a dictionary of files, which its type hints do not know.
    sources: Any = files
    # Typst brings Libertinus Serif and DejaVu Sans Mono, matplotlib DejaVu Sans. No font of the machine is used.
    return bytes(typst.compile(sources, ignore_system_fonts=True, font_paths=[str(find_fonts())], **options))


# Appearance of a visible signature, typeset by Typst as a page of its own.
def render_signature_box(lines: Sequence[str], width: int, height: int) -> bytes:
    """PDF of one untagged page [points] with lines of text in a frame, each shrunk to the width of the box."""
    data = {"lines": [replace_missing_glyphs(line) for line in lines], "width": width, "height": height}
    data["ink"] = read_look()["light"]["ink"]
    files = {
        "main.typ": (TEMPLATES / "signature-box.typ").read_bytes(),
        "box.json": json.dumps(data).encode("ascii"),
    }
    return typeset(files, pdf_tags=False)
