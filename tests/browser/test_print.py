"""Pages on paper: every text of the report, folded or filtered or not, inside the page."""

import io
import re
import unicodedata
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pypdf import PdfReader

from helpers.example_results import example
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.document import to_plain
from pantocheck.conformance.results.results_format import Results

pytestmark = pytest.mark.thorough

PRINTED_WIDTH = 688
"""Width between the margins of an A4 page [px], 182 mm."""

NOT_PRINTED = {
    *(
        "svg", "anchor", "kind", "alternative", "short", "verdict", "layout", "trust", "footer", "shown", "owner",
        "label",
    ),
}  # fmt: skip
"""Keys of a document whose texts are no texts of the page, or stand there as another word."""

CLIPPED = """() => {
  const right = document.querySelector("main").getBoundingClientRect().right + 1;
  const parts = [...document.querySelectorAll("main *:not(svg *)")].filter(part => part.checkVisibility());
  return parts.filter(part => part.getBoundingClientRect().right > right ||
    (getComputedStyle(part).overflowX !== "visible" && part.scrollWidth > part.clientWidth + 1))
    .map(part => part.outerHTML.slice(0, 120));
}"""
"""Parts of a page that reach beyond its right edge or hide a part of their content."""


def list_texts(part: Any, key: str = "") -> Iterator[str]:
    """Texts of a document that a reader sees."""
    if isinstance(part, str):
        if key not in NOT_PRINTED:
            yield part
    elif isinstance(part, dict):
        for name, value in part.items():
            yield from list_texts(value, name)
    elif isinstance(part, list):
        for value in part:
            yield from list_texts(value, key)


def print_page(page: Any) -> str:
    """Text of a printed page without its page numbers."""
    sheets = PdfReader(io.BytesIO(page.pdf(prefer_css_page_size=True))).pages
    number = re.compile(rf"\d+\s*/\s*{len(sheets)}\b")
    return join_words("".join(number.sub("", sheet.extract_text()) for sheet in sheets))


def join_words(text: str) -> str:
    """Text without spaces, which the breaks of lines change, and without ligatures."""
    return "".join(unicodedata.normalize("NFKC", text).split())


def list_missing(printed: str) -> list[str]:
    """Texts of the certificate, which are also those of its PDF, that a printed page lacks."""
    document = to_plain(build_certificate(Results.model_validate(example())))
    texts = list_texts({key: document[key] for key in ("header", "blocks")})
    return [text for text in texts if join_words(text) not in printed]


def test_certificate_printed_without_script_has_every_text(open_page: Any) -> None:
    """Folded sections stand open."""
    printed = print_page(open_page("certificate", java_script_enabled=False))
    assert list_missing(printed) == []
    assert "positionalongthetrack[m]" in printed


def test_filtered_and_hidden_parts_are_printed(open_page: Any) -> None:
    """The static figures stand in place of the curves, whose controls are left out."""
    page = open_page("certificate")
    page.get_by_role("searchbox").first.fill("no such row")
    page.emulate_media(color_scheme="dark")
    printed = print_page(page)
    assert list_missing(printed) == []
    assert "positionalongthetrack[m]" in printed
    assert "Staticfigure" not in printed
    assert "CurvesasCSV" not in printed


def test_sections_are_folded_again_after_printing(open_page: Any) -> None:
    page = open_page("certificate")
    folded = page.locator("details:not([open])").count()
    assert folded > 0
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator("details:not([open])").count() == 0
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert page.locator("details:not([open])").count() == folded


@pytest.mark.parametrize("name", ["certificate", "hostile", "identification", "plain"])
@pytest.mark.parametrize(("media", "width"), [("print", PRINTED_WIDTH), ("screen", 1280)])
def test_nothing_is_cut(open_page: Any, name: str, media: str, width: int) -> None:
    page = open_page(name, width, java_script_enabled=False)
    page.emulate_media(media=media)
    page.evaluate("for (const section of document.querySelectorAll('details')) section.open = true")
    assert page.evaluate(CLIPPED) == []


def test_certificate_of_two_cases_stays_small(page_files: dict[str, Path]) -> None:
    """The example has three traces; the certificate of the two cases of the main job has two."""
    assert page_files["certificate"].stat().st_size < 1.5e6
