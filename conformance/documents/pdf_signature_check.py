"""Signatures of a PDF of unknown origin."""

from collections.abc import Iterator
from io import BytesIO
from typing import Any

from pantocheck.conformance.documents.certificates import describe_failure
from pantocheck.conformance.documents.cms_check import check_cms
from pantocheck.conformance.documents.key_files import MOST_SIGNATURES
from pantocheck.conformance.documents.pdf_revisions import find_changes
from pantocheck.conformance.documents.signature_facts import SignatureFacts

SIGNATURE_KEY = b"/ByteRange"
"""Key that every signed PDF contains in plain text, because the signature is written into the finished file."""


def check_pdf(content: bytes, roots: list[Any] | None) -> tuple[tuple[SignatureFacts, ...], tuple[str, ...]]:
    """Check the signatures of a PDF, and that nothing but signatures was added to it.

    Args:
        content: A PDF that contains `SIGNATURE_KEY`.
        roots: Trust roots (asn1crypto.x509.Certificate); None if the user gave none.

    Returns:
        Signatures in the order of signing, and changes of the document.
    """
    from pyhanko.pdf_utils.reader import PdfFileReader

    try:
        reader = PdfFileReader(BytesIO(content), strict=True)
        embedded = sorted(reader.embedded_signatures, key=lambda signature: signature.byte_range[2])
        revisions = reader.xrefs.total_revisions
        changes = [*_check_number(len(embedded), revisions), *find_changes(reader)]
        for number, signature in enumerate(embedded, 1):
            end = len(content) if number == revisions - 1 else None
            changes += [
                f"signature {number}: {problem}" for problem in _check_coverage(content, signature, number, end)
            ]
        facts = [
            check_cms(_read_signed_bytes(content, signature), signature.signed_data, roots, _read_time(signature))
            for signature in embedded
        ]
    except RecursionError:
        return (), ("its signatures cannot be analysed (too deeply nested)",)
    except Exception as error:  # the exceptions of the parser have no common base
        reason = describe_failure(error)
        return (), (f"its signatures cannot be analysed ({reason})",)
    return tuple(facts), tuple(changes)


def _check_number(signatures: int, revisions: int) -> Iterator[str]:
    if signatures > MOST_SIGNATURES:
        raise ValueError(f"{signatures} signatures; at most {MOST_SIGNATURES} are checked")
    if revisions != signatures + 1:
        yield f"{revisions - 1} revisions were added to the document, {signatures} of them by a signature"


def _check_coverage(content: bytes, signature: Any, number: int, end: int | None) -> Iterator[str]:
    """A signature must cover its whole revision but itself, and be the one that made the revision."""
    from pyhanko.sign.validation.status import SignatureCoverageLevel

    start, length, after, rest = signature.byte_range
    gap = content[length:after]
    if start != 0 or gap[:1] != b"<" or gap[-1:] != b">" or signature.pkcs7_content.hex() != gap[1:-1].decode().lower():
        yield "it does not cover everything but itself"
    elif signature.evaluate_signature_coverage() < SignatureCoverageLevel.ENTIRE_REVISION:
        yield "it does not cover its whole revision"
    if signature.signed_revision != number:
        yield f"it belongs to revision {signature.signed_revision}, expected {number}"
    if end is not None and after + rest != end:
        yield f"{end - after - rest} bytes follow the last signature"
    if signature.sig_object_type != "/Sig":
        yield "it is a time stamp of the document, which is not checked"


def _read_signed_bytes(content: bytes, signature: Any) -> bytes:
    start, length, after, rest = signature.byte_range
    return content[start : start + length] + content[after : after + rest]


def _read_time(signature: Any) -> Any:
    """Time of the signature by the clock of the signer; None if the document does not state it."""
    try:
        return signature.self_reported_timestamp
    except (ValueError, KeyError, TypeError):
        return None
