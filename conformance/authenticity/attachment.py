"""Reading of a PDF of unknown origin, and of the results attached to it."""

from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING

from pantocheck.conformance.authenticity.revision_ends import cut_original_revision
from pantocheck.conformance.input_files.extras import refuse_missing_package
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.reports.formats.embedded_results import NAME
from pantocheck.conformance.reports.page_text import clean_text
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.results.results_reading import parse_results

if TYPE_CHECKING:
    from pypdf import PdfReader


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
    """The same results as values."""


def parse_pdf_certificate(content: bytes, name: str) -> PdfCertificate:
    """Read a certificate as PDF.

    Args:
        content: Content of the file.
        name: Name of the file in messages.

    Raises:
        InputError: Damaged, encrypted, without pages, or without valid results.
    """
    original = cut_original_revision(content)
    reader = open_document(original, name)
    attachment = read_attachment(reader, name)
    return PdfCertificate(
        name, content, original, reader, attachment, parse_results(attachment, f"{name}, attachment {NAME}")
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
        raise InputError(name, "an encrypted PDF", "Pantocheck writes no encrypted PDF. Request the certificate again.")
    if pages == 0:
        raise InputError(name, "a PDF without pages", "Request the certificate again.")
    return reader


def read_attachment(reader: "PdfReader", name: str) -> bytes:
    """Content of the attached results.

    Raises:
        InputError: The attachment is missing, repeated or cannot be decoded.
    """
    try:
        attachments = reader.attachments.get(NAME, [])
        content = bytes(attachments[0]) if len(attachments) == 1 else b""
    except Exception as error:
        raise _build_damage_error(name, error) from None
    if len(attachments) != 1:
        hint = (
            f"A certificate holds one {NAME}. Other PDFs cannot be verified; reports on campaigns, mass drops and "
            "comparisons hold no results."
        )
        raise InputError(name, f"{len(attachments) or 'no'} attachment named {NAME}", hint)
    return content


def _build_damage_error(name: str, error: Exception) -> InputError:
    """Message for an exception of the parser; its exceptions for damaged files have no common base."""
    return InputError(
        name, f"a damaged PDF ({clean_text(str(error)) or type(error).__name__})", "Request the certificate again."
    )
