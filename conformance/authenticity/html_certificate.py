"""Reading of an HTML page of unknown origin, and of the results embedded in it."""

import re
from dataclasses import dataclass

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.reports.formats.embedded_results import BLOCK_ID
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.results.results_reading import parse_results

DATA_BLOCK = re.compile(rf'<script type="application/json" id="{BLOCK_ID}">([^<>]*)</script>')
"""Data block of a certificate; its content has no angle brackets, which would end it."""


@dataclass(frozen=True)
class HtmlCertificate:
    """Certificate as HTML page."""

    name: str
    """Name of the file."""
    text: str
    """Text of the page."""
    results: Results
    """Results of its data block."""


def parse_html_certificate(content: bytes, name: str) -> HtmlCertificate:
    """Read a certificate as HTML page.

    Args:
        content: Content of the file.
        name: Name of the file in messages.

    Raises:
        InputError: Not UTF-8, or without one block of valid results.
    """
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(name, "an HTML page that is not UTF-8", "Request the certificate again.") from None
    blocks = DATA_BLOCK.findall(text)
    if len(blocks) != 1:
        hint = (
            f"A certificate holds one data block named {BLOCK_ID}. Other pages cannot be verified; reports on "
            "campaigns, mass drops and comparisons hold no results, nor do pages of early versions: verify their PDF."
        )
        raise InputError(name, f"{len(blocks) or 'no'} embedded results", hint)
    return HtmlCertificate(name, text, parse_results(blocks[0].encode("utf-8"), f"{name}, embedded results"))
