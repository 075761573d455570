"""Check of one CMS signature: content, chain of certificates, validity, key usage and time stamp."""

import asyncio
from datetime import UTC, datetime
from typing import Any
from urllib.parse import unquote

from pantocheck.conformance.documents.certificates import (
    describe_failure,
    find_usage_problem,
    find_validity_problem,
    read_name,
    run_apart,
)
from pantocheck.conformance.documents.cms_signing import ROLE_PREFIX
from pantocheck.conformance.documents.signature_facts import SignatureFacts
from pantocheck.conformance.pages.words import clean_text

NO_ROOT = "no trust root given"
UNKNOWN = "unknown"


def check_cms(
    content: bytes, signed_data: Any, roots: list[Any] | None, stated_time: datetime | None
) -> SignatureFacts:
    """Check a signature of some content.

    A trusted time stamp decides the moment at which certificates must be valid; without one it is the present.

    Args:
        content: The signed bytes.
        signed_data: Signature of one signer (asn1crypto.cms.SignedData).
        roots: Trust roots (asn1crypto.x509.Certificate); None if the user gave none.
        stated_time: Time of the signature that the document states outside the signature itself.
    """
    now = datetime.now(UTC)
    try:
        status = _validate(content, signed_data, roots or [], now)
        stamp = status.timestamp_validity
        stamped = stamp is not None and stamp.trusted
        moment = stamp.timestamp if stamped else now
        if stamped:
            status = _validate(content, signed_data, roots or [], moment)
    except Exception as error:  # the packages raise exceptions without a common base for a damaged signature
        return _build_damaged(describe_failure(error), now)
    certificate = status.signing_cert
    damage = "" if status.intact and status.valid else "the content was changed after signing"
    distrust = NO_ROOT if roots is None else _find_distrust(status, moment)
    return SignatureFacts(
        signer=read_name(certificate.subject),
        issuer=read_name(certificate.issuer),
        role=read_role(signed_data),
        damage=damage,
        distrust=distrust,
        root="" if distrust or damage else read_name(next(iter(status.validation_path)).subject),
        stated_time=status.signer_reported_dt or stated_time,
        stamped_time=moment if stamped else None,
        stamp_problem="" if stamped or stamp is None else _find_stamp_problem(stamp, roots),
        checked_at=moment,
    )


def read_role(signed_data: Any) -> str:
    """Role that the signer states in a signed attribute; empty without one."""
    try:
        for attribute in signed_data["signer_infos"][0]["signed_attrs"]:
            if attribute["type"].native != "signer_attributes_v2":
                continue
            for claim in attribute["values"][0]["claimed_attributes"]:
                if claim["type"].native == "role":
                    name = str(claim["values"][0]["role_name"].native)
                    return clean_text(unquote(name.removeprefix(ROLE_PREFIX)))
    except (ValueError, TypeError, KeyError, IndexError):
        pass
    return ""


def _validate(content: bytes, signed_data: Any, roots: list[Any], moment: datetime) -> Any:
    """Status of a signature by pyHanko, with certificates judged at a moment."""
    from pyhanko.sign.validation.generic_cms import async_validate_detached_cms
    from pyhanko.sign.validation.settings import KeyUsageConstraints
    from pyhanko_certvalidator import ValidationContext

    def build_context(time: datetime) -> Any:
        return ValidationContext(
            trust_roots=list(roots),
            allow_fetching=False,
            revocation_mode="soft-fail",
            moment=time,
            best_signature_time=time,
        )

    def validate() -> Any:
        return asyncio.run(
            async_validate_detached_cms(
                content,
                signed_data,
                signer_validation_context=build_context(moment),
                ts_validation_context=build_context(datetime.now(UTC)),
                key_usage_settings=KeyUsageConstraints(key_usage=set()),
            )
        )

    return run_apart(validate)


def _find_distrust(status: Any, moment: datetime) -> str:
    """Reason why the signer is not trusted at a moment; empty if trusted."""
    certificate = status.signing_cert
    when = (
        ""
        if status.timestamp_validity is not None and status.timestamp_validity.trusted
        else " (no trusted time stamp)"
    )
    validity = find_validity_problem(certificate, moment)
    usage = find_usage_problem(certificate)
    if validity or usage:
        return f"the signing certificate {validity}{when}" if validity else f"the signing certificate {usage}"
    if status.trusted:
        return ""
    if status.validation_path is None:
        return "its chain does not lead to a given trust root"
    for authority in status.validation_path:
        problem = find_validity_problem(authority, moment)
        if problem:
            return f"the certificate of the authority {read_name(authority.subject)} {problem}{when}"
    reason = "" if status.trust_problem_indic is None else f" ({status.trust_problem_indic.standard_name})"
    return f"its chain of certificates is not valid{reason.lower().replace('_', ' ')}"


def _find_stamp_problem(stamp: Any, roots: list[Any] | None) -> str:
    if not (stamp.intact and stamp.valid):
        return "it belongs to other content"
    authority = read_name(stamp.signing_cert.subject)
    return (
        f"its authority {authority} is not trusted ({NO_ROOT if roots is None else 'no valid chain to a trust root'})"
    )


def _build_damaged(reason: str, now: datetime) -> SignatureFacts:
    return SignatureFacts(
        signer=UNKNOWN,
        issuer=UNKNOWN,
        role="",
        damage=f"the signature is damaged ({reason})",
        distrust="",
        root="",
        stated_time=None,
        stamped_time=None,
        stamp_problem="",
        checked_at=now,
    )
