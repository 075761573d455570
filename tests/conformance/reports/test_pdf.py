"""The PDF certificate: archival, with its results inside, the same every time."""

import hashlib
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from pypdf import PdfReader

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.reports.certificate.criteria_rows import build_criterion_row
from pantocheck.conformance.reports.formats import html, pdf
from pantocheck.conformance.reports.formats.embedding import strip_times


def words_of(content: bytes) -> str:
    """All text without white space and break opportunities."""
    text = "".join(page.extract_text() for page in PdfReader(io.BytesIO(content)).pages)
    return re.sub(r"[\s\u200b]", "", text)


def test_same_input_gives_the_same_bytes_whenever_it_ran(passing, tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    pdf.write_certificate_pdf(passing, tmp_path / "a.pdf")
    later = passing | {"started": "2031-01-01T00:00:00Z"}
    later["cases"][0]["run"] |= {"wall_s": 99.0}
    pdf.write_certificate_pdf(later, tmp_path / "b.pdf")
    assert (tmp_path / "a.pdf").read_bytes() == (tmp_path / "b.pdf").read_bytes()


def test_bytes_do_not_depend_on_the_process(passing, tmp_path):
    """Another interpreter with another hash seed and time zone writes the same HTML and PDF."""
    source = tmp_path / "results.json"
    source.write_text(json.dumps(passing))
    program = (
        "import hashlib, json, sys; from pantocheck.conformance.reports.formats import html, pdf;"
        "r = json.load(open(sys.argv[1]));"
        "print(hashlib.sha256(html.render_html(r).encode() + pdf.render_pdf(r, 1)).hexdigest())"
    )
    other = subprocess.run(
        [sys.executable, "-c", program, str(source)],
        env=os.environ | {"PYTHONHASHSEED": "12345", "TZ": "Asia/Tokyo"},
        capture_output=True,
        check=True,
        text=True,
    )
    here = hashlib.sha256(html.render_html(passing).encode() + pdf.render_pdf(passing, 1))
    assert other.stdout.strip() == here.hexdigest()


def test_date_is_the_start_of_the_run(passing, tmp_path, monkeypatch):
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    pdf.write_certificate_pdf(passing, tmp_path / "a.pdf")
    assert PdfReader(tmp_path / "a.pdf").metadata["/CreationDate"] == "D:20261120235000Z"


@pytest.mark.parametrize("given", ["soon", "-1", "1.5", "9" * 40, "", "٣"])
def test_wrong_source_date_is_refused(passing, tmp_path, monkeypatch, given):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", given)
    with pytest.raises(InputError, match="SOURCE_DATE_EPOCH"):
        pdf.write_certificate_pdf(passing, tmp_path / "a.pdf")
    assert list(tmp_path.iterdir()) == []


def test_attachment_is_the_results_without_times(results, certificate):
    reader = PdfReader(io.BytesIO(certificate))
    [content] = reader.attachments["results.json"]
    assert json.loads(content) == json.loads(json.dumps(strip_times(results)))
    assert b'"started": null' in content
    assert b"wall_s" in content
    assert not re.search(rb'"wall_s": [0-9]', content)


def test_archival_format_a4_and_title(certificate):
    reader = PdfReader(io.BytesIO(certificate))
    metadata = reader.xmp_metadata.stream.get_data().decode()
    assert "<pdfaid:part>3</pdfaid:part>" in metadata
    assert "<pdfaid:conformance>A</pdfaid:conformance>" in metadata
    assert reader.metadata.title.startswith("FAIL – Conformance report")
    for page in reader.pages:
        # A4 is 210 mm by 297 mm; one point is 25.4 / 72 mm.
        assert [float(side) * 25.4 / 72 for side in page.mediabox[2:]] == pytest.approx([210, 297], abs=0.1)


def test_every_page_has_verdict_and_number(certificate):
    pages = PdfReader(io.BytesIO(certificate)).pages
    for at, page in enumerate(pages, start=1):
        text = page.extract_text()
        assert "FAIL" in text.splitlines()[0]
        assert f"{at} / {len(pages)}" in text


def test_every_criterion_is_printed(results, certificate):
    text = words_of(certificate)
    for case in results["cases"]:
        for row in case["criteria"]:
            shown = build_criterion_row(row, [])
            assert f"{shown.label}{shown.quantity}".replace(" ", "") in text
            expected = f"{shown.pantograph}{shown.value}{shown.unit}{shown.error}{shown.limits}{shown.margin}"
            assert expected.replace(" ", "") in text


def test_hostile_text_stays_text(hostile):
    text = words_of(pdf.render_pdf(hostile, 1))
    assert '#import"x.typ":*"])#panic()' in text
    assert "<script>alert(1)</script>" in text
    assert "x" * 300 in text


def test_fonts_are_embedded_and_none_is_the_machines(certificate):
    fonts = {
        font.get_object()["/BaseFont"].split("+")[-1]
        for page in PdfReader(io.BytesIO(certificate)).pages
        for font in page["/Resources"]["/Font"].values()
    }
    assert fonts
    assert all(name.startswith(("LibertinusSerif", "DejaVuSans")) for name in fonts)


def test_unwritable_folder_is_an_input_error(passing, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError):
        pdf.write_certificate_pdf(passing, Path(tmp_path, "file", "a.pdf"))
