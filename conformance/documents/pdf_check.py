"""Parts of a PDF that Pantocheck never writes, and that could act or show other content.

Scripts, actions, forms, layers, annotations and further attachments change the visible content or act on opening. The
search covers every object of the file, also those that no page uses.
"""

from collections.abc import Iterator
from io import BytesIO
from typing import Any

from pypdf import PageObject, PdfReader
from pypdf.generic import ArrayObject, DictionaryObject, IndirectObject, NameObject, PdfObject, StreamObject

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.authenticity_check import compare_lines, quote_difference
from pantocheck.conformance.results.report_files import ATTACHMENT

FOREIGN_KEYS = {
    "/JavaScript": "a script",
    "/JS": "a script",
    "/OpenAction": "an action on opening",
    "/AA": "an action on an event",
    "/A": "an action",
    "/Launch": "an action that starts a program",
    "/AcroForm": "a form",
    "/XFA": "a form with scripts",
    "/OCProperties": "layers that a reader can hide",
    "/RichMedia": "embedded media",
    "/Annots": "annotations on a page",
    "/Collection": "a portfolio of files",
    "/Perms": "usage rights",
}
"""Keys of a PDF (ISO 32000-1) with the parts that they define."""

FOREIGN_TYPES = {
    "/JavaScript",
    "/Launch",
    "/URI",
    "/SubmitForm",
    "/ImportData",
    "/GoToR",
    "/GoToE",
    "/Rendition",
    "/OCG",
}
"""Names that stand as the type of a foreign part."""

DEEPEST_SEARCHED = 100
"""Deepest nesting inside one object."""


def list_foreign_parts(reader: PdfReader, content: bytes) -> Iterator[str]:
    """Parts that Pantocheck never writes."""
    if not content.startswith(b"%PDF-"):
        yield "bytes stand before the header of the PDF"
    try:
        names = [name for name, contents in reader.attachments.items() for _ in contents]
        found = {part for number in _list_objects(reader) for part in _find_parts(number, DEEPEST_SEARCHED)}
    except Exception as error:  # the parser has no common base of its exceptions
        yield f"an object of the file cannot be read ({type(error).__name__})"
        return
    yield from (f"a further attachment {name!r}" for name in names if name != ATTACHMENT)
    yield from (f"the file has {part}" for part in sorted(found))


def _list_objects(reader: PdfReader) -> Iterator[Any]:
    """All objects of the file, also those inside object streams and those that nothing refers to."""
    yield reader.trailer
    for generation, offsets in reader.xref.items():
        for number in offsets:
            yield reader.get_object(IndirectObject(number, generation, reader))
    for number in reader.xref_objStm:
        yield reader.get_object(IndirectObject(number, 0, reader))


def _find_parts(item: Any, depth: int) -> Iterator[str]:
    """Names of foreign parts inside one object; references are not followed, because every object is searched."""
    if depth == 0:
        yield "objects that are nested too deeply"
    elif isinstance(item, DictionaryObject):
        # In a structure element, /A holds attributes such as the size of a figure.
        structure = "/P" in item and "/S" in item and item.get("/Type", "/StructElem") == "/StructElem"
        inner = item.keys() - {"/A"} if structure else item.keys()
        yield from (FOREIGN_KEYS[key] for key in inner if key in FOREIGN_KEYS)
        for key in item:
            value = item.raw_get(key)
            if key in ("/S", "/Type", "/Subtype") and isinstance(value, NameObject) and value in FOREIGN_TYPES:
                yield f"an object of the type {value.removeprefix('/')}"
            yield from _find_parts(value, depth - 1)
    elif isinstance(item, ArrayObject):
        for value in item:
            yield from _find_parts(value, depth - 1)


# Comparison of a PDF with the one that its results give: number of pages, metadata, texts, drawings, attachments.
DEEPEST_COMPARED = 60
"""Deepest nesting of objects that is compared; the pages of a certificate have less than 20 levels."""


def read_date(reader: PdfReader, name: str) -> int:
    """Date in the metadata of a PDF [s since 1970]; 0 if there is none.

    Raises:
        InputError: The date cannot be read.
    """
    try:
        date = reader.metadata.creation_date if reader.metadata else None
        return 0 if date is None else max(0, int(date.timestamp()))
    except Exception:
        raise InputError(name, "has a date of creation that is not a date", "Request the certificate again.") from None


def read_language(reader: PdfReader) -> str:
    """Language that a PDF states; empty if it states none."""
    return str(reader.root_object.get("/Lang", ""))


def read_title_and_heading(reader: PdfReader, beginning: str) -> tuple[str, str]:
    """Title in the metadata, and first line of the first page with a beginning; empty if there is none."""
    try:
        title = str((reader.metadata.title if reader.metadata else None) or "")
        lines = _read_lines(reader.pages[0])
    except Exception:  # the parser has no common base of its exceptions
        return "", ""
    return title, next((line for line in lines if line.startswith(beginning)), "")


def compare_pdfs(stated: PdfReader, expected: bytes) -> tuple[list[str], list[str]]:
    """Differences of a PDF from the expected one, at least one; and those of the text of every page alone."""
    other = PdfReader(BytesIO(expected))
    texts = _compare_texts(stated, other)
    try:
        found = [*_compare_metadata(stated, other), *texts, *_compare_drawings(stated, other)]
        found += _compare_attachments(stated, other)
    except Exception as error:  # the parser has no common base of its exceptions
        found = [f"an object of the file cannot be read ({type(error).__name__})"]
    rewritten = "the file was written again by another program; pages and attachment are equal, its bytes are not"
    return found or [rewritten], texts


def _compare_texts(stated: PdfReader, other: PdfReader) -> list[str]:
    """First difference of the text of every page."""
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
