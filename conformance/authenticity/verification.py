"""Verification of a document: its results are graded again, its pages are made again, its cases are compared."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from pantocheck.conformance.authenticity.attachment import PdfCertificate
from pantocheck.conformance.authenticity.authenticity_check import DocumentCheck, judge_details, shorten_details
from pantocheck.conformance.authenticity.certificate_reading import Certificate, read_certificate
from pantocheck.conformance.authenticity.completeness import find_gaps
from pantocheck.conformance.authenticity.library_check import check_library
from pantocheck.conformance.authenticity.page_check import check_pages
from pantocheck.conformance.authenticity.pdf_updates import check_updates
from pantocheck.conformance.authenticity.recomputation import find_discrepancies
from pantocheck.conformance.authenticity.version_differences import (
    find_false_version,
    list_suite_differences,
    list_version_differences,
)
from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.results.results_format import Results

DocumentState = Literal["consistent", "incomplete", "contradicted"]
"""State of a document without a signature: without contradiction, the same but compared in part, or contradicted."""


@dataclass(frozen=True)
class Verification:
    """Result of the verification of a document."""

    results: Results
    """Results inside the document."""
    checks: tuple[DocumentCheck, ...]
    """Checks in the order of reports."""

    @property
    def verdict(self) -> Verdict:
        """Verdict stated in the results."""
        return self.results.verdict

    @property
    def cases(self) -> int:
        """Number of cases."""
        return len(self.results.cases)

    @property
    def criteria(self) -> int:
        """Number of criteria, those of the verification up to 50 Hz included."""
        return sum(
            len(case.criteria) + (0 if case.verification is None else len(case.verification.criteria))
            for case in self.results.cases
        )

    @property
    def discrepancies(self) -> tuple[str, ...]:
        """Contradictions, one line each."""
        return tuple(line for check in self.checks if check.outcome == "contradicted" for line in check.details)

    @property
    def state(self) -> DocumentState:
        """State of the document, decided by its worst check."""
        outcomes = {check.outcome for check in self.checks}
        if "contradicted" in outcomes:
            return "contradicted"
        return "incomplete" if "incomplete" in outcomes else "consistent"

    @property
    def consistent(self) -> bool:
        """Whether the document was compared in full and contradicts itself nowhere."""
        return self.state == "consistent"

    def add_checks(self, checks: Iterable[DocumentCheck]) -> "Verification":
        """Verification with further checks."""
        return replace(self, checks=(*self.checks, *checks))


def verify_document(path: Path) -> Verification:
    """Verify a certificate or a results.json.

    A consistent document has verdicts that follow from its numbers, pages that follow from its results, and the cases
    of the library. Only a record or a new run shows that the numbers come from the named system.

    Args:
        path: Certificate as PDF or HTML page, or results.json.

    Raises:
        InputError: None of these, damaged, or without valid results.
    """
    return verify_certificate(read_certificate(path))


def verify_certificate(document: Certificate) -> Verification:
    """Verify a document that was read; see `verify_document`."""
    results = document.results
    updates = check_updates(document) if isinstance(document, PdfCertificate) else []
    checks = (
        _check_numbers(results),
        *_check_completeness(results),
        check_pages(document),
        *updates,
        *check_library(results),
        *_name_reference(results),
    )
    return Verification(results, (*_name_versions(document, checks), *checks))


def _name_versions(document: Certificate, checks: Iterable[DocumentCheck]) -> list[DocumentCheck]:
    """Other versions than the installed ones; nothing depends on them if the document was compared in full."""
    differences = tuple(list_version_differences(document))
    if any(check.outcome == "incomplete" for check in checks):
        text = "Other versions made this document; install them to compare it in full."
        return [DocumentCheck("incomplete", text, differences)]
    if differences:
        return [DocumentCheck("open", "The software that made the document: it states other versions.", differences)]
    return []


def _check_numbers(results: Results) -> DocumentCheck:
    return judge_details(
        "Verdicts, margins, uncertainties and statistics follow from the embedded numbers.",
        "The embedded numbers and verdicts contradict each other.",
        [*find_discrepancies(results), *find_false_version(results)],
    )


def _check_completeness(results: Results) -> list[DocumentCheck]:
    """Missing parts; a document of another version may state less."""
    gaps = tuple(find_gaps(results))
    if gaps and list_suite_differences(results):
        text = "The document states less than one of the installed version."
        return [DocumentCheck("incomplete", text, shorten_details(gaps))]
    return [DocumentCheck("contradicted", "Parts that every run writes are missing.", gaps)] if gaps else []


def _name_reference(results: Results) -> list[DocumentCheck]:
    """Values of the reference simulator: no other number of the document proves them."""
    cases = tuple(case.id for case in results.cases if case.reference is not None)
    text = "The values of the reference simulator, which are shown for information."
    return [DocumentCheck("open", text, cases)] if cases else []
