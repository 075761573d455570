"""PDF writer: archival, with the results attached, the same every time."""

import hashlib
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from pypdf import PdfReader

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.reports.certificate.certificate_page import build_certificate
from pantocheck.conformance.reports.certificate.criteria_table import describe_criterion
from pantocheck.conformance.reports.formats.embedded_results import strip_times
from pantocheck.conformance.reports.formats.html import render_html
from pantocheck.conformance.reports.formats.pdf import render_pdf
from pantocheck.conformance.reports.formats.report_writers import write_report


def squeeze_text(content: bytes) -> str:
    """All text without white space and break opportunities."""
    text = "".join(page.extract_text() for page in PdfReader(io.BytesIO(content)).pages)
    return re.sub(r"[\s\u200b]", "", text)


def test_pdf_does_not_depend_on_the_time_of_the_run(
    passing: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    write_report(build_certificate(passing), tmp_path / "a.pdf")
    later = passing | {"started": "2031-01-01T00:00:00Z"}
    later["cases"][0]["run"] |= {"wall_s": 99.0}
    write_report(build_certificate(later), tmp_path / "b.pdf")
    assert (tmp_path / "a.pdf").read_bytes() == (tmp_path / "b.pdf").read_bytes()


@pytest.mark.thorough
def test_html_and_pdf_do_not_depend_on_the_process(passing: dict[str, Any], tmp_path: Path) -> None:
    """Another interpreter with another hash seed and time zone writes the same HTML and PDF."""
    source = tmp_path / "results.json"
    source.write_text(json.dumps(passing))
    document = build_certificate(passing)
    program = (
        "import hashlib, json, sys;"
        "from pantocheck.conformance.reports.certificate.certificate_page import build_certificate;"
        "from pantocheck.conformance.reports.formats.html import render_html;"
        "from pantocheck.conformance.reports.formats.pdf import render_pdf;"
        "document = build_certificate(json.load(open(sys.argv[1])));"
        "print(hashlib.sha256(render_html(document).encode() + render_pdf(document)).hexdigest())"
    )
    other = subprocess.run(
        [sys.executable, "-c", program, str(source)],
        env=os.environ | {"PYTHONHASHSEED": "12345", "TZ": "Asia/Tokyo"},
        capture_output=True,
        check=True,
        text=True,
    )
    here = hashlib.sha256(render_html(document).encode() + render_pdf(document))
    assert other.stdout.strip() == here.hexdigest()


def test_pdf_date_is_the_start_of_the_run(
    passing: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    write_report(build_certificate(passing), tmp_path / "a.pdf")
    assert PdfReader(tmp_path / "a.pdf").metadata["/CreationDate"] == "D:20261120235000Z"


@pytest.mark.parametrize("epoch", ["soon", "-1", "1.5", "9" * 40, "", "٣"])
def test_pdf_refuses_a_wrong_source_date(
    passing: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, epoch: str
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
    with pytest.raises(InputError, match="SOURCE_DATE_EPOCH"):
        write_report(build_certificate(passing), tmp_path / "a.pdf")
    assert list(tmp_path.iterdir()) == []


def test_pdf_attachment_is_the_results_without_times(results: dict[str, Any], certificate: bytes) -> None:
    reader = PdfReader(io.BytesIO(certificate))
    [content] = reader.attachments["results.json"]
    assert json.dumps(json.loads(content)) == json.dumps(strip_times(results))  # the order of the rows, too
    assert b'"started": null' in content
    assert b"wall_s" in content
    assert not re.search(rb'"wall_s": [0-9]', content)


def test_pdf_is_archival_a4_with_title(certificate: bytes) -> None:
    reader = PdfReader(io.BytesIO(certificate))
    metadata = reader.xmp_metadata.stream.get_data().decode()
    assert "<pdfaid:part>3</pdfaid:part>" in metadata
    assert "<pdfaid:conformance>A</pdfaid:conformance>" in metadata
    assert reader.metadata.title.startswith("FAIL – Conformance report")
    for page in reader.pages:
        # A4 is 210 mm by 297 mm; one point is 25.4 / 72 mm.
        assert [float(side) * 25.4 / 72 for side in page.mediabox[2:]] == pytest.approx([210, 297], abs=0.1)


def test_pdf_pages_show_verdict_and_number(certificate: bytes) -> None:
    pages = PdfReader(io.BytesIO(certificate)).pages
    for at, page in enumerate(pages, start=1):
        text = page.extract_text()
        assert "FAIL" in text.splitlines()[0]
        assert f"{at} / {len(pages)}" in text


def test_pdf_prints_every_criterion(results: dict[str, Any], certificate: bytes) -> None:
    text = squeeze_text(certificate)
    for case in results["cases"]:
        for row in case["criteria"]:
            shown = describe_criterion(row)
            assert f"{shown.label}{row['quantity']}".replace(" ", "") in text
            expected = f"{shown.pantograph}{shown.value}{shown.error}{shown.limits}{shown.margin}"
            assert expected.replace(" ", "") in text


def test_pdf_prints_hostile_text_literally(hostile: dict[str, Any]) -> None:
    text = squeeze_text(render_pdf(build_certificate(hostile)))
    assert '#import"x.typ":*"])#panic()' in text
    assert "<script>alert(1)</script>" in text
    assert "x" * 300 in text


def test_pdf_embeds_its_fonts(certificate: bytes) -> None:
    fonts = {
        font.get_object()["/BaseFont"].split("+")[-1]
        for page in PdfReader(io.BytesIO(certificate)).pages
        for font in page["/Resources"]["/Font"].values()
    }
    assert fonts
    assert all(name.startswith(("LibertinusSerif", "DejaVuSans")) for name in fonts)


def test_write_report_into_an_unwritable_folder_is_an_input_error(passing: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError):
        write_report(build_certificate(passing), Path(tmp_path, "file", "a.pdf"))
