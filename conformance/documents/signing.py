"""Signing of a document: inside a PDF, or in a signature file beside any other document."""

import urllib.request
from dataclasses import dataclass
from http.client import HTTPException
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.parse import urlsplit

from pantocheck.conformance.core.files import read_bytes, write_atomically
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.documents.cms_check import check_cms
from pantocheck.conformance.documents.document_reading import MAX_DOCUMENT_BYTES
from pantocheck.conformance.documents.key_files import (
    MAX_SIGNATURE_BYTES,
    AskPassphrase,
    Encoding,
    encode_pem,
    find_signature_file,
    parse_signatures,
    read_signing_key,
    use_signature_package,
)
from pantocheck.conformance.documents.signature_check import check_pdf, is_signed_pdf
from pantocheck.conformance.documents.signature_writing import BOXES, Signer, check_role, sign_detached, sign_pdf
from pantocheck.conformance.pages.words import clean_text


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
    where = f"document '{document.name}'"
    signed = sign_pdf(content, signer, place, where)
    signatures, changes = check_pdf(signed, None)
    problems = [*changes, *(facts.damage for facts in signatures if facts.damage)]
    if problems:
        raise InputError(where, f"cannot be signed ({problems[0]})", "Sign a PDF as 'pantocheck run' wrote it.")
    return signed


def _sign_beside(content: bytes, signer: Signer, path: Path) -> bytes:
    where = f"signature '{path.name}'"
    earlier = read_bytes(path, where, MAX_SIGNATURE_BYTES) if path.exists() else None
    for part in [] if earlier is None else parse_signatures(earlier, where):
        if check_cms(content, part, None, None).damage:
            hint = "Remove it if the document was written anew, or choose another file with --out."
            raise InputError(where, "belongs to another version of the document", hint)
    return sign_detached(content, signer, earlier, where)


# Client of a time-stamp server (RFC 3161).
LONGEST_WAIT_S = 30.0
"""Longest wait for an answer of the server [s]."""

MAX_ANSWER_BYTES = 2**20
"""Largest answer that is read [bytes]; a time stamp with its certificates has about ten thousand."""


def build_timestamp_client(url: str) -> Any:
    """Client (TimeStamper of pyHanko) of the server at an address; its requests fail with `InputError`.

    Raises:
        InputError: The address is not one of http or https.
    """
    from asn1crypto import tsp
    from pyhanko.sign.timestamps import TimeStamper

    where = f"time-stamp server {clean_text(url)}"
    if urlsplit(url).scheme not in ("http", "https") or not urlsplit(url).hostname:
        raise InputError(where, "is not the address of a server", "Give an address as https://tsa.example.org/tsr.")

    class Client(TimeStamper):  # type: ignore[misc]  # the base class is known only when the package is installed
        """Client that sends a request by HTTP."""

        async def async_request_tsa_response(self, req: Any) -> Any:
            """Answer of the server to a request."""
            try:
                response = tsp.TimeStampResp.load(_post(url, req.dump(), where), strict=True)
                granted = response["status"]["status"].native == "granted"
                stamp = response["time_stamp_token"]["content"]["encap_content_info"]["content"].parsed
                fits = all(stamp[key].dump() == req[key].dump() for key in ("message_imprint", "nonce"))
            except InputError:
                raise
            except (ValueError, TypeError, KeyError, AttributeError):
                granted = fits = False
            if not (granted and fits):
                found = "its time stamp belongs to another request" if granted else "it answered without a time stamp"
                raise InputError(where, found, "Check the address of the server, or use another one.")
            return response

    return Client()


def _post(url: str, request: bytes, where: str) -> bytes:
    headers = {"Content-Type": "application/timestamp-query", "Accept": "application/timestamp-reply"}
    message = urllib.request.Request(url, request, headers)
    try:
        with urllib.request.urlopen(message, timeout=LONGEST_WAIT_S) as answer:
            return bytes(answer.read(MAX_ANSWER_BYTES))
    except (OSError, HTTPException, ValueError) as error:
        if isinstance(error, HTTPError):
            error.close()
        reason = clean_text(str(getattr(error, "reason", "") or error))
        raise InputError(where, f"gave no time stamp ({reason})", "Check the address and the network.") from None
