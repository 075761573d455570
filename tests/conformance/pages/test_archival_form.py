"""Archival form of the PDF: structural checks of PDF/A-3 level A, before and after signing (docs/archival.md)."""

import io
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pypdf import PdfReader, PdfWriter
from pypdf.generic import ArrayObject, DictionaryObject, NameObject, NumberObject, TextStringObject

from helpers import archival_checks
from helpers.archival_checks import find_violations
from helpers.shown_page import print_certificate
from helpers.signed_files import sign
from helpers.signer_fixtures import Signers
from pantocheck.conformance.pages.report_writers import write_pages
from pantocheck.conformance.results.results_format import Results

pytestmark = pytest.mark.thorough

PAGE = Path(__file__).parents[3] / "docs" / "archival.md"


def test_certificates_keep_the_form(certificate: bytes, hostile: dict[str, Any]) -> None:
    assert find_violations(certificate) == []
    assert find_violations(print_certificate(hostile)) == []


def test_signed_certificate(certificate: bytes, signers: Signers, tmp_path: Path) -> None:
    """Visible and invisible signatures keep the archival form, and the first revision byte by byte."""
    document = tmp_path / "certificate.pdf"
    document.write_bytes(certificate)
    signed = sign(sign(document, signers.author, place="top-left"), signers.assessor)
    content = signed.read_bytes()
    assert find_violations(content) == []
    assert content.startswith(certificate)
    # The first part of the identifier names the document, the second part its revision.
    (tmp_path / "again.pdf").write_bytes(certificate)
    signed = sign(tmp_path / "again.pdf", signers.author)
    before, after = (PdfReader(io.BytesIO(content)).trailer["/ID"] for content in (certificate, signed.read_bytes()))
    assert before[0] == after[0]
    assert before[1] != after[1]


def test_parser_of_its_own_finds_no_damage(certificate: bytes, signers: Signers, tmp_path: Path) -> None:
    """A second parser (qpdf) reads every object of the signed certificate without a warning."""
    pikepdf = pytest.importorskip("pikepdf", reason="pikepdf (qpdf) is not installed")
    document = tmp_path / "certificate.pdf"
    document.write_bytes(certificate)
    with pikepdf.open(sign(document, signers.author, place="top-left")) as pdf:
        assert pdf.check_pdf_syntax() == []


def spoil_catalog(key: str, value: Any) -> Callable[[PdfWriter], None]:
    def spoil(writer: PdfWriter) -> None:
        writer.root_object[NameObject(key)] = value

    return spoil


def drop(*keys: str) -> Callable[[PdfWriter], None]:
    """Remove the last key of a path from the catalog."""

    def spoil(writer: PdfWriter) -> None:
        item: Any = writer.root_object
        for key in keys[:-1]:
            item = item[int(key) if key.isdigit() else key].get_object()
        del item[NameObject(keys[-1])]

    return spoil


def add_font(writer: PdfWriter) -> None:
    font = {"/Type": "/Font", "/Subtype": "/Type1", "/BaseFont": "/Helvetica"}
    entries = DictionaryObject({NameObject(key): NameObject(value) for key, value in font.items()})
    writer.pages[0]["/Resources"]["/Font"][NameObject("/F9")] = entries


def hide_annotation(writer: PdfWriter) -> None:
    entries: dict[str, Any] = {"/Subtype": NameObject("/Square"), "/F": NumberObject(2)}
    entries["/Rect"] = ArrayObject(map(NumberObject, (0, 0, 0, 0)))
    annotation = DictionaryObject({NameObject(key): value for key, value in entries.items()})
    writer.pages[0][NameObject("/Annots")] = ArrayObject([annotation])


def unmark(writer: PdfWriter) -> None:
    content = writer.pages[0].get_contents()
    content.set_data(b"0 0 9 9 re f\n" + content.get_data())
    writer.pages[0].replace_contents(content)


SCRIPT = DictionaryObject({NameObject("/S"): NameObject("/JavaScript"), NameObject("/JS"): TextStringObject("0")})

SPOILED: dict[str, Callable[[PdfWriter], None]] = {
    "version": spoil_catalog("/Version", NameObject("/2.0")),
    "identification": lambda writer: writer.xmp_metadata.stream.set_data(b"<x:xmpmeta/>"),
    "metadata": lambda writer: writer.add_metadata({"/Title": "PASS"}), "fonts": add_font,
    "no actions": spoil_catalog("/OpenAction", SCRIPT), "attachments": drop("/AF"), "structure": drop("/Lang"),
    "marked content": unmark, "annotations": hide_annotation,
    "form": spoil_catalog("/AcroForm", DictionaryObject({NameObject("/XFA"): TextStringObject("0")})),
}  # fmt: skip


@pytest.mark.parametrize("name", SPOILED)
def test_checks_detect_violations(certificate: bytes, name: str) -> None:
    writer = PdfWriter(clone_from=io.BytesIO(certificate))
    SPOILED[name](writer)
    buffer = io.BytesIO()
    writer.write(buffer)
    assert name in find_violations(buffer.getvalue())


def test_page_names_every_check() -> None:
    rows = re.findall(r"^\| ([a-z ]+) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    source = Path(archival_checks.__file__).read_text(encoding="utf-8")
    assert [row for row in rows if row != "check"] == re.findall(r'^        "([a-z ]+)": ', source, re.MULTILINE)


@pytest.mark.usefixtures("fresh_figures")
def test_equal_inputs_give_equal_bytes(
    passing: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With `SOURCE_DATE_EPOCH`, every file is the same for a run at another time that took longer."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    later = json.loads(json.dumps(passing | {"started": "2031-01-01T00:00:00Z"}))
    later["cases"][0]["run"] |= {"wall_s": 99.0}
    formats = ("html", "pdf", "md", "junit", "csv", "badge")
    for name, results in (("now", passing), ("later", later)):
        write_pages(Results.model_validate(results), tmp_path / name, formats)
    files = sorted(path.name for path in (tmp_path / "now").iterdir())
    assert len(files) == len(formats)
    different = [
        name for name in files if (tmp_path / "now" / name).read_bytes() != (tmp_path / "later" / name).read_bytes()
    ]
    assert different == []
