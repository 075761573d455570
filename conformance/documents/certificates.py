"""X.509 certificates: reading, names, validity and key usage."""

import logging
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TypeVar

from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.files import read_bytes
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pages.words import clean_text

MAX_KEY_FILE_BYTES = 2**20
"""Largest file of keys or certificates that is read [bytes]; the bundle of all public authorities has a quarter."""

LONGEST_HOLDER_NAME = 120
"""Largest number of characters of a name from a certificate in a message."""

SIGNING_USAGES = frozenset({"digital_signature", "non_repudiation"})
"""Key usages of which a certificate for signatures needs one (RFC 5280, section 4.2.1.3)."""


OTHER_PURPOSES = frozenset({"server_auth", "code_signing", "time_stamping", "ocsp_signing"})
"""Purposes (extended key usages) of servers and programs; a certificate with these alone does not name a person."""


def read_certificates(path: Path, where: str) -> list[Any]:
    """Read all certificates of a PEM file, or the certificate of a DER file.

    Returns:
        At least one certificate, in the order of the file (asn1crypto.x509.Certificate).

    Raises:
        InputError: The file cannot be read or holds no certificate.
    """
    certificates = parse_certificates(read_bytes(path, where, MAX_KEY_FILE_BYTES), where)
    if not certificates:
        raise InputError(where, "no certificate found", "Give a PEM file with -----BEGIN CERTIFICATE----- blocks.")
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
        raise InputError(where, "a certificate is damaged", "Give certificates as PEM text or DER.") from None
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


def run_apart(function: Callable[[], Result]) -> Result:
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
