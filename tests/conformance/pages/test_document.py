"""Documents without a verdict: layout of tables and figures, security policy, no date."""

import re
import time
from operator import itemgetter
from pathlib import Path

import pytest
from pypdf import PdfReader

from pantocheck.conformance.pages.document import Document, Figure, Figures, PlainHeader, Section, make_grid
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.report_writers import write_report

FIGURE = Figure("<svg xmlns='http://www.w3.org/2000/svg'/>", "points", "Damping ratios")
TABLE = make_grid(
    "Modes by frequency",
    [{"f": "0.836193", "zeta": "0.6074"}],
    {"f [Hz]": itemgetter("f"), "ζ [%]": itemgetter("zeta")},
)
DOCUMENT = Document(
    "Identification", PlainHeader("Identification", "1 mode"), (Section("Modes", (Figures((FIGURE,)), TABLE)),)
)


def test_html_scrolls_and_refuses_what_is_active() -> None:
    """A table wider than a phone broke its numbers into single digits and widened the page."""
    page = render_html(DOCUMENT)
    assert re.findall(r'<div class="scroll"[^>]*>\s*<(\w+)', page) == ["svg", "table"]
    assert re.search(r"<td[^>]*>0.836193</td>", page)
    assert re.search(r"\.values td:nth-child\(2\), \.grid td \{[^}]*overflow-wrap: normal", page)
    assert '<table class="grid"' in page
    # A browser refuses anything active that reached a figure through the data.
    digest = "'sha256-[A-Za-z0-9+/]{43}='"
    assert re.search(
        '<meta http-equiv="Content-Security-Policy" content="'
        f"default-src 'none'; script-src {digest}; style-src {digest}; img-src data:; base-uri 'none'; "
        "form-action 'none'\">",
        page,
    )
    assert page.index("Content-Security-Policy") < page.index("<title>Identification</title>") < page.index("<style>")


@pytest.mark.parametrize("epoch", [None, "1700000000"])
def test_pdf_without_results_bears_no_date(epoch: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The date of a drop is unknown; the date of today would change the bytes."""
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    if epoch is not None:
        monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
    files = [tmp_path / name for name in ("one.pdf", "two.pdf")]
    for file in files:
        write_report(DOCUMENT, file)
        time.sleep(1.1 if file == files[0] else 0)  # dates count seconds
    assert files[0].read_bytes() == files[1].read_bytes()
    reader = PdfReader(files[0])
    assert reader.metadata is not None
    assert reader.metadata.title == "Identification"
    assert not {"/CreationDate", "/ModDate"} & set(reader.metadata)
    assert b"xmp:CreateDate" not in files[0].read_bytes()
