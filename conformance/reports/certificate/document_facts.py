"""Identity of a report on its page 1: administrative data, date, digest, verification and signature."""

from pantocheck.conformance.reports.certificate.scope_page import list_sources
from pantocheck.conformance.reports.document import Facts, Section
from pantocheck.conformance.reports.formats.reproducibility import format_date
from pantocheck.conformance.results.administration import Administration
from pantocheck.conformance.results.results_format import Results

ADMINISTRATION = {
    "report_number": "Report number",
    "issuer": "Issuer",
    "organisation": "Organisation",
    "contact": "Contact",
    "assessor": "Assessor",
    "remarks": "Remarks",
}
"""Labels of the administrative data in the order of the page."""

NO_ISSUER = "not stated"
SIGNATURE = "added to the file after writing, if any; the command below shows its state"
VERIFICATION = "pantocheck verify FILE, with the name of this file"


def build_document_section(results: Results, digest: str, date: int) -> Section:
    """Section on the identity of a report.

    Args:
        results: Results from `prepare_results`.
        digest: Digest of the results before their preparation; it covers the administrative data, and not the page.
        date: Date of the document [s since 1970]; 0: not known.
    """
    pairs = (
        *list_administration(results.administration),
        ("Date of this document", format_date(date)),
        ("Digest of the results", digest),
        *list_sources(results),
        ("Signature", SIGNATURE),
        ("Verification", VERIFICATION),
    )
    return Section("Document", (Facts(tuple(pair for pair in pairs if pair[1])),), anchor="document")


def list_administration(administration: Administration | None) -> tuple[tuple[str, str], ...]:
    """Labels and texts of the administrative data; without an issuer, that it is not stated."""
    stated = {key: text for key, text in (administration or ()) if text is not None}
    known = {"issuer": NO_ISSUER, **stated}
    return tuple((label, known[key]) for key, label in ADMINISTRATION.items() if key in known)
