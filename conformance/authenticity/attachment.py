"""Taking the results out of a certificate that a stranger sent."""

from pathlib import Path
from typing import Any

from pypdf import PdfReader
from pypdf.errors import PyPdfError

from pantocheck.conformance.input_files.bounded_file import check_file
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.reports.formats.embedding import NAME
from pantocheck.conformance.reports.page_text import clean_text
from pantocheck.conformance.results.results_reading import parse_results

MAX_DOCUMENT_BYTES = 64 * 2**20  # bytes of a PDF; a certificate of two cases has half a million

# A damaged file can break any assumption of the parser, and it has no single exception for that.
DAMAGED = (
    PyPdfError,
    OSError,
    ValueError,
    LookupError,
    TypeError,
    AttributeError,
    RecursionError,
    NotImplementedError,
    ArithmeticError,
    AssertionError,
)


def open_document(path: Path) -> PdfReader:
    """A PDF ready to be read.

    Raises
    ------
    InputError
        No such file, too large, or not a PDF.
    """
    check_file(path, str(path), MAX_DOCUMENT_BYTES)
    try:
        with path.open("rb") as file:
            start = file.read(1024)
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror})", "Name a certificate.pdf.") from None
    if b"%PDF-" not in start:
        raise InputError(str(path), "not a PDF", "Name the certificate.pdf that 'pantocheck run' wrote.")
    try:
        reader = PdfReader(path, strict=True)
        pages = len(reader.pages)
    except DAMAGED as error:
        raise _damaged(path, error) from None
    if pages == 0:
        raise InputError(str(path), "a PDF without pages", "Ask for the certificate once more.")
    return reader


def read_title_and_first_page(path: Path, reader: PdfReader) -> tuple[str, str]:
    """Title in the metadata, and text of the first page.

    Raises
    ------
    InputError
        Damaged.
    """
    try:
        title = reader.metadata.title if reader.metadata else None
        return str(title or ""), reader.pages[0].extract_text()
    except DAMAGED as error:
        raise _damaged(path, error) from None


def read_embedded_results(path: Path, reader: PdfReader) -> dict[str, Any]:
    """The results embedded in a certificate, checked against their format.

    Raises
    ------
    InputError
        Nothing embedded under the name, more than once, too large, not JSON, or not results of this suite.
    """
    try:
        found = reader.attachments.get(NAME, [])
        content = bytes(found[0]) if len(found) == 1 else b""
    except DAMAGED as error:
        raise _damaged(path, error) from None
    if len(found) != 1:
        number = "no" if not found else f"{len(found)}"
        hint = f"A certificate holds one {NAME}; other PDFs cannot be verified."
        raise InputError(str(path), f"{number} attachment named {NAME}", hint)
    where = f"{path}, attachment {NAME}"
    return parse_results(content, where).to_dict()


def _damaged(path: Path, error: Exception) -> InputError:
    return InputError(
        str(path), f"a damaged PDF ({clean_text(str(error)) or type(error).__name__})", "Ask for it once more."
    )
