"""Check of the origin of a document: its signatures in the words of a verification."""

from pantocheck.conformance.authenticity.authenticity_check import DocumentCheck
from pantocheck.conformance.authenticity.signatures.signature_facts import SignatureReport, describe_signatures


def check_origin(report: SignatureReport) -> list[DocumentCheck]:
    """Checks of a verification that follow from the signatures of a document.

    A signature that could not be checked leaves the verification incomplete, because it may cover changed pages.

    Args:
        report: Signatures of the document.
    """
    lines = tuple(describe_signatures(report))
    checks = []
    if report.contradictions:
        text = "The signatures do not hold, or the document was changed after signing."
        checks.append(DocumentCheck("contradicted", text, report.contradictions))
    if report.note:
        return [*checks, DocumentCheck("incomplete", "The origin of the document.", lines)]
    if report.authentic:
        return [DocumentCheck("proved", "Every signature holds, and its signer leads to a given trust root.", lines)]
    return [*checks, DocumentCheck("open", "The origin of the document.", lines)]
