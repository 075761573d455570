"""Signing of a document: inside a PDF, or in a signature file beside any other document."""

from dataclasses import dataclass
from pathlib import Path

from pantocheck.conformance.authenticity.certificate_reading import MAX_DOCUMENT_BYTES
from pantocheck.conformance.authenticity.signatures.cms_signing import Signer, check_role, sign_detached
from pantocheck.conformance.authenticity.signatures.detached_file import (
    MAX_SIGNATURE_BYTES,
    Encoding,
    encode_pem,
    find_signature_file,
    parse_signatures,
)
from pantocheck.conformance.authenticity.signatures.key_files import AskPassphrase, read_signing_key
from pantocheck.conformance.authenticity.signatures.signature_box import BOXES
from pantocheck.conformance.authenticity.signatures.signature_check import is_signed_pdf
from pantocheck.conformance.authenticity.signatures.signature_package import use_signature_package
from pantocheck.conformance.authenticity.signatures.timestamp_client import build_timestamp_client
from pantocheck.conformance.input_files.atomic_writing import write_atomically
from pantocheck.conformance.input_files.bounded_file import read_bytes
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.suggestions import suggest_names


@dataclass(frozen=True)
class SigningOptions:
    """Choices of the user for a signature."""

    role: str = "author"
    """Role of the signer."""
    timestamp_url: str | None = None
    """Address of a time-stamp server; None for a signature without time stamp."""
    place: str | None = None
    """Place of the box of a visible signature in a PDF, one of `BOXES`; None for an invisible signature."""
    encoding: Encoding = "der"
    """Form of a signature file."""
    out: Path | None = None
    """File to write; None for the place beside the document."""


@dataclass(frozen=True)
class SignedDocument:
    """Written signature: its file, the holder of the certificate, and the role."""

    path: Path
    holder: str
    role: str


@use_signature_package()
def sign_document(
    document: Path, key: Path, certificate: Path | None, ask: AskPassphrase, options: SigningOptions
) -> SignedDocument:
    """Sign a document; nothing is written unless the signature holds.

    Args:
        document: PDF, or any other file.
        key: Private key in PKCS#12 or PEM.
        certificate: Certificate of the key; None if the key file holds it.
        ask: Source of the passphrase of an encrypted key.
        options: Further choices.

    Raises:
        InputError: A file or an option cannot be used, the time-stamp server gave no time stamp, or the package for
            signatures is not installed.
    """
    content = read_bytes(document, f"document '{document.name}'", MAX_DOCUMENT_BYTES)
    pdf = content.startswith(b"%PDF-")
    _check_place(options.place, pdf)
    role = check_role(options.role)
    client = None if options.timestamp_url is None else build_timestamp_client(options.timestamp_url)
    path = _choose_pdf_path(document, content, options.out) if pdf else options.out or find_signature_file(document)
    signing_key = read_signing_key(key, certificate, ask)
    signer = Signer(signing_key, role, client)
    signed = _sign_pdf(content, signer, options.place, document) if pdf else _sign_beside(content, signer, path)
    write_atomically(path, encode_pem(signed) if options.encoding == "pem" and not pdf else signed)
    return SignedDocument(path, signing_key.holder, role)


def _check_place(place: str | None, pdf: bool) -> None:
    if place is None:
        return
    if not pdf:
        raise InputError("option --visible", "the document is not a PDF", "Only a PDF can show a signature.")
    if place not in BOXES:
        raise InputError("option --visible", f"there is no place '{place}'", suggest_names(place, list(BOXES)))


def _choose_pdf_path(document: Path, content: bytes, out: Path | None) -> Path:
    """File of the signed PDF: a copy of an unsigned document, the same file for a signed one, which keeps its bytes."""
    signed = is_signed_pdf(content)
    path = out or (document if signed else document.with_name(f"{document.stem}-signed{document.suffix}"))
    if path.exists() and path.samefile(document):
        if not signed:
            raise InputError(
                "option --out", "names the unsigned document", "Choose another file; it is never replaced."
            )
    elif path.exists():
        hint = f"Sign {path.name} itself to add a signature, or choose another file with --out."
        raise InputError(str(path), "exists already", hint)
    return path


def _sign_pdf(content: bytes, signer: Signer, place: str | None, document: Path) -> bytes:
    from pantocheck.conformance.authenticity.signatures.pdf_signature_check import check_pdf
    from pantocheck.conformance.authenticity.signatures.pdf_signing import sign_pdf

    where = f"document '{document.name}'"
    signed = sign_pdf(content, signer, place, where)
    signatures, changes = check_pdf(signed, None)
    problems = [*changes, *(facts.damage for facts in signatures if facts.damage)]
    if problems:
        raise InputError(where, f"cannot be signed ({problems[0]})", "Sign a PDF as 'pantocheck run' wrote it.")
    return signed


def _sign_beside(content: bytes, signer: Signer, path: Path) -> bytes:
    from pantocheck.conformance.authenticity.signatures.cms_check import check_cms

    where = f"signature '{path.name}'"
    earlier = read_bytes(path, where, MAX_SIGNATURE_BYTES) if path.exists() else None
    for part in [] if earlier is None else parse_signatures(earlier, where):
        if check_cms(content, part, None, None).damage:
            hint = "Remove it if the document was written anew, or choose another file with --out."
            raise InputError(where, "belongs to another version of the document", hint)
    return sign_detached(content, signer, earlier, where)
