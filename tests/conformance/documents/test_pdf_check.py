"""Comparison of a PDF with the expected one: metadata and attachments; depth of the search for foreign parts."""

import io
from functools import reduce

import pytest
from pypdf import PdfReader, PdfWriter
from pypdf.generic import DictionaryObject, NameObject

from pantocheck.conformance.documents.pdf_check import DEEPEST_SEARCHED, compare_pdfs, list_foreign_parts


def write(title: str = "FAIL", attached: bytes = b"{}", nested: int = 0, pages: int = 1) -> bytes:
    """PDF with empty pages; `nested` is the depth of an object that no page uses."""
    writer = PdfWriter()
    for _ in range(pages):
        writer.add_blank_page(100, 100)
    writer.add_metadata({"/Title": title})
    writer.add_attachment("results.json", attached)
    if nested:
        innermost = DictionaryObject()
        item = reduce(lambda inner, _: DictionaryObject({NameObject("/Key"): inner}), range(nested), innermost)
        writer._add_object(item)
    buffer = io.BytesIO()
    writer.write(buffer)
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("stated", "text"),
    [
        (write(title="PASS"), "metadata Title: 'PASS'; 'FAIL' follows from the results"),
        (write(attached=b"{ }"), "the attachment results.json is not as Pantocheck writes it"),
        (write(pages=2), "the document has 2 pages, 1 follow from the results"),
        (write(), "the file was written again by another program"),
    ],
)
def test_each_difference_is_named_alone(stated: bytes, text: str) -> None:
    (found,) = compare_pdfs(PdfReader(io.BytesIO(stated)), write())[0]
    assert found.startswith(text)


def test_page_whose_text_cannot_be_read_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_: object) -> None:
        raise ValueError

    monkeypatch.setattr("pypdf.PageObject.extract_text", fail)
    (text,) = compare_pdfs(PdfReader(io.BytesIO(write())), write())[1]
    assert text == "page 1: the text cannot be read (ValueError)"


def test_objects_are_searched_to_a_depth() -> None:
    for nested, found in ((DEEPEST_SEARCHED - 10, False), (DEEPEST_SEARCHED + 10, True)):
        content = write(nested=nested)
        texts = list(list_foreign_parts(PdfReader(io.BytesIO(content)), content))
        assert any("nested too deeply" in text for text in texts) == found
