"""Signature files beside a document: CMS in DER or PEM."""

import base64
import textwrap
from pathlib import Path
from typing import Any, Literal

from pantocheck.conformance.input_files.input_error import InputError

Encoding = Literal["der", "pem"]
"""Form of a signature file: binary, or text."""

MAX_SIGNATURE_BYTES = 2**22
"""Largest signature file that is read [bytes]; one signature with time stamp and chain has about twenty thousand."""

MOST_SIGNATURES = 50
"""Largest number of signatures of a document that are checked."""


def find_signature_file(path: Path) -> Path:
    """Place of the detached signature of a file, beside it: `results.json.p7s`."""
    return path.with_name(path.name + ".p7s")


def parse_signatures(content: bytes, where: str) -> list[Any]:
    """Signatures of a signature file, each as signed data with one signer.

    Args:
        content: Content of the file in DER or PEM.
        where: Name of the file in messages.

    Returns:
        At least one (asn1crypto.cms.SignedData).

    Raises:
        InputError: The file is not a detached CMS signature, is damaged, or has too many signatures.
    """
    from asn1crypto import cms, pem

    hint = "Give a detached CMS signature, as 'pantocheck sign' writes it."
    try:
        if pem.detect(content):
            content = pem.unarmor(content)[2]
        message = cms.ContentInfo.load(content, strict=True)
        if message["content_type"].native != "signed_data":
            raise InputError(where, f"a message of the kind '{message['content_type'].native}'", hint)
        joined = message["content"]
        _ = joined.native  # reads every field, so that a damaged one is reported here
    except InputError:
        raise
    except (ValueError, TypeError, KeyError, AttributeError):
        raise InputError(where, "no CMS signature, or a damaged one", hint) from None
    if joined["encap_content_info"]["content"].native is not None:
        raise InputError(where, "a signature that contains its content", hint)
    number = len(joined["signer_infos"])
    if not 1 <= number <= MOST_SIGNATURES:
        raise InputError(where, f"{number} signatures", f"At least 1 and at most {MOST_SIGNATURES} are accepted.")
    return [_separate(joined, info) for info in joined["signer_infos"]]


def encode_pem(content: bytes) -> bytes:
    """PEM text of a signature in DER (RFC 7468, label CMS)."""
    lines = textwrap.wrap(base64.b64encode(content).decode("ascii"), 64)
    return "\n".join(["-----BEGIN CMS-----", *lines, "-----END CMS-----", ""]).encode("ascii")


def _separate(joined: Any, signer_info: Any) -> Any:
    """The signed data of one signer, with all certificates."""
    part = joined.untag()
    part["signer_infos"] = [signer_info]
    return part
