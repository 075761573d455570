"""Signatures in CMS (RFC 5652): signer with role, and detached signatures of files."""

import asyncio
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any
from urllib.parse import quote

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.certificates import run_apart
from pantocheck.conformance.documents.key_files import SigningKey, parse_signatures

ROLE_PREFIX = "urn:pantocheck:role:"
"""Beginning of the name of a role in a signature; roles are names of the kind URI (RFC 5755, section 4.4.5)."""

LONGEST_ROLE = 60
"""Largest number of characters of a role: it is printed on one line of a signature box."""


@dataclass(frozen=True)
class Signer:
    """Signer of a document: key, role, and time-stamp client or None."""

    key: SigningKey
    role: str
    timestamp_client: Any


def check_role(role: str) -> str:
    """Role of a signer without surrounding blanks.

    Raises:
        InputError: It is empty, too long, or has characters that cannot be printed.
    """
    text = role.strip()
    if not (text and text.isprintable() and len(text) <= LONGEST_ROLE):
        hint = f"Give 1 to {LONGEST_ROLE} printable characters, such as author or assessor."
        raise InputError("option --role", f"{role!r} is not the name of a role", hint)
    return text


def build_signer(key: SigningKey) -> Any:
    """Signer of pyHanko from a key and its certificates."""
    from asn1crypto import keys
    from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
    from pyhanko.sign.signers import SimpleSigner
    from pyhanko_certvalidator.registry import SimpleCertificateStore

    store = SimpleCertificateStore()
    store.register_multiple((key.certificate, *key.chain))
    private = key.key.private_bytes(Encoding.DER, PrivateFormat.PKCS8, NoEncryption())
    return SimpleSigner(key.certificate, keys.PrivateKeyInfo.load(private), store)


def build_role_attributes(role: str) -> Any:
    """Signed attributes (CAdES) that state the role of the signer."""
    from asn1crypto import cms, x509
    from pyhanko.sign.ades.api import CAdESSignedAttrSpec, SignerAttrSpec

    name = x509.GeneralName("uniform_resource_identifier", ROLE_PREFIX + quote(role))
    attribute = cms.AttCertAttribute({"type": "role", "values": [cms.RoleSyntax({"role_name": name})]})
    return CAdESSignedAttrSpec(signer_attributes=SignerAttrSpec([attribute], []))


def select_digest(key: SigningKey) -> str:
    """Digest algorithm whose strength fits the key."""
    from pyhanko.sign.signers.pdf_cms import select_suitable_signing_md

    return str(select_suitable_signing_md(key.certificate.public_key))


def sign_detached(content: bytes, signer: Signer, earlier: bytes | None, where: str) -> bytes:
    """Detached signature of a file, added to earlier signatures of the same file.

    Args:
        content: Content of the file.
        signer: The signer.
        earlier: Content of a signature file, to which the signature is added; None for a new one.
        where: Name of the signature file in messages.

    Returns:
        Signature file in DER.

    Raises:
        InputError: The earlier signature file is damaged, or the time-stamp server gave no time stamp.
    """
    from pyhanko.sign.signers.pdf_cms import PdfCMSSignedAttributes

    attributes = PdfCMSSignedAttributes(
        signing_time=datetime.now(UTC).replace(microsecond=0), cades_signed_attrs=build_role_attributes(signer.role)
    )

    def sign() -> Any:
        return asyncio.run(
            build_signer(signer.key).async_sign_general_data(
                content,
                select_digest(signer.key),
                use_cades=True,
                timestamper=signer.timestamp_client,
                signed_attr_settings=attributes,
            )
        )

    added = run_apart(sign)
    parts = [] if earlier is None else parse_signatures(earlier, where)
    return join_signatures([*parts, added["content"]])


def join_signatures(parts: Iterable[Any]) -> bytes:
    """One signature file in DER from several signatures of the same content."""
    from asn1crypto import cms

    parts = list(parts)
    joined: dict[str, dict[bytes, Any]] = {"digest_algorithms": {}, "certificates": {}, "signer_infos": {}}
    for part in parts:
        for key, items in joined.items():
            items.update((item.dump(), item) for item in part[key])
    version = max((part["version"].native for part in parts), key=lambda name: int(name[1:]))
    lists = {key: list(items.values()) for key, items in joined.items()}
    content = {"version": version, "encap_content_info": parts[0]["encap_content_info"]} | lists
    return bytes(cms.ContentInfo({"content_type": "signed_data", "content": cms.SignedData(content)}).dump())
