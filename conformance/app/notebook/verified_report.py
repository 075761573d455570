"""Verification of reports in Python: the checks of a certificate or a results.json."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pantocheck.conformance.app.notebook.display import describe_in_one_line, tabulate_rows
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.documents.authenticity_check import DocumentCheck
from pantocheck.conformance.documents.library_check import check_outside_cases
from pantocheck.conformance.documents.repetition_check import check_record_quantities, check_rerun
from pantocheck.conformance.documents.signature_check import check_signatures
from pantocheck.conformance.documents.verification import DocumentState, Verification, check_origin, verify_document


@dataclass(frozen=True)
class VerifiedReport:
    """Checks of a report."""

    verification: Verification
    """Results inside the report, and the checks."""
    authentic: bool
    """Whether the report is consistent, and every signature leads to a trust root."""

    def __repr__(self) -> str:
        """State, verdict and number of checks in one line."""
        return describe_in_one_line(self, self.state, f"verdict {self.verdict}", count_noun(len(self.checks), "check"))

    @property
    def verdict(self) -> Verdict:
        """Verdict that the report states."""
        return self.verification.verdict

    @property
    def state(self) -> DocumentState:
        """State: `consistent`, `incomplete` (of another version, compared in part) or `contradicted`."""
        return self.verification.state

    @property
    def checks(self) -> tuple[DocumentCheck, ...]:
        """Checks with `outcome`, `statement` and `details`, in the order of reports."""
        return self.verification.checks

    @property
    def contradictions(self) -> tuple[str, ...]:
        """Contradictions, one line each."""
        return self.verification.discrepancies

    def to_dataframe(self) -> Any:
        """Checks, one per row: a table of pandas, or columns of numpy."""
        rows = [{"outcome": check.outcome, "statement": check.statement} for check in self.checks]
        return tabulate_rows(rows, ("outcome", "statement"))


def verify_report(
    report: str | Path,
    records: Sequence[str | Path] = (),
    rerun: bool = False,
    trust_roots: str | Path | None = None,
    cases: Sequence[str | Path] = (),
) -> VerifiedReport:
    """Verify a report, as `pantocheck verify` does.

    The results in the report are graded again, its pages are made again, its cases are compared with the library, and
    its signatures are checked.

    Args:
        report: Path of a certificate.pdf, certificate.html or results.json.
        records: Records of cases: their quantities are computed from the samples again.
        rerun: Whether the reference simulator runs the cases again.
        trust_roots: PEM file of the authorities whose signatures are trusted.
        cases: Folders with further cases, whose ids begin with `own/`.

    Raises:
        InputError: A file cannot be read, is damaged, or is no report.
    """
    path, roots = Path(report), None if trust_roots is None else Path(trust_roots)
    verification = verify_document(path)
    signatures = check_signatures(path, roots)
    results, catalogue = verification.results, open_catalogue(cases)
    checks = check_outside_cases(results, catalogue)
    checks += [check for record in records for check in check_record_quantities(results, Path(record), catalogue)]
    if rerun:
        checks += check_rerun(results, catalogue)
    verification = verification.add_checks([*checks, *check_origin(signatures)])
    return VerifiedReport(verification, signatures.authentic and verification.consistent)
