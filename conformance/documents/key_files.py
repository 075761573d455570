"""Files of signatures: private keys with their certificates (PKCS#12, PEM), X.509 certificates, CMS signatures."""

import base64
import logging
import textwrap
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal, TypeVar

from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.files import read_bytes
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pages.words import clean_text

AskPassphrase = Callable[[], bytes]
"""Source of the passphrase; it is called only if the key is encrypted."""

SMALLEST_RSA_KEY = 2048
"""Smallest accepted RSA key [bits]: verification does not trust smaller ones (NIST SP 800-131A)."""


@dataclass(frozen=True)
class SigningKey:
    """Private key with its certificate; its printed form shows neither."""

    key: Any = field(repr=False)
    """Private key of the package cryptography."""
    certificate: Any = field(repr=False)
    """Certificate of the key (asn1crypto)."""
    chain: tuple[Any, ...] = field(repr=False)
    """Certificates of authorities delivered with the key (asn1crypto)."""

    @property
    def holder(self) -> str:
        """Name of the holder of the certificate."""
        return read_name(self.certificate.subject)


def read_signing_key(path: Path, certificate: Path | None, ask: AskPassphrase) -> SigningKey:
    """Read a private key and its certificate.

    Args:
        path: PKCS#12 file with key and certificates, or PEM file with the key.
        certificate: File of the certificate and of its authorities; None if the key file holds them.
        ask: Source of the passphrase.

    Raises:
        InputError: A file cannot be read, the passphrase is wrong, the certificate belongs to another key, is not valid
            now, or must not sign documents, or the key cannot be used.
    """
    where = f"key '{path.name}'"
    content = read_bytes(path, where, MAX_KEY_FILE_BYTES)
    if b"-----BEGIN " in content:
        key, found = _load_pem(content, where, ask), parse_certificates(content, where)
    else:
        key, found = _load_pkcs12(content, where, ask)
    if certificate is not None:
        found = read_certificates(certificate, f"certificate '{certificate.name}'")
    signing_key = _select_certificate(key, found, where)
    _check_usable(signing_key, where)
    return signing_key


def _load_pem(content: bytes, where: str, ask: AskPassphrase) -> Any:
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    try:
        try:
            return load_pem_private_key(content, None)
        except TypeError:  # the key is encrypted
            return load_pem_private_key(content, ask())
    except (ValueError, UnsupportedAlgorithm) as error:
        if isinstance(error, InputError):
            raise
        raise _build_load_error(where, "the file holds no intact private key in PEM format") from None


def _load_pkcs12(content: bytes, where: str, ask: AskPassphrase) -> tuple[Any, list[Any]]:
    from asn1crypto import pkcs12 as structure
    from asn1crypto import x509
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.serialization import Encoding, pkcs12

    try:
        _ = structure.Pfx.load(content, strict=True)["version"].native
    except (ValueError, TypeError):
        raise InputError(
            where, "is neither PKCS#12 nor PEM", "Give a .p12 or .pfx file, or a PEM file and --certificate."
        ) from None
    try:
        with warnings.catch_warnings(action="ignore"):  # some programs write BER in place of DER
            try:
                key, own, others = pkcs12.load_key_and_certificates(content, None)
            except ValueError:  # the file is encrypted
                key, own, others = pkcs12.load_key_and_certificates(content, ask())
    except (ValueError, UnsupportedAlgorithm) as error:
        if isinstance(error, InputError):
            raise
        raise _build_load_error(where, "the file is damaged, or its encryption is not supported") from None
    if key is None:
        raise InputError(where, "holds no private key", "Export the key together with its certificate.")
    certificates = [certificate for certificate in (own, *others) if certificate is not None]
    return key, [x509.Certificate.load(certificate.public_bytes(Encoding.DER)) for certificate in certificates]


def _build_load_error(where: str, otherwise: str) -> InputError:
    return InputError(where, f"the passphrase is wrong, or {otherwise}", "Check the passphrase and the file.")


def _select_certificate(key: Any, certificates: list[Any], where: str) -> SigningKey:
    """The certificate with the public key of a private key; the others are its chain."""
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat

    public = key.public_key().public_bytes(Encoding.DER, PublicFormat.SubjectPublicKeyInfo)
    own = [certificate for certificate in certificates if certificate.public_key.dump() == public]
    if not own:
        found = "holds no certificate" if not certificates else "the signing certificate belongs to another key"
        raise InputError(where, found, "Give the certificate of this key with --certificate.")
    return SigningKey(key, own[0], tuple(other for other in certificates if other is not own[0]))


def _check_usable(key: SigningKey, where: str) -> None:
    """Refuse a key whose signature would not be trusted at the moment of signing."""
    public = key.certificate.public_key
    if public.algorithm not in ("rsa", "ec", "ed25519", "ed448"):
        raise InputError(where, f"holds a key of the kind '{public.algorithm}'", "Use an RSA, EC or Ed25519 key.")
    if public.algorithm == "rsa" and public.bit_size < SMALLEST_RSA_KEY:
        raise InputError(where, f"holds an RSA key of {public.bit_size} bits", f"Use at least {SMALLEST_RSA_KEY} bits.")
    problem = find_validity_problem(key.certificate, datetime.now(UTC)) or find_usage_problem(key.certificate)
    if problem:
        found = f"the signing certificate of '{key.holder}' {problem}"
        raise InputError(where, found, "Request a certificate for signatures from your authority.")


# Signature files beside a document: CMS in DER or PEM.
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
    """Signatures in DER or PEM, at least one, each as signed data with one signer (asn1crypto.cms.SignedData).

    Raises:
        InputError: The file is not a detached CMS signature, is damaged, or has too many signatures.
    """
    import pyhanko.sign.ades.cades_asn1  # noqa: F401  teaches asn1crypto the role of a signer
    from asn1crypto import cms, pem

    hint = "Give a detached CMS signature, as 'pantocheck sign' writes it."
    try:
        if pem.detect(content):
            content = pem.unarmor(content)[2]
        message = cms.ContentInfo.load(content, strict=True)
        if message["content_type"].native != "signed_data":
            raise InputError(where, f"is a message of the kind '{message['content_type'].native}'", hint)
        joined = message["content"]
        _ = joined.native  # reads every field, so that a damaged one is reported here
    except InputError:
        raise
    except (ValueError, TypeError, KeyError, AttributeError):
        raise InputError(where, "is not a CMS signature, or is damaged", hint) from None
    if joined["encap_content_info"]["content"].native is not None:
        raise InputError(where, "is a signature that contains its content", hint)
    number = len(joined["signer_infos"])
    if not 1 <= number <= MOST_SIGNATURES:
        raise InputError(where, f"has {number} signatures", f"At least 1 and at most {MOST_SIGNATURES} are accepted.")
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


# X.509 certificates: reading, names, validity and key usage.
MAX_KEY_FILE_BYTES = 2**20
"""Largest file of keys or certificates that is read [bytes]; the bundle of all public authorities has a quarter."""

LONGEST_HOLDER_NAME = 120
"""Largest number of characters of a name from a certificate in a message."""

SIGNING_USAGES = frozenset({"digital_signature", "non_repudiation"})
"""Key usages: a certificate for signatures needs one of them (RFC 5280, section 4.2.1.3)."""


OTHER_PURPOSES = frozenset({"server_auth", "code_signing", "time_stamping", "ocsp_signing"})
"""Purposes (extended key usages) of servers and programs; a certificate with these alone does not name a person."""


@dataclass(frozen=True)
class TrustRoots:
    """Authorities whose signatures are trusted, and their lists of revoked certificates."""

    certificates: tuple[Any, ...]
    """Certificates of the authorities (asn1crypto.x509.Certificate)."""
    revocation_lists: tuple[Any, ...] = ()
    """Lists of revoked certificates (asn1crypto.crl.CertificateList); none: revocation is not checked."""


def read_trust_roots(path: Path) -> TrustRoots:
    """Read the certificates of a file, and its lists of revoked certificates (PEM blocks `X509 CRL`).

    Raises:
        InputError: The file cannot be read, holds no certificate, or holds a damaged block.
    """
    from asn1crypto import crl, pem

    where = f"trust roots '{path.name}'"
    certificates = read_certificates(path, where)
    content = read_bytes(path, where, MAX_KEY_FILE_BYTES)
    try:
        blocks = pem.unarmor(content, multiple=True) if pem.detect(content) else ()
        lists = [crl.CertificateList.load(der, strict=True) for kind, _, der in blocks if kind == "X509 CRL"]
        for item in lists:
            _ = item.native  # reads every field, so that a damaged one is reported here
    except (ValueError, TypeError):
        raise InputError(where, "holds a damaged revocation list", "Give lists as PEM text.") from None
    return TrustRoots(tuple(certificates), tuple(lists))


def read_certificates(path: Path, where: str) -> list[Any]:
    """Read all certificates of a PEM file, or the certificate of a DER file.

    Returns:
        At least one certificate, in the order of the file (asn1crypto.x509.Certificate).

    Raises:
        InputError: The file cannot be read or holds no certificate.
    """
    certificates = parse_certificates(read_bytes(path, where, MAX_KEY_FILE_BYTES), where)
    if not certificates:
        raise InputError(where, "holds no certificate", "Give a PEM file with -----BEGIN CERTIFICATE----- blocks.")
    return certificates


def parse_certificates(content: bytes, where: str) -> list[Any]:
    """Certificates of PEM text, other blocks left out, or of one DER certificate; errors as in `read_certificates`."""
    from asn1crypto import pem, x509

    try:
        if not pem.detect(content):
            return [x509.Certificate.load(content, strict=True)]
        blocks = pem.unarmor(content, multiple=True)
        certificates = [x509.Certificate.load(der, strict=True) for kind, _, der in blocks if kind == "CERTIFICATE"]
        for certificate in certificates:
            _ = certificate.native  # reads every field, so that a damaged one is reported here
    except (ValueError, TypeError):
        raise InputError(where, "holds a damaged certificate", "Give certificates as PEM text or DER.") from None
    return certificates


def read_name(name: Any) -> str:
    """Common name of a distinguished name, or the whole name without one, cleaned for messages."""
    common = name.native.get("common_name")
    text = common[0] if isinstance(common, list) else common
    shown = clean_text(str(text or name.human_friendly))
    return shown if len(shown) <= LONGEST_HOLDER_NAME else shown[: LONGEST_HOLDER_NAME - 1] + "…"


def find_validity_problem(certificate: Any, moment: datetime) -> str:
    """Reason why a certificate is not valid at a moment; empty if it is valid."""
    validity = certificate["tbs_certificate"]["validity"]
    if moment < validity["not_before"].native:
        return f"is not valid before {format_moment(validity['not_before'].native)}"
    if moment > validity["not_after"].native:
        return f"expired on {format_moment(validity['not_after'].native)}"
    return ""


def find_usage_problem(certificate: Any) -> str:
    """Reason why a certificate must not sign documents; empty if it may."""
    usage = certificate.key_usage_value
    if usage is not None and not SIGNING_USAGES & set(usage.native):
        return "lacks the key usage 'digital signature' or 'non repudiation'"
    purposes = certificate.extended_key_usage_value
    if purposes is not None and OTHER_PURPOSES.issuperset(purposes.native):
        return f"is for other purposes ({', '.join(purposes.native).replace('_', ' ')})"
    return ""


def describe_failure(error: Exception) -> str:
    """Text of an exception of a parser on one short line; its name if it has no text."""
    return clean_text(str(error))[:LONGEST_HOLDER_NAME] or type(error).__name__


def format_moment(moment: datetime) -> str:
    """Date and time in UTC, as `2026-11-22 10:00:00 UTC`."""
    return f"{moment.astimezone(UTC):%Y-%m-%d %H:%M:%S} UTC"


# Package for signatures: pyHanko, which the extra `sign` installs.
Result = TypeVar("Result")


def run_in_own_thread(function: Callable[[], Result]) -> Result:
    """Run a function in a thread of its own: pyHanko starts an event loop, and a notebook has a running one already."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(function).result()


@contextmanager
def use_signature_package() -> Iterator[None]:
    """Import and use pyHanko inside a block, without its log, which repeats failures with tracebacks.

    Raises:
        InputError: The package is not installed.
    """
    log = logging.getLogger("pyhanko")
    level = log.level
    log.setLevel(logging.CRITICAL + 1)
    try:
        with refuse_missing_package("a signature"):
            yield
    finally:
        log.setLevel(level)
