"""Taking the results out of a certificate that a stranger sent."""

import json
from pathlib import Path
from typing import Any

from pantocheck.conformance.errors import InputError
from pantocheck.conformance.reports.embedding import NAME
from pantocheck.conformance.reports.text import clean
from pantocheck.conformance.results import Results
from pydantic import ValidationError
from pypdf import PdfReader
from pypdf.errors import PyPdfError

LARGEST_FILE = 64 * 2**20  # bytes of a PDF; a certificate of two cases has half a million
LARGEST_RESULTS = 64 * 2**20  # bytes of the embedded results

# A damaged file can break any assumption of the parser, and it has no single exception for that.
DAMAGED = (PyPdfError, OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError, NotImplementedError)


def opened(path: Path) -> PdfReader:
    """A PDF ready to be read.

    Raises
    ------
    InputError : no such file, too large, or not a PDF
    """
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE:
            raise InputError(str(path), f"{size} bytes", f"A certificate has at most {LARGEST_FILE} bytes.")
        with path.open("rb") as file:
            start = file.read(1024)
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror})", "Name a certificate.pdf.") from None
    if b"%PDF-" not in start:
        raise InputError(str(path), "not a PDF", "Name the certificate.pdf that 'pantocheck run' wrote.")
    try:
        reader = PdfReader(path, strict=True)
        if len(reader.pages) == 0:
            raise InputError(str(path), "a PDF without pages", "Ask for the certificate once more.")
    except DAMAGED as error:
        if isinstance(error, InputError):
            raise
        raise _damaged(path, error) from None
    return reader


def title_and_first_page(path: Path, reader: PdfReader) -> tuple[str, str]:
    """Title in the metadata, and text of the first page.

    Raises
    ------
    InputError : damaged
    """
    try:
        title = reader.metadata.title if reader.metadata else None
        return str(title or ""), reader.pages[0].extract_text()
    except DAMAGED as error:
        raise _damaged(path, error) from None


def embedded_results(path: Path, reader: PdfReader) -> dict[str, Any]:
    """The results embedded in a certificate, checked against their format.

    Raises
    ------
    InputError : nothing embedded under the name, more than once, too large, not JSON, or not results of this suite
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
    if len(content) > LARGEST_RESULTS:
        raise InputError(where, f"{len(content)} bytes", f"Results have at most {LARGEST_RESULTS} bytes.")
    try:
        data = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise InputError(where, f"not JSON ({clean(str(error))})", "Ask for the certificate once more.") from None
    try:
        return Results.model_validate(data).to_dict()
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = clean(".".join(map(str, first["loc"]))) or "top level"
        hint = "The results must have the format that 'pantocheck schema' prints."
        raise InputError(f"{where}, key {key}", clean(first["msg"]), hint) from None


def _damaged(path: Path, error: Exception) -> InputError:
    return InputError(
        str(path), f"a damaged PDF ({clean(str(error)) or type(error).__name__})", "Ask for it once more."
    )
