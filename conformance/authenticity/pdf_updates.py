"""Updates that were appended to a PDF after it was written.

A signature is such an update, and its check accepts no other one. An unsigned document has none: an update could change
every page.
"""

from pantocheck.conformance.authenticity.attachment import PdfCertificate
from pantocheck.conformance.authenticity.authenticity_check import DocumentCheck
from pantocheck.conformance.authenticity.revision_ends import list_revision_ends
from pantocheck.conformance.authenticity.signatures.signature_check import is_signed_pdf


def check_updates(document: PdfCertificate) -> list[DocumentCheck]:
    """Check the part of a file behind its first revision; no check if there is none, or if the document is signed.

    Args:
        document: Certificate.
    """
    content = document.content
    ends = list_revision_ends(content)
    if is_signed_pdf(content) or not ends or not content[ends[0] :].strip():
        return []
    text = f"{len(content) - ends[0]} bytes were appended after the document was written, and no signature covers them"
    return [DocumentCheck("contradicted", "The file was changed after it was written.", (text,))]
