"""Structural checks of PDF/A-3, level A (ISO 19005-3): a part of its rules, named in docs/archival.md."""

import io
import re
from collections.abc import Iterator
from typing import Any

from pypdf import PdfReader
from pypdf.generic import ArrayObject, DictionaryObject, StreamObject

FORBIDDEN_ACTIONS = {"/JavaScript", "/Launch", "/Sound", "/Movie", "/ResetForm", "/ImportData", "/Hide", "/SetOCGState"}
HIDDEN, PRINTED, INVISIBLE, NO_VIEW = 2, 4, 1, 32
"""Flags of annotations."""


def find_violations(content: bytes) -> list[str]:
    """Violated checks of a PDF, by name; none if the document keeps all of them."""
    reader = PdfReader(io.BytesIO(content), strict=True)
    root = reader.trailer["/Root"]
    objects = list(_list_objects(reader))
    checks = {
        "header": content[:8] == b"%PDF-1.7" and all(byte > 127 for byte in content.splitlines()[1][1:5]),
        "version": root.get("/Version", "/1.7") == "/1.7" and "/Extensions" not in root,
        "no encryption": "/Encrypt" not in reader.trailer,
        "identifier": len(reader.trailer.get("/ID", [])) == 2,
        "identification": _is_identified(reader),
        "metadata": _metadata_agree(reader),
        "colours": _has_output_intent(root),
        "fonts": all(map(_is_embedded, objects)),
        "unicode": all(_has_unicode(item) for item in objects),
        "filters": not any("/LZWDecode" in str(item.get("/Filter", "")) for item in objects),
        "no actions": not any(map(_acts, objects)),
        "attachments": _attachments_are_associated(root, objects),
        "structure": _is_tagged(root),
        "marked content": all(_is_marked(page, root) for page in reader.pages),
        "annotations": all(map(_is_printed, _list_annotations(reader))),
        "form": not {"/XFA", "/NeedAppearances"} & set(root.get("/AcroForm", {})),
        "no external content": not any(map(_is_external, objects)),
        "transparency": "/OutputIntents" in root or not any("/SMask" in item for item in objects),
    }
    return [name for name, kept in checks.items() if not kept]


def _list_objects(reader: PdfReader) -> Iterator[DictionaryObject]:
    """All dictionaries and streams that can be reached, nested ones included."""
    seen: set[int] = set()
    waiting: list[Any] = [reader.trailer]
    while waiting:
        item = waiting.pop()
        item = item.get_object() if hasattr(item, "get_object") else item
        if id(item) in seen:
            continue
        seen.add(id(item))
        if isinstance(item, DictionaryObject):
            yield item
            waiting += [item.raw_get(key) for key in item]
        elif isinstance(item, ArrayObject):
            waiting += list(item)


def _is_identified(reader: PdfReader) -> bool:
    text = _xmp(reader)
    return "<pdfaid:part>3</pdfaid:part>" in text and "<pdfaid:conformance>A</pdfaid:conformance>" in text


def _xmp(reader: PdfReader) -> str:
    stream = reader.trailer["/Root"]["/Metadata"]
    assert "/Filter" not in stream
    return str(stream.get_data().decode("utf-8"))


def _metadata_agree(reader: PdfReader) -> bool:
    """Title and dates of the table of metadata must be those of XMP."""
    text, table = _xmp(reader), reader.metadata
    titles = re.findall(r"<dc:title>.*?<rdf:li[^>]*>(.*?)</rdf:li>", text, re.DOTALL)
    dates = [re.sub(r"\D", "", date)[:14] for date in re.findall(r"<xmp:(?:Create|Modify)Date>(.*?)<", text)]
    stated = [re.sub(r"\D", "", str(table[key]))[:14] for key in ("/CreationDate", "/ModDate") if key in table]
    return len(titles) == 1 and _unescape(titles[0]) == table.title and set(dates) == set(stated)


def _unescape(text: str) -> str:
    from xml.sax.saxutils import unescape

    return unescape(text, {"&quot;": '"', "&apos;": "'"})


def _has_output_intent(root: Any) -> bool:
    (intent,) = root["/OutputIntents"]
    profile = intent.get_object()["/DestOutputProfile"].get_object()
    return intent.get_object()["/S"] == "/GTS_PDFA1" and profile["/N"] == 3 and profile.get_data()[36:40] == b"acsp"


def _is_embedded(item: DictionaryObject) -> bool:
    if item.get("/Type") != "/Font" or item.get("/Subtype") == "/Type0":
        return True  # a composite font is embedded by its descendant
    if item.get("/Subtype") == "/Type3":
        return "/CharProcs" in item
    descriptor = item.get("/FontDescriptor", DictionaryObject()).get_object()
    return any(key in descriptor for key in ("/FontFile", "/FontFile2", "/FontFile3"))


def _is_tagged(root: Any) -> bool:
    return bool(root["/MarkInfo"]["/Marked"]) and "/K" in root["/StructTreeRoot"] and bool(root.get("/Lang"))


def _is_external(item: DictionaryObject) -> bool:
    """Whether a stream refers to another file, or an image to one that replaces it."""
    return "/OPI" in item or (isinstance(item, StreamObject) and "/F" in item)


def _has_unicode(item: DictionaryObject) -> bool:
    """Level A: the text of every font can be extracted."""
    return item.get("/Type") != "/Font" or item.get("/Subtype") != "/Type0" or "/ToUnicode" in item


def _acts(item: DictionaryObject) -> bool:
    return item.get("/S") in FORBIDDEN_ACTIONS or "/AA" in item or "/JS" in item or "/OpenAction" in item


def _attachments_are_associated(root: Any, objects: list[DictionaryObject]) -> bool:
    """Every attachment states its name, its kind and its relation, and belongs to the document."""
    associated = [item.get_object() for item in root.get("/AF", [])]
    for item in objects:
        if "/EF" in item:
            embedded = item["/EF"]["/F"].get_object()
            if not {"/F", "/UF", "/AFRelationship", "/Desc"} <= set(item) or item not in associated:
                return False
            if "/Subtype" not in embedded or "/ModDate" not in embedded["/Params"]:
                return False
    return True


def _is_marked(page: Any, root: Any) -> bool:
    """All content of a page belongs to the structure tree, or is marked as an artifact."""
    depth, marks = 0, set()
    from pypdf.generic import ContentStream

    painting = {b"Tj", b"TJ", b"f", b"F", b"f*", b"S", b"s", b"B", b"B*", b"b", b"b*", b"Do", b"sh", b"'", b'"'}
    for operands, operator in ContentStream(page["/Contents"], page.pdf).operations:
        if operator in (b"BDC", b"BMC"):
            depth += 1
            properties = operands[1] if len(operands) > 1 and isinstance(operands[1], dict) else {}
            if "/MCID" in properties:
                marks.add(int(properties["/MCID"]))
        elif operator == b"EMC":
            depth -= 1
        elif operator in painting and depth == 0:
            return False
    if not marks:
        return True
    return _count_parents(root["/StructTreeRoot"]["/ParentTree"], int(page["/StructParents"])) > max(marks)


def _count_parents(tree: Any, key: int) -> int:
    """Number of marks of a page that the tree of parents holds."""
    for kid in tree.get("/Kids", []):
        low, high = kid.get_object()["/Limits"]
        if low <= key <= high:
            return _count_parents(kid.get_object(), key)
    numbers = tree.get("/Nums", [])
    for at in range(0, len(numbers), 2):
        if numbers[at] == key:
            return len(numbers[at + 1].get_object())
    return 0


def _list_annotations(reader: PdfReader) -> Iterator[Any]:
    for page in reader.pages:
        for annotation in page.get("/Annots", []):
            yield annotation.get_object()


def _is_printed(annotation: Any) -> bool:
    """An annotation is printed and not hidden; one with an area has an appearance."""
    flags = int(annotation.get("/F", 0))
    if annotation.get("/Subtype") == "/Popup":
        return True
    left, bottom, right, top = map(float, annotation["/Rect"])
    empty = left == right or bottom == top
    appears = empty or annotation["/Subtype"] == "/Link" or isinstance(annotation["/AP"]["/N"], StreamObject)
    return bool(flags & PRINTED) and not flags & (HIDDEN | INVISIBLE | NO_VIEW) and appears
