"""Parts of a PDF that Pantocheck never writes, and that could act or show other content.

Scripts, actions, forms, layers, annotations and further attachments change the visible content or act on opening. The
search covers every object of the file, also those that no page uses.
"""

from collections.abc import Iterator
from typing import Any

from pypdf import PdfReader
from pypdf.generic import ArrayObject, DictionaryObject, IndirectObject, NameObject

from pantocheck.conformance.reports.formats.embedded_results import NAME

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
    """Parts that Pantocheck never writes.

    Args:
        reader: Document.
        content: Content of the document.

    Yields:
        One sentence per kind of part.
    """
    if not content.startswith(b"%PDF-"):
        yield "bytes stand before the header of the PDF"
    try:
        names = [name for name, contents in reader.attachments.items() for _ in contents]
        found = {part for number in _list_objects(reader) for part in _find_parts(number, DEEPEST_SEARCHED)}
    except Exception as error:  # the parser has no common base of its exceptions
        yield f"an object of the file cannot be read ({type(error).__name__})"
        return
    yield from (f"a further attachment {name!r}" for name in names if name != NAME)
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
        inner = item.keys() - {"/A"} if _is_structure(item) else item.keys()
        yield from (FOREIGN_KEYS[key] for key in inner if key in FOREIGN_KEYS)
        for key in item:
            value = item.raw_get(key)
            if key in ("/S", "/Type", "/Subtype") and isinstance(value, NameObject) and value in FOREIGN_TYPES:
                yield f"an object of the type {value.removeprefix('/')}"
            yield from _find_parts(value, depth - 1)
    elif isinstance(item, ArrayObject):
        for value in item:
            yield from _find_parts(value, depth - 1)


def _is_structure(item: DictionaryObject) -> bool:
    return "/P" in item and "/S" in item and item.get("/Type", "/StructElem") == "/StructElem"
