"""Documents of unknown origin: PDF with its revisions, HTML page or results.json, and the software that wrote them.

A signature is appended to a PDF as an update, and so is any later change. The bytes before it stay as they were.
"""

import re
from collections.abc import Collection
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, assert_never

from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.files import read_bytes
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.pages.words import clean_text
from pantocheck.conformance.results.renderer_identity import identify_renderer
from pantocheck.conformance.results.report_files import ATTACHMENT, BLOCK_ID
from pantocheck.conformance.results.results_format import Renderer, Results
from pantocheck.conformance.results.results_reading import parse_results

if TYPE_CHECKING:
    from pypdf import PdfReader

REVISION_END = re.compile(rb"startxref\s+\d+\s+%%EOF(\r\n|\n|\r)?")
"""End of a revision (ISO 32000-1, 7.5.5)."""


def list_revision_ends(content: bytes) -> tuple[int, ...]:
    """Ends of the revisions of a PDF [bytes], the first one being the document as it was written."""
    return tuple(match.end() for match in REVISION_END.finditer(content))


# Reading of a PDF of unknown origin, and of the results attached to it.
@dataclass(frozen=True)
class PdfCertificate:
    """Certificate as PDF."""

    name: str
    """Name of the file."""
    content: bytes
    """Content of the file, with all updates."""
    original: bytes
    """First revision: the document as it was written, without the updates that were appended."""
    reader: "PdfReader"
    """Reader of the first revision."""
    attachment: bytes
    """Attached results."""
    results: Results
    """Attached results as values."""


def parse_pdf_certificate(content: bytes, name: str) -> PdfCertificate:
    """Read a certificate as PDF; messages name it.

    Raises:
        InputError: Damaged, encrypted, without pages, or without valid results.
    """
    ends = list_revision_ends(content)
    original = content[: ends[0]] if ends else content
    reader = open_document(original, name)
    attachment = read_attachment(reader, name)
    return PdfCertificate(
        name, content, original, reader, attachment, parse_results(attachment, f"{name}, attachment {ATTACHMENT}")
    )


def open_document(content: bytes, name: str) -> "PdfReader":
    """Open a PDF for reading; parameters as in `parse_pdf_certificate`.

    Raises:
        InputError: It is damaged, encrypted or without pages, or the extra `pdf` is not installed.
    """
    with refuse_missing_package(name):
        from pypdf import PdfReader
    try:
        reader = PdfReader(BytesIO(content), strict=True)
        encrypted = reader.is_encrypted
        pages = 0 if encrypted else len(reader.pages)
    except Exception as error:
        raise _build_damage_error(name, error) from None
    if encrypted:
        raise InputError(name, "is encrypted", "Pantocheck writes no encrypted PDF. Request the certificate again.")
    if pages == 0:
        raise InputError(name, "has no pages", "Request the certificate again.")
    return reader


def read_attachment(reader: "PdfReader", name: str) -> bytes:
    """Content of the attached results.

    Raises:
        InputError: The attachment is missing, repeated or cannot be decoded.
    """
    try:
        attachments = reader.attachments.get(ATTACHMENT, [])
        content = bytes(attachments[0]) if len(attachments) == 1 else b""
    except Exception as error:
        raise _build_damage_error(name, error) from None
    if len(attachments) != 1:
        hint = (
            f"A certificate holds one {ATTACHMENT}. Other PDFs cannot be verified; reports on campaigns, mass drops "
            "and comparisons hold no results."
        )
        raise InputError(name, f"holds {len(attachments) or 'no'} attachments named {ATTACHMENT}", hint)
    return content


def _build_damage_error(name: str, error: Exception) -> InputError:
    """Message for an exception of the parser; its exceptions for damaged files have no common base."""
    return InputError(
        name, f"is a damaged PDF ({clean_text(str(error)) or type(error).__name__})", "Request the certificate again."
    )


# Reading of an HTML page of unknown origin, and of the results embedded in it.
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

    Raises:
        InputError: Not UTF-8, or without one block of valid results.
    """
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(name, "is an HTML page that is not UTF-8", "Request the certificate again.") from None
    blocks = DATA_BLOCK.findall(text)
    if len(blocks) != 1:
        hint = (
            f"A certificate holds one data block named {BLOCK_ID}. Other pages cannot be verified; reports on "
            "campaigns, mass drops and comparisons hold no results, nor do pages of early versions: verify their PDF."
        )
        raise InputError(name, f"holds {len(blocks) or 'no'} embedded results", hint)
    return HtmlCertificate(name, text, parse_results(blocks[0].encode("utf-8"), f"{name}, embedded results"))


# Reading of a certificate of unknown origin: PDF, HTML page or results.json, recognised by its content.
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

    Raises:
        InputError: It cannot be read, is too large, or is not one of them.
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
            "is a copy of results without protection: a change of it cannot be found",
            f"Verify the document beside it: {', '.join(DOCUMENTS)}.",
        )
    raise InputError(
        name,
        "is neither a PDF nor an HTML page nor JSON",
        "Name the certificate.pdf, certificate.html or results.json that 'pantocheck run' wrote.",
    )


def _suggest_document(folder: Path) -> str:
    """Advice for a folder in place of a document: the documents in it."""
    found = [f"'{folder / name}'" for name in DOCUMENTS if (folder / name).is_file()]
    return f"Name one document of it: {', '.join(found)}." if found else f"Name a file: {', '.join(DOCUMENTS)}."


# Versions of the software that wrote a document, against those that are installed: only the same versions lay out the
# same pages, so that their bytes can be compared.
def list_suite_differences(results: Results) -> list[str]:
    """Differences of the suite that graded the system from the installed suite; none if their digests agree."""
    stated, installed = results.suite, build_suite()
    if stated.digest == installed.digest:
        return []  # `find_false_version` compares the versions
    if stated.version != installed.version:
        return [f"Pantocheck {stated.version}; installed is {installed.version}"]
    return [f"Pantocheck {stated.version} with the digest {stated.digest[:19]}; installed is {installed.digest[:19]}"]


def find_false_version(results: Results) -> list[str]:
    """Contradiction of a stated version with the digest of the installed files; none if the digests differ."""
    stated, installed = results.suite, build_suite()
    if stated.digest != installed.digest or stated.version == installed.version:
        return []
    return [f"Pantocheck {stated.version} stated; the stated digest is that of Pantocheck {installed.version}"]


def list_version_differences(document: Certificate) -> list[str]:
    """All differences of the software that made a document from the installed one, as sentences."""
    return [*list_suite_differences(document.results), *_list_renderer_differences(document.results, _layout(document))]


def _layout(document: Certificate) -> frozenset[str]:
    """Fields of `Renderer` on which a document depends: Typst lays out no HTML page, and nothing a results.json."""
    match document:
        case ResultsFile():
            return frozenset()
        case HtmlCertificate():
            return frozenset(Renderer.model_fields) - {"typst"}
        case PdfCertificate():
            return frozenset(Renderer.model_fields)
        case never:
            assert_never(never)


def _list_renderer_differences(results: Results, software: Collection[str]) -> list[str]:
    """Differences of the software that made the pages from the installed one."""
    stated, installed = results.renderer, identify_renderer()
    return [
        f"{name} {getattr(stated, name)}; installed is {getattr(installed, name)}"
        for name in Renderer.model_fields
        if name in software and getattr(stated, name) != getattr(installed, name)
    ]
