"""Reading of a certificate of unknown origin: PDF, HTML page or results.json, recognised by its content."""

from dataclasses import dataclass
from pathlib import Path

from pantocheck.conformance.authenticity.attachment import PdfCertificate, parse_pdf_certificate
from pantocheck.conformance.authenticity.html_certificate import HtmlCertificate, parse_html_certificate
from pantocheck.conformance.input_files.bounded_file import read_bytes
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.results.results_reading import parse_results

MAX_DOCUMENT_BYTES = 64 * 2**20
"""Largest certificate that is read [bytes]; a certificate of two cases has about one million."""

DOCUMENTS = ("certificate.pdf", "certificate.html", "results.json")
"""Documents that `pantocheck run` writes to its folder."""

COPIES = (".csv", ".md", ".xml", ".svg")
"""Endings of the files of a run that hold no results."""

HEADER_BYTES = 1024
"""Length of the part of a file with the header of a PDF [bytes] (ISO 32000-1, implementation note 13)."""


@dataclass(frozen=True)
class ResultsFile:
    """results.json of unknown origin."""

    name: str
    """Name of the file."""
    content: bytes
    """Content of the file."""
    results: Results


Certificate = PdfCertificate | HtmlCertificate | ResultsFile


def read_certificate(path: Path) -> Certificate:
    """Read a certificate or a results.json.

    Args:
        path: PDF, HTML page or results.json.

    Raises:
        InputError: It cannot be read, is too large, or is none of them.
    """
    name = str(path)
    if path.is_dir():
        raise InputError(name, "is a folder, not a regular file", _suggest_document(path))
    content = read_bytes(path, name, MAX_DOCUMENT_BYTES)
    beginning = content.removeprefix(b"\xef\xbb\xbf").lstrip()[:HEADER_BYTES]
    if b"%PDF-" in content[:HEADER_BYTES]:
        return parse_pdf_certificate(content, name)
    if beginning[:9].lower() == b"<!doctype" or beginning[:5].lower() == b"<html":
        return parse_html_certificate(content, name)
    if beginning[:1] == b"{":
        return ResultsFile(name, content, parse_results(content, name))
    if path.suffix.lower() in COPIES:
        raise InputError(
            name,
            "a copy of results without protection: no change of it can be found",
            f"Verify the document beside it: {', '.join(DOCUMENTS)}.",
        )
    raise InputError(
        name,
        "not a PDF, not an HTML page and not JSON",
        "Name the certificate.pdf, certificate.html or results.json that 'pantocheck run' wrote.",
    )


def _suggest_document(folder: Path) -> str:
    """Advice for a folder in place of a document: the documents in it."""
    found = [f"'{folder / name}'" for name in DOCUMENTS if (folder / name).is_file()]
    return f"Name one document of it: {', '.join(found)}." if found else f"Name a file: {', '.join(DOCUMENTS)}."
