"""The page of an identification or a damping fit."""

import re

from pantocheck.conformance.reports.document import Document, Grid, Picture, Section, write_html

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
