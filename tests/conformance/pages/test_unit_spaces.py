"""Numbers stay on the line of their unit, ranges on one line."""

from dataclasses import replace
from typing import Any

import pytest

from helpers.shown_page import certify
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.words import bind_page_units, bind_units

GAP = "\N{NO-BREAK SPACE}"
JOINER = "\N{WORD JOINER}"


@pytest.mark.parametrize(
    ("text", "bound"),
    [
        ("from 12.5 N to 30 m.", f"from 12.5{GAP}N to 30{GAP}m."),
        ("250 km/h, 95 %; 3 m/s", f"250{GAP}km/h, 95{GAP}%; 3{GAP}m/s"),
        ("2 maxima, 3 Newton, 4 m_s, 5 N/x", "2 maxima, 3 Newton, 4 m_s, 5 N/x"),
        ("case 3 supports", "case 3 supports"),
        ("± 3.8* N", f"± 3.8*{GAP}N"),
        ("0–20 Hz, 5 – 6, a–b", f"0–{JOINER}20{GAP}Hz, 5 – 6, a–b"),
    ],
)
def test_only_a_number_before_a_unit_is_bound(text: str, bound: str) -> None:
    assert bind_units(text) == bound


def test_lines_to_be_copied_names_and_drawings_keep_their_spaces() -> None:
    blocks = (
        doc.Paragraph(("at 5 m", doc.Code("5 m"), doc.Remark("of 6 N"))),
        doc.CodeBlock("# 5 m"),
        doc.BulletList(("<7 N>",)),
        doc.Figures((doc.Figure("<path d='M 1 m 5 s'/>", "8 N", "9 N"),)),
    )
    page = bind_page_units(doc.to_plain(doc.Document("10 N", doc.PlainHeader("Head", "11 N"), blocks)))
    paragraph, code, bullets, figures = page["blocks"]
    texts = [part if isinstance(part, str) else part["text"] for part in paragraph["text"]]
    assert texts == [f"at 5{GAP}m", "5 m", f"of 6{GAP}N"]
    assert code["code"] == "# 5 m"
    assert bullets["items"] == [f"<7{GAP}N>"]
    assert figures["figures"][0]["svg"] == "<path d='M 1 m 5 s'/>"
    assert figures["figures"][0]["caption"] == f"9{GAP}N"
    assert page["title"] == "10 N"


def test_page_binds_escaped_text_too(passing: dict[str, Any]) -> None:
    document = certify(passing)
    first = doc.Paragraph("<b> 31 N & 32 m")
    page = render_html(replace(document, blocks=(first, *document.blocks)))
    assert f"&lt;b&gt; 31{GAP}N &amp; 32{GAP}m" in page
