"""The page of an identification or a damping fit."""

import re
import time

import pytest
from pypdf import PdfReader

from pantocheck.conformance.reports.document import Document, Grid, Picture, Section, write_html, write_pdf

SECTION = Section(
    "Modes",
    grids=(Grid(("f [Hz]", "ζ [%]"), (("0.836193", "0.6074"),), "Modes by frequency"),),
    pictures=(Picture("<svg xmlns='http://www.w3.org/2000/svg'/>", "points", "Damping ratios"),),
)


def test_tables_and_figures_scroll_in_place_and_numbers_stay_whole(tmp_path):
    """A table wider than a phone broke its numbers into single digits and widened the page."""
    write_html(Document("Identification", "1 mode", (), (SECTION,)), tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert re.findall(r'<div class="scroll"[^>]*>\s*<(\w+)', page) == ["img", "table"]
    assert "<td>0.836193</td>" in page
    assert re.search(r"\.grid td \{[^}]*overflow-wrap: normal", page)
    assert '<table class="grid">' in page


def test_nothing_is_fetched_or_run(tmp_path):
    """What a picture of a stranger's data smuggled in, a browser would refuse: as on the certificate."""
    write_html(Document("Identification", "1 mode", (), (SECTION,)), tmp_path / "page.html")
    policy = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert f'<meta http-equiv="Content-Security-Policy" content="{policy}">' in page
    assert page.index("Content-Security-Policy") < page.index("<title>Identification</title>") < page.index("<style>")


@pytest.mark.parametrize("epoch", [None, "1700000000"])
def test_pdf_bears_no_date_and_is_the_same_every_time(epoch, tmp_path, monkeypatch):
    """A report does not know when its drop was; with a date made up, 1970, or that of now, it would lie or change."""
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    if epoch is not None:
        monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
    files = [tmp_path / name for name in ("one.pdf", "two.pdf")]
    for file in files:
        write_pdf(Document("Identification", "1 mode", (), (SECTION,)), file)
        time.sleep(1.1)  # dates count seconds
    assert files[0].read_bytes() == files[1].read_bytes()
    reader = PdfReader(files[0])
    assert reader.metadata is not None
    assert reader.metadata.title == "Identification"
    assert not {"/CreationDate", "/ModDate"} & set(reader.metadata)
    assert b"xmp:CreateDate" not in files[0].read_bytes()
