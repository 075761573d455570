"""PDF writer: archival, with the results attached, the same every time."""

import hashlib
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any, Literal

import pytest
from pypdf import PdfReader

from helpers.shown_page import certify, print_certificate
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pages.criteria_table import describe_criterion
from pantocheck.conformance.pages.document import (
    Code,
    Column,
    Document,
    Paragraph,
    PlainHeader,
    Section,
    Table,
    strip_times,
)
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.pages.report_writers import write_report
from pantocheck.conformance.results.results_format import Results


def squeeze_text(content: bytes) -> str:
    """All text without white space and break opportunities."""
    text = "".join(page.extract_text() for page in PdfReader(io.BytesIO(content)).pages)
    return re.sub(r"[\s\u200b\u2060]", "", text)


def test_pdf_does_not_depend_on_the_time_of_the_run(
    passing: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    write_report(certify(passing), tmp_path / "a.pdf")
    later = passing | {"started": "2031-01-01T00:00:00Z"}
    later["cases"][0]["run"] |= {"wall_s": 99.0}
    write_report(certify(later), tmp_path / "b.pdf")
    assert (tmp_path / "a.pdf").read_bytes() == (tmp_path / "b.pdf").read_bytes()


@pytest.mark.thorough
def test_html_and_pdf_do_not_depend_on_the_process(passing: dict[str, Any], tmp_path: Path) -> None:
    """Another interpreter with another hash seed and time zone writes the same HTML and PDF."""
    source = tmp_path / "results.json"
    source.write_text(json.dumps(passing))
    document = certify(passing)
    program = (
        "import hashlib, json, sys;"
        "from pantocheck.conformance.pages.certificate_page import build_certificate;"
        "from pantocheck.conformance.pages.html import render_html;"
        "from pantocheck.conformance.pages.pdf import render_pdf;"
        "from pantocheck.conformance.results.results_format import Results;"
        "document = build_certificate(Results.model_validate(json.load(open(sys.argv[1]))));"
        "print(hashlib.sha256(render_html(document).encode() + render_pdf(document)).hexdigest())"
    )
    environment = os.environ | {"PYTHONHASHSEED": "12345", "TZ": "Asia/Tokyo"}
    command = [sys.executable, "-c", program, str(source)]
    other = subprocess.run(command, env=environment, capture_output=True, check=True, text=True)
    here = hashlib.sha256(render_html(document).encode() + render_pdf(document))
    assert other.stdout.strip() == here.hexdigest()


def test_pdf_date_is_the_start_of_the_run(
    passing: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    write_report(certify(passing), tmp_path / "a.pdf")
    assert PdfReader(tmp_path / "a.pdf").metadata["/CreationDate"] == "D:20261120235000Z"
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError):
        write_report(Document("Empty", PlainHeader("Empty", "Text"), ()), Path(tmp_path, "file", "a.pdf"))


def test_pdf_refuses_a_wrong_source_date(
    passing: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for epoch in ("soon", "-1", "1.5", "253402300800", "9" * 40, "", "٣"):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
        with pytest.raises(InputError, match="SOURCE_DATE_EPOCH"):
            write_report(certify(passing), tmp_path / "a.pdf")
    assert list(tmp_path.iterdir()) == []


def test_pdf_attachment_is_the_results_without_times(results: dict[str, Any], certificate: bytes) -> None:
    reader = PdfReader(io.BytesIO(certificate))
    [content] = reader.attachments["results.json"]
    assert json.dumps(json.loads(content)) == json.dumps(
        strip_times(Results.model_validate(results)).to_dict()
    )  # the order of the rows, too
    assert b'"started": null' in content
    assert b"wall_s" in content
    assert not re.search(rb'"wall_s": [0-9]', content)


def test_pdf_is_archival_a4_with_title_fonts_and_page_numbers(certificate: bytes) -> None:
    reader = PdfReader(io.BytesIO(certificate))
    metadata = reader.xmp_metadata.stream.get_data().decode()
    assert "<pdfaid:part>3</pdfaid:part>" in metadata
    assert "<pdfaid:conformance>A</pdfaid:conformance>" in metadata
    assert reader.metadata.title.startswith("FAIL – Conformance report")
    for page in reader.pages:
        # A4 is 210 mm by 297 mm; one point is 25.4 / 72 mm.
        assert [float(side) * 25.4 / 72 for side in page.mediabox[2:]] == pytest.approx([210, 297], abs=0.1)
    pages = PdfReader(io.BytesIO(certificate)).pages
    for at, page in enumerate(pages, start=1):
        text = page.extract_text()
        assert "FAIL" in text.splitlines()[0]
        assert f"{at} / {len(pages)}" in text
    fonts = {
        font.get_object()["/BaseFont"].split("+")[-1]
        for page in PdfReader(io.BytesIO(certificate)).pages
        for font in page["/Resources"]["/Font"].values()
    }
    assert fonts
    assert all(name.startswith(("LibertinusSerif", "DejaVuSans")) for name in fonts)


def test_pdf_prints_every_criterion(results: dict[str, Any], certificate: bytes) -> None:
    text = squeeze_text(certificate)
    for case in results["cases"]:
        for row in case["criteria"]:
            shown = describe_criterion(Criterion.model_validate(row), case["uncertainty_basis"])
            assert f"{shown.label}{row['quantity']}".replace(" ", "") in text
            expected = f"{shown.pantograph}{shown.value}{shown.error}{shown.limits}{shown.margin}"
            assert expected.replace(" ", "") in text
    # The explanations of the margins and of the uncertainties begin on lines of their own.
    lines = [line for page in PdfReader(io.BytesIO(certificate)).pages for line in page.extract_text().splitlines()]
    for beginning in ("Margin: distance", "The columns behind the uncertainty"):
        assert sum(line.startswith(beginning) for line in lines) == 1


def test_pdf_prints_hostile_text_literally(hostile: dict[str, Any]) -> None:
    text = squeeze_text(print_certificate(hostile))
    assert '#import"x.typ":*"])#panic()' in text
    assert "<script>alert(1)</script>" in text
    assert "x" * 300 in text


def _page_texts(document: Document) -> list[str]:
    pages = PdfReader(io.BytesIO(render_pdf(document))).pages
    return [page.extract_text().replace("\u200b", "") for page in pages]


@pytest.mark.parametrize("layout", ["grid", "cards"])
def test_no_page_begins_or_ends_with_a_single_row_of_a_table(layout: Literal["grid", "cards"]) -> None:
    """Tables of 10 to 13 rows begin at many heights of a page; three rows stay together at both ends of each table."""
    columns = (Column("Quantity", share=1), Column("Value", number=True))
    rows = [[(f"row-{table}-{row}.", Code("name")) for row in range(10 + table % 4)] for table in range(30)]
    sections = tuple(
        Section(f"Table {table}", (Table(columns, tuple((name, "1") for name in names), layout=layout),))
        for table, names in enumerate(rows)
    )
    counts = [
        sum(f"row-{table}-{row}." in text for row in range(len(names)))
        for text in _page_texts(Document("Tables", PlainHeader("Tables", "Text"), sections))
        for table, names in enumerate(rows)
    ]
    assert sum(counts) == sum(map(len, rows))
    assert sum(0 < count < 10 for count in counts) >= 6  # some tables are divided
    assert min(count for count in counts if count) >= 3


def test_heading_and_its_first_paragraphs_stay_with_the_table_below() -> None:
    """Sections begin at many heights of a page; each has its first row on the page of its heading."""
    columns = (Column("Quantity", share=1), Column("Value"))
    sections = tuple(
        Section(
            f"Heading {number}.",
            (Paragraph("Verdict"), Paragraph("Reason"), Table(columns, ((f"row {number}.", "1"),) * (3 + number % 4))),
        )
        for number in range(30)
    )
    for text in _page_texts(Document("Sections", PlainHeader("Sections", "Text"), sections)):
        lines = text.splitlines()  # a line of the contents ends with a page
        for number in range(30):
            assert (f"Heading {number}." in lines) == (f"row {number}. 1" in lines)


def test_rows_of_a_table_are_neither_needed_nor_lost() -> None:
    table = Table((Column("Quantity", share=1), Column("Value")), ())
    [text] = _page_texts(Document("Empty", PlainHeader("Empty", "Text"), (Section("Table", (table,)),)))
    assert "Quantity" in text
    # A text of 2000 characters in a narrow column is higher than a page.
    columns = (Column("Name", share=1), Column("Value", share=9))
    words = " ".join(f"w{number}" for number in range(400))
    table = Table(columns, ((words, "1"),))
    text = "".join(_page_texts(Document("Long", PlainHeader("Long", "Text"), (Section("Table", (table,)),))))
    assert all(f"w{number}" in text for number in range(400))


def test_file_name_is_not_divided_before_its_ending() -> None:
    """A file name stands at many places of a line, and some lines end within it."""
    fillers = tuple(
        Paragraph("a " * count + "verification/formulations/finite_differences.py.") for count in range(60, 180)
    )
    lines = "\n".join(_page_texts(Document("File", PlainHeader("File", "Text"), fillers))).splitlines()
    assert "differences.py." in lines
    assert "py." not in lines


@pytest.mark.parametrize("lines", range(48, 51))
def test_note_on_the_attachment_stands_below_the_last_section(passing: dict[str, Any], lines: int) -> None:
    """Some of these documents have no room for the note on their first page."""
    last = Section("Last section", (Paragraph("Closing words"),))
    filler = tuple(Paragraph(f"line {line}") for line in range(lines))
    pages = _page_texts(
        Document("Note", PlainHeader("Note", "Text"), (*filler, last), results=Results.model_validate(passing), date=1)
    )
    assert "Last section" in pages[-1]
    assert "Attached results" in pages[-1]
