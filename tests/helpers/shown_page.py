"""A page as its reader sees it: without the embedded results, which repeat every text and number."""

from dataclasses import replace
from typing import Any

from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.results.results_format import Results


def shown_certificate(results: dict[str, Any]) -> str:
    """HTML of a certificate without its data block, with ordinary spaces between numbers and units."""
    page = render_html(replace(build_certificate(Results.model_validate(results)), results=None))
    return page.replace("\N{NO-BREAK SPACE}", " ")
