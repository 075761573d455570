"""Comparison of a PDF with the one that its results give: number of pages, metadata, texts, drawings, attachments."""

from collections.abc import Iterator
from io import BytesIO
from typing import Any

from pypdf import PageObject, PdfReader
from pypdf.generic import ArrayObject, DictionaryObject, IndirectObject, PdfObject, StreamObject

from pantocheck.conformance.authenticity.text_differences import compare_lines, quote_difference
from pantocheck.conformance.input_files.input_error import InputError

DEEPEST_COMPARED = 60
"""Deepest nesting of objects that is compared; the pages of a certificate have less than 20 levels."""


def read_date(reader: PdfReader, name: str) -> int:
    """Date in the metadata of a PDF [s since 1970]; 0 if there is none.

    Args:
        reader: Document.
        name: Name of the file in messages.

    Raises:
        InputError: The date cannot be read.
    """
    try:
        date = reader.metadata.creation_date if reader.metadata else None
        return 0 if date is None else max(0, int(date.timestamp()))
    except Exception:
        raise InputError(name, "a date of creation that is no date", "Request the certificate again.") from None


def read_title_and_heading(reader: PdfReader, beginning: str) -> tuple[str, str]:
    """Title in the metadata, and first line of the first page with a beginning; empty if there is none."""
    try:
        title = str((reader.metadata.title if reader.metadata else None) or "")
        lines = _read_lines(reader.pages[0])
    except Exception:  # the parser has no common base of its exceptions
        return "", ""
    return title, next((line for line in lines if line.startswith(beginning)), "")


def compare_pdfs(stated: PdfReader, expected: bytes) -> list[str]:
    """Differences of a PDF from the expected one; at least one.

    Args:
        stated: Document, whose bytes differ.
        expected: Document that the results give.
    """
    other = PdfReader(BytesIO(expected))
    try:
        found = [*_compare_metadata(stated, other), *compare_texts(stated, expected), *_compare_drawings(stated, other)]
        found += _compare_attachments(stated, other)
    except Exception as error:  # the parser has no common base of its exceptions
        found = [f"an object of the file cannot be read ({type(error).__name__})"]
    return found or ["the file was written again by another program; pages and attachment are equal, its bytes are not"]


def compare_texts(stated: PdfReader, expected: bytes) -> list[str]:
    """First difference of the text of every page; parameters as in `compare_pdfs`."""
    other = PdfReader(BytesIO(expected))
    pages, others = len(stated.pages), len(other.pages)
    found = [] if pages == others else [f"the document has {pages} pages, {others} follow from the results"]
    for number in range(min(pages, others)):
        try:
            lines, wanted = (_read_lines(reader.pages[number]) for reader in (stated, other))
        except Exception as error:
            found.append(f"page {number + 1}: the text cannot be read ({type(error).__name__})")
            continue
        found += [f"page {number + 1}: {text}" for text in compare_lines(lines, wanted)]
    return found


def _read_lines(page: PageObject) -> list[str]:
    return [line for line in page.extract_text().splitlines() if line.strip()]


def _compare_metadata(stated: PdfReader, expected: PdfReader) -> Iterator[str]:
    metadata, others = dict(stated.metadata or {}), dict(expected.metadata or {})
    for key in sorted(metadata.keys() | others.keys()):
        if metadata.get(key) != others.get(key):
            texts = (None if item.get(key) is None else str(item[key]) for item in (metadata, others))
            value, wanted = quote_difference(*texts)
            yield f"metadata {key.removeprefix('/')}: {value}; {wanted} follows from the results"


def _compare_drawings(stated: PdfReader, expected: PdfReader) -> Iterator[str]:
    """Parts of every page, object by object."""
    for number, (page, other) in enumerate(zip(stated.pages, expected.pages, strict=False), 1):
        for key in sorted((page.keys() | other.keys()) - {"/Parent", "/StructParents"}):
            if not _same(page.get(key), other.get(key), DEEPEST_COMPARED):
                yield f"page {number}: {_PARTS.get(key, key)} differs from that of the results"


_PARTS = {
    "/Contents": "the drawing (lines, colours, places of text)",
    "/Resources": "a figure, image or font",
    "/Annots": "an annotation",
    "/MediaBox": "the size of the page",
}


def _compare_attachments(stated: PdfReader, expected: PdfReader) -> Iterator[str]:
    for name, contents in expected.attachments.items():
        if list(map(bytes, stated.attachments.get(name, []))) != list(map(bytes, contents)):
            yield f"the attachment {name} is not as Pantocheck writes it: keys, their order, digits or spaces differ"


def _same(a: Any, b: Any, depth: int) -> bool:
    """Whether two objects have the same content; references are followed, except to pages."""
    a, b = (item.get_object() if isinstance(item, IndirectObject) else item for item in (a, b))
    if depth == 0:
        return True
    if isinstance(a, DictionaryObject) and isinstance(b, DictionaryObject):
        if a.get("/Type") == b.get("/Type") == "/Page":
            return True
        if isinstance(a, StreamObject) != isinstance(b, StreamObject) or _keys(a) != _keys(b):
            return False
        if isinstance(a, StreamObject) and isinstance(b, StreamObject) and a.get_data() != b.get_data():
            return False
        return all(_same(a.get(key), b.get(key), depth - 1) for key in _keys(a))
    if isinstance(a, ArrayObject) and isinstance(b, ArrayObject):
        return len(a) == len(b) and all(_same(x, y, depth - 1) for x, y in zip(a, b, strict=True))
    return type(a) is type(b) and isinstance(a, PdfObject | None) and a == b


def _keys(item: DictionaryObject) -> set[str]:
    """Keys with a meaning for the reader: the compression of a stream has none."""
    return set(item.keys()) - {"/Length", "/Filter", "/DecodeParms", "/Parent"}
