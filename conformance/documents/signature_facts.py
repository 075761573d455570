"""Result of the check of signatures: one entry per signature, and changes of the document."""

from dataclasses import dataclass
from datetime import datetime

from pantocheck.conformance.documents.certificates import format_moment


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

    @property
    def contradictions(self) -> tuple[str, ...]:
        """Damaged signatures and changes of the document, and signers who are not trusted although roots are given."""
        lines = [*self.changes]
        for number, facts in enumerate(self.signatures, 1):
            if facts.damage:
                lines.append(f"signature {number} ({facts.signer}): {facts.damage}")
            elif self.roots_given and facts.distrust:
                lines.append(f"signature {number} ({facts.signer}): not trusted, {facts.distrust}")
        if self.roots_given and not self.signatures:
            lines.append(self.note or "no signature, although trust roots are given")
        return tuple(lines)

    @property
    def authentic(self) -> bool:
        """Whether every signature leads to a given trust root, there is one, and nothing was changed since."""
        return bool(self.signatures) and self.roots_given and not self.contradictions


def describe_signatures(report: SignatureReport) -> list[str]:
    """Signatures in words, one or more lines each: signer, role, time, trust, and limits of the check."""
    if not report.signatures:
        return [report.note or "unsigned: nothing shows who made this document."]
    lines = []
    for number, facts in enumerate(report.signatures, 1):
        role = f" as {facts.role}" if facts.role else ""
        lines.append(f"signature {number}: signed by {facts.signer}{role} ({_describe_trust(facts)}).")
        lines.append(f"  Signing certificate issued by {facts.issuer}. {_describe_time(facts)}")
    return [*lines, "Revocation of certificates was not checked: verification uses no network."]


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
