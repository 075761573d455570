"""Check of a CMS signature: content, chain, validity, key usage and time stamp; and its result in words."""

from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Any
from urllib.parse import unquote

from pantocheck.conformance.documents.key_files import (
    TrustRoots,
    describe_failure,
    find_usage_problem,
    find_validity_problem,
    format_moment,
    read_name,
    run_in_own_thread,
)
from pantocheck.conformance.documents.signature_writing import ROLE_PREFIX
from pantocheck.conformance.pages.words import clean_text


@dataclass(frozen=True)
class SignatureFacts:
    """One signature; texts from its certificate are cleaned for terminals and pages."""

    signer: str
    """Name of the holder of the certificate."""
    issuer: str
    """Name of the authority that issued the certificate."""
    role: str
    """Role that the signer states; empty if none is stated."""
    damage: str
    """Reason why the signature does not hold for the content; empty if it holds."""
    distrust: str
    """Reason why the signer is not trusted; empty if the chain leads to a given trust root."""
    root: str
    """Name of the trust root at the end of the chain; empty if the signer is not trusted."""
    stated_time: datetime | None
    """Time of the signature by the clock of the signer."""
    stamped_time: datetime | None
    """Time of a time stamp whose authority is trusted."""
    stamp_problem: str
    """Reason why a time stamp does not count; empty without a time stamp, or with one that counts."""
    checked_at: datetime
    """Moment at which the validity of the certificates was checked."""

    @property
    def trusted(self) -> bool:
        """Whether the content is unchanged and the signer is trusted."""
        return not self.damage and not self.distrust


@dataclass(frozen=True)
class SignatureReport:
    """Signatures of a document."""

    signatures: tuple[SignatureFacts, ...]
    """In the order of signing."""
    changes: tuple[str, ...]
    """Changes of the document other than signatures, one line each."""
    roots_given: bool
    """Whether the user named trust roots."""
    note: str = ""
    """Reason why signatures were not checked; empty if they were."""
    lists_given: bool = False
    """Whether the user gave lists of revoked certificates."""

    @property
    def contradictions(self) -> tuple[str, ...]:
        """Changes of the document and damaged signatures; an unknown signer contradicts nothing."""
        return self.changes + self.damages

    @property
    def damages(self) -> tuple[str, ...]:
        """Signatures that do not hold for the content."""
        damaged = ((number, facts) for number, facts in enumerate(self.signatures, 1) if facts.damage)
        return tuple(f"signature {number} ({facts.signer}): {facts.damage}" for number, facts in damaged)

    @property
    def authentic(self) -> bool:
        """Whether every signature leads to a given trust root, there is one, and nothing was changed since."""
        return bool(self.signatures) and not self.changes and all(facts.trusted for facts in self.signatures)


def describe_signatures(report: SignatureReport) -> list[str]:
    """Signatures in words, one or more lines each: signer, role, time, trust, and limits of the check."""
    if not report.signatures:
        compared = [NO_SIGNATURE] if report.roots_given and not report.note else []
        return [report.note or "unsigned: nothing shows who made this document.", *compared]
    lines = []
    for number, facts in enumerate(report.signatures, 1):
        role = f" as {facts.role}" if facts.role else ""
        signed = "signed by" if facts.trusted else "claims to be signed by"
        lines.append(f"signature {number}: {signed} {facts.signer}{role} ({_describe_trust(facts)}).")
        lines.append(f"  Signing certificate issued by {facts.issuer}. {_describe_time(facts)}")
    return [*lines, REVOCATION if report.lists_given else NO_REVOCATION]


NO_SIGNATURE = "The document has no signature to compare with the trust roots."
REVOCATION = "Revocation of certificates was checked by the lists among the trust roots."
NO_REVOCATION = "Revocation of certificates was not checked: verification uses no network."


def _describe_trust(facts: SignatureFacts) -> str:
    if facts.damage:
        return f"invalid: {facts.damage}"
    return f"not trusted: {facts.distrust}" if facts.distrust else f"trusted: its chain leads to {facts.root}"


def _describe_time(facts: SignatureFacts) -> str:
    if facts.stamped_time is not None:
        return f"Time stamp: {format_moment(facts.stamped_time)}; validity was checked at this time."
    stated = (
        "no time stated" if facts.stated_time is None else f"{format_moment(facts.stated_time)} by the signer's clock"
    )
    stamp = f"time stamp not used: {facts.stamp_problem}" if facts.stamp_problem else "no time stamp"
    return f"Time: {stated}, {stamp}; validity was checked at the present time."


# Check of one CMS signature: content, chain of certificates, validity, key usage and time stamp.
NO_ROOT = "no trust root given"
UNKNOWN = "unknown"
UNLISTED = "no valid list of revoked certificates is given for a certificate of its chain"


def check_cms(
    content: bytes, signed_data: Any, roots: TrustRoots | None, stated_time: datetime | None
) -> SignatureFacts:
    """Check a signature of some content.

    A trusted time stamp decides the moment at which certificates must be valid; without one it is the present.

    Args:
        content: The signed bytes.
        signed_data: Signature of one signer (asn1crypto.cms.SignedData).
        roots: Trust roots; None if the user gave none.
        stated_time: Time of the signature that the document states outside the signature itself.
    """
    now, trust = datetime.now(UTC), roots or TrustRoots(())
    try:
        status = _validate(content, signed_data, trust, now)
        stamp = status.timestamp_validity
        stamped = stamp is not None and stamp.trusted
        moment = stamp.timestamp if stamped else now
        if stamped:
            status = _validate(content, signed_data, trust, moment)
        unlisted = False
        if trust.revocation_lists and not status.trusted and status.revocation_details is None:
            status = _validate(content, signed_data, replace(trust, revocation_lists=()), moment)
            unlisted = status.trusted
    except Exception as error:  # the packages raise exceptions without a common base for a damaged signature
        return _build_damaged(describe_failure(error), now)
    certificate = status.signing_cert
    damage = "" if status.intact and status.valid else "the content was changed after signing"
    distrust = NO_ROOT if roots is None else UNLISTED if unlisted else _find_distrust(status, moment)
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


def _validate(content: bytes, signed_data: Any, trust: TrustRoots, moment: datetime) -> Any:
    """Status of a signature by pyHanko, with certificates judged at a moment.

    With lists of revoked certificates, every certificate below a root needs a valid one.
    """
    import asyncio

    from pyhanko.sign.validation.generic_cms import async_validate_detached_cms
    from pyhanko.sign.validation.settings import KeyUsageConstraints
    from pyhanko_certvalidator import ValidationContext

    def build_context(time: datetime) -> Any:
        return ValidationContext(
            trust_roots=list(trust.certificates),
            crls=list(trust.revocation_lists),
            allow_fetching=False,
            revocation_mode="require" if trust.revocation_lists else "soft-fail",
            moment=time,
            best_signature_time=time,
        )

    def validate() -> Any:
        """Validate now: in a thread without an event loop."""
        return asyncio.run(
            async_validate_detached_cms(
                content,
                signed_data,
                signer_validation_context=build_context(moment),
                ts_validation_context=build_context(datetime.now(UTC)),
                key_usage_settings=KeyUsageConstraints(key_usage=set()),
            )
        )

    return run_in_own_thread(validate)


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
    if revoked := status.revocation_details:
        owner = "the certificate of an authority" if revoked.ca_revoked else "the signing certificate"
        return f"{owner} was revoked on {format_moment(revoked.revocation_date)}{when}"
    if status.validation_path is None:
        return "its chain does not lead to a given trust root"
    for authority in status.validation_path:
        problem = find_validity_problem(authority, moment)
        if problem:
            return f"the certificate of the authority {read_name(authority.subject)} {problem}{when}"
    reason = "" if status.trust_problem_indic is None else f" ({status.trust_problem_indic.standard_name})"
    return f"its chain of certificates is not valid{reason.lower().replace('_', ' ')}"


def _find_stamp_problem(stamp: Any, roots: TrustRoots | None) -> str:
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
