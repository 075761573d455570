"""Verification of a document: its results are graded again, its pages are made again, its cases are compared."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from pantocheck.conformance.core.criterion import COMPONENT_NAMES
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.documents.authenticity_check import DocumentCheck, judge_details, shorten_details
from pantocheck.conformance.documents.cms_check import SignatureReport, describe_signatures
from pantocheck.conformance.documents.document_reading import (
    Certificate,
    PdfCertificate,
    ResultsFile,
    find_false_version,
    list_revision_ends,
    list_suite_differences,
    list_version_differences,
    read_certificate,
)
from pantocheck.conformance.documents.library_check import check_library
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.documents.row_check import check_rows
from pantocheck.conformance.documents.signal_check import find_signal_gaps
from pantocheck.conformance.documents.signature_check import is_signed_pdf
from pantocheck.conformance.results.results_format import CaseResult, Results

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
    """Verify a certificate as PDF or HTML page, or a results.json.

    A consistent document has verdicts that follow from its numbers, pages that follow from its results, and the cases
    of the library. Only a record or a new run shows that the numbers come from the named system.

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
        _check_pages(document),
        *updates,
        *check_library(results),
        *check_rows(results),
        *_name_reference(results),
    )
    return Verification(results, (*_name_versions(document, checks), *checks))


def _check_pages(document: Certificate) -> DocumentCheck:
    """Check of the pages, or of the layout of a results.json."""
    if not isinstance(document, ResultsFile):
        from pantocheck.conformance.documents.page_check import check_pages  # plots, which no results.json needs

        return check_pages(document)
    if document.content == document.results.to_json():
        return DocumentCheck("proved", "The file is as Pantocheck writes it.")
    if list_version_differences(document):
        return DocumentCheck("incomplete", "The layout of the file was not compared.")
    text = "the file is not as Pantocheck writes it: keys, their order, digits or spaces differ"
    return DocumentCheck("contradicted", "The file is not as Pantocheck writes it.", (text,))


def _name_versions(document: Certificate, checks: Iterable[DocumentCheck]) -> list[DocumentCheck]:
    """Other versions than the installed ones; pages with equal bytes do not depend on those of their renderer."""
    differences = tuple(list_version_differences(document))
    if list_suite_differences(document.results) or any(check.outcome == "incomplete" for check in checks):
        text = "Other versions made this document; install them to compare it in full."
        return [DocumentCheck("incomplete", text, differences)]
    if differences:
        return [DocumentCheck("open", "The software that made the pages: it states other versions.", differences)]
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


# Check of the origin of a document: its signatures in the words of a verification.
def check_origin(report: SignatureReport) -> list[DocumentCheck]:
    """Checks of a verification that follow from the signatures of a document.

    A signature that could not be checked leaves the verification incomplete, because it may cover changed pages.
    """
    lines = tuple(describe_signatures(report))
    checks = []
    if report.changes:
        text = "The file was changed after signing." if report.signatures else "The signatures cannot be read."
        checks.append(DocumentCheck("contradicted", text, report.changes))
    if report.damages:
        checks.append(DocumentCheck("contradicted", "A signature does not hold for this file.", report.damages))
    if report.note:
        return [*checks, DocumentCheck("incomplete", "The origin of the document.", lines)]
    if report.signatures and not checks:
        checks.append(DocumentCheck("proved", UNCHANGED if len(report.signatures) == 1 else ALL_UNCHANGED))
    if report.authentic:
        return [*checks, DocumentCheck("proved", "Every signer leads to a given trust root.", lines)]
    return [*checks, DocumentCheck("open", "The origin of the document.", lines)]


UNCHANGED = "The signature holds: it covers the whole file, and nothing was changed since."
ALL_UNCHANGED = "Every signature holds: they cover the whole file, and only signatures were added since the first."


# Completeness of results: parts that every run writes must not be missing.
#
# Whoever strips curves, uncertainties or the state of a record could hide a contradiction. A missing part is therefore
# a discrepancy, unless the results state why there is none.
REASONS = ("not known", "does not apply")
"""Beginnings of a basis that explains why a component of the uncertainty is missing."""


def find_gaps(results: Results) -> list[str]:
    """Missing parts of results, as sentences."""
    only_verified = bool(results.cases) and all(case.id in results.verification_only for case in results.cases)
    gaps = [] if results.scope else ["scope is missing"]
    if results.criteria_verdict is None and not only_verified:
        gaps.append("criteria_verdict is missing")
    return gaps + [f"{case.id}: {gap}" for case in results.cases for gap in _find_case_gaps(case)]


def _find_case_gaps(case: CaseResult) -> Iterator[str]:
    if case.criteria_verdict is None and not case.profile:
        yield "criteria_verdict is missing"
    yield from _find_record_gap(case)
    yield from _find_start_gap(case)
    if case.quantities:
        yield from _find_uncertainty_gaps(case)
    yield from find_signal_gaps(case)
    if case.run.rate_Hz is not None and case.run.evaluated_m is not None:
        yield from _find_trace_gaps(case)


def _find_record_gap(case: CaseResult) -> Iterator[str]:
    """A graded passage states whether its record was consistent."""
    ungraded = not case.criteria and case.reason and case.verdict in ("skip", "error")
    if case.record is None and case.run.evaluated_m is not None and not ungraded:
        yield "the state of the record is missing"


def _find_start_gap(case: CaseResult) -> Iterator[str]:
    """A start that differs from that of the case is a warning, one that is not stated a note."""
    record = case.record
    if record is None or record.start_text is None or case.reason:
        return
    texts = case.warnings if record.start == "differs" else case.notes
    if record.start != "as in the case" and record.start_text not in texts:
        yield "the remark on the start of the record is missing"


def _find_trace_gaps(case: CaseResult) -> Iterator[str]:
    """A record with samples has the curves of every pantograph, and of the uplift where there is one."""
    for owner, quantities in case.quantities.items():
        if owner == "0" or "mean_force_N" not in quantities:
            continue
        trace = case.traces.get(owner)
        if trace is None:
            yield f"pantograph {owner}: the curves are missing"
        elif not trace.position_m or not trace.force_N or not trace.spectrum.frequency_Hz:
            yield f"pantograph {owner}: the curve of the force or its spectrum is empty"
        elif "std_force_N" in quantities and (not trace.force_20_N or trace.std_N is None or trace.histogram is None):
            yield f"pantograph {owner}: the curve, deviation or histogram of the 20 Hz force is missing"
    if "max_uplift_at_support_mm" in case.quantities.get("0", {}) and not case.uplift and case.profile is None:
        yield "the curves of the uplift are missing"


def _find_uncertainty_gaps(case: CaseResult) -> Iterator[str]:
    """Every component of the uncertainty has a basis; one that is known has values."""
    for name in COMPONENT_NAMES:
        basis = case.uncertainty_basis.get(name)
        if name == "alignment" and not any(source.record == "graded" for source in case.sources):
            continue  # one clock
        if basis is None:
            yield f"the basis of the uncertainty '{name}' is missing"
        elif not basis.startswith(REASONS) and not any(
            name in parts for quantities in case.uncertainty_components.values() for parts in quantities.values()
        ):
            yield f"the uncertainty '{name}' has a basis, but no value"
    for row in case.criteria:
        known = case.uncertainty_components.get(str(row.pantograph), {}).get(row.quantity, {})
        graded = row.value is not None and not row.is_drift and (row.lower, row.upper) != (None, None)
        if known and graded and not row.components:
            yield f"{row.quantity} of pantograph {row.pantograph}: the components of its uncertainty are missing"


# Updates that were appended to a PDF after it was written.
#
# A signature is such an update, and its check accepts no other one. An unsigned document has none: an update could
# change every page.
def check_updates(document: PdfCertificate) -> list[DocumentCheck]:
    """Check the part of a file behind its first revision; no check if there is none, or if the document is signed."""
    content = document.content
    ends = list_revision_ends(content)
    if is_signed_pdf(content) or not ends or not content[ends[0] :].strip():
        return []
    text = f"{len(content) - ends[0]} bytes were appended after the document was written, and no signature covers them"
    return [DocumentCheck("contradicted", "The file was changed after it was written.", (text,))]
