"""Check of all signatures of a document: inside a PDF, or in a signature file beside any document."""

from pathlib import Path
from typing import Any

from pantocheck.conformance.core.extras import MissingPackage
from pantocheck.conformance.core.files import read_bytes
from pantocheck.conformance.documents.certificates import read_certificates, use_signature_package
from pantocheck.conformance.documents.cms_check import SignatureFacts, SignatureReport
from pantocheck.conformance.documents.document_reading import MAX_DOCUMENT_BYTES
from pantocheck.conformance.documents.key_files import MAX_SIGNATURE_BYTES, find_signature_file, parse_signatures


def check_signatures(path: Path, trust_roots: Path | None) -> SignatureReport:
    """Check the signatures of a document.

    Args:
        path: PDF, or any other file with a signature file beside it (`results.json.p7s`).
        trust_roots: PEM file of trust roots.

    Raises:
        InputError: A file cannot be read or is damaged, or trust roots are given and the package for signatures is
            missing.
    """
    content = read_bytes(path, str(path), MAX_DOCUMENT_BYTES)
    detached = find_signature_file(path)
    given = trust_roots is not None
    if not (is_signed_pdf(content) or detached.exists()):
        return SignatureReport((), (), given)
    try:
        with use_signature_package():
            roots = None if trust_roots is None else read_certificates(trust_roots, f"trust roots '{trust_roots.name}'")
            return _check(content, detached, roots)
    except MissingPackage as error:
        if given:
            raise
        return SignatureReport((), (), given, f"signatures were not checked: the check {error.found}. {error.hint}")


def _check(content: bytes, detached: Path, roots: list[Any] | None) -> SignatureReport:
    from pantocheck.conformance.documents.cms_check import check_cms
    from pantocheck.conformance.documents.pdf_signature_check import check_pdf

    signatures: tuple[SignatureFacts, ...] = ()
    changes: tuple[str, ...] = ()
    if is_signed_pdf(content):
        signatures, changes = check_pdf(content, roots)
    if detached.exists():
        where = f"signature '{detached.name}'"
        parts = parse_signatures(read_bytes(detached, where, MAX_SIGNATURE_BYTES), where)
        signatures += tuple(check_cms(content, part, roots, None) for part in parts)
    return SignatureReport(signatures, changes, roots is not None)


def is_signed_pdf(content: bytes) -> bool:
    """Whether the content is a PDF with a signature."""
    from pantocheck.conformance.documents.pdf_signature_check import SIGNATURE_KEY

    return content.startswith(b"%PDF-") and SIGNATURE_KEY in content
