"""Extraction of the results from a certificate of unknown origin."""

from io import BytesIO
from pathlib import Path
from typing import Any

from pypdf import PdfReader

from pantocheck.conformance.input_files.bounded_file import read_bytes
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.reports.formats.embedded_results import NAME
from pantocheck.conformance.reports.page_text import clean_text
from pantocheck.conformance.results.results_reading import parse_results

MAX_DOCUMENT_BYTES = 64 * 2**20
"""Largest PDF that is read [bytes]; a certificate of two cases has half a million."""


def open_document(path: Path) -> PdfReader:
    """Open a PDF for reading.

    Raises
    ------
    InputError
        It cannot be read, is too large, is damaged or is not a PDF.
    """
    content = read_bytes(path, str(path), MAX_DOCUMENT_BYTES)
    if b"%PDF-" not in content[:1024]:
        raise InputError(str(path), "not a PDF", "Name the certificate.pdf that 'pantocheck run' wrote.")
    try:
        reader = PdfReader(BytesIO(content), strict=True)
        pages = len(reader.pages)
    except Exception as error:
        raise _build_damage_error(path, error) from None
    if pages == 0:
        raise InputError(str(path), "a PDF without pages", "Request the certificate again.")
    return reader


def read_title_and_first_page(path: Path, reader: PdfReader) -> tuple[str, str]:
    """Read the title in the metadata and the text of the first page.

    Raises
    ------
    InputError
        The PDF is damaged.
    """
    try:
        title = reader.metadata.title if reader.metadata else None
        return str(title or ""), reader.pages[0].extract_text()
    except Exception as error:
        raise _build_damage_error(path, error) from None


def read_embedded_results(path: Path, reader: PdfReader) -> dict[str, Any]:
    """Read the results embedded in a certificate and validate their format.

    Raises
    ------
    InputError
        The attachment is missing, repeated, too large, not JSON, or not in the format of the suite.
    """
    try:
        attachments = reader.attachments.get(NAME, [])
        content = bytes(attachments[0]) if len(attachments) == 1 else b""
    except Exception as error:
        raise _build_damage_error(path, error) from None
    if len(attachments) != 1:
        number = len(attachments) or "no"
        hint = f"A certificate holds one {NAME}; other PDFs cannot be verified."
        raise InputError(str(path), f"{number} attachment named {NAME}", hint)
    where = f"{path}, attachment {NAME}"
    return parse_results(content, where).to_dict()


def _build_damage_error(path: Path, error: Exception) -> InputError:
    """Message for an exception of the parser; its exceptions for damaged files have no common base."""
    return InputError(
        str(path), f"a damaged PDF ({clean_text(str(error)) or type(error).__name__})", "Request the certificate again."
    )
