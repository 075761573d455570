"""A page as its reader sees it: without the embedded results, which repeat every text and number."""

from dataclasses import replace
from typing import Any

from pantocheck.conformance.pages.certificate_page import build_certificate, build_summary
from pantocheck.conformance.pages.document import Answers, Document, Facts
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.results.results_format import Results


def shown_certificate(results: dict[str, Any]) -> str:
    """HTML of a certificate without its data block, with ordinary spaces before units and plain ranges."""
    page = render_html(replace(certify(results), results=None))
    return page.replace("\N{NO-BREAK SPACE}", " ").replace("\N{WORD JOINER}", "")


def certify(results: dict[str, Any]) -> Document:
    """Certificate of results."""
    return build_certificate(Results.model_validate(results))


def show_certificate(results: dict[str, Any]) -> str:
    """HTML of a certificate with its data block."""
    return render_html(certify(results))


def print_certificate(results: dict[str, Any]) -> bytes:
    """PDF of a certificate."""
    return render_pdf(certify(results))


def summarise(results: dict[str, Any]) -> str:
    """Markdown summary of results."""
    return render_markdown(build_summary(Results.model_validate(results)))


def find_facts(document: Document, anchor: str) -> tuple[tuple[str, str], ...]:
    """Facts of an answer on page 1."""
    answers = [section for block in document.blocks if isinstance(block, Answers) for section in block.sections]
    blocks = [block for section in answers if section.anchor == anchor for block in section.blocks]
    return tuple(pair for block in blocks if isinstance(block, Facts) for pair in block.pairs)
