"""Verification of reports in Python: the checks of a certificate or a results.json."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pantocheck.conformance.app.notebook.display import describe_in_one_line, tabulate_rows
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.documents.authenticity_check import DocumentCheck
from pantocheck.conformance.documents.cms_check import SignatureReport
from pantocheck.conformance.documents.library_check import check_outside_cases
from pantocheck.conformance.documents.row_check import name_other_rows
from pantocheck.conformance.documents.signature_check import check_signatures
from pantocheck.conformance.documents.verification import DocumentState, Verification, check_origin, verify_document
from pantocheck.conformance.results.results_format import Results

Origin = Literal["authentic", "repeated", "untrusted", "unsigned"]
"""What shows that a report is genuine: its signatures, or its numbers computed again; signatures of unknown authorities
and none show nothing."""


@dataclass(frozen=True)
class VerifiedReport:
    """Checks of a report."""

    verification: Verification
    """Results inside the report, and the checks."""
    origin: Origin
    """What shows that the report is genuine, if it is consistent."""
    signers: tuple[str, ...]
    """Names that the signatures state, in the order of signing."""

    @property
    def authentic(self) -> bool:
        """Whether the report is consistent, and every signature leads to a trust root."""
        return self.verification.consistent and self.origin == "authentic"

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
        InputError: A file cannot be read, is damaged, or is not a report.
    """
    path, roots = Path(report), None if trust_roots is None else Path(trust_roots)
    verification = verify_document(path)
    signatures = check_signatures(path, roots)
    results, catalogue = verification.results, open_catalogue(cases)
    checks, repeated = check_outside_cases(results, catalogue), set[str]()
    if records or rerun:  # signal processing and the simulator
        from pantocheck.conformance.documents import repetition_check as repetition
    for record in map(Path, records):
        checks += repetition.check_record_quantities(results, record, catalogue)
        repeated.add(repetition.find_record_result(results, record).id)
    if rerun:
        checks += repetition.check_rerun(results, catalogue)
        repeated |= repetition.list_known_cases(results, catalogue)
    checks += name_other_rows(results, repeated)
    verification = verification.add_checks([*checks, *check_origin(signatures)])
    origin = _find_origin(signatures, _is_repeated(results, repeated))
    return VerifiedReport(verification, origin, tuple(facts.signer for facts in signatures.signatures))


def _is_repeated(results: Results, repeated: Collection[str]) -> bool:
    """Whether every number that decides was computed again; the steps of a dossier need more than its cases."""
    computed = [case.id for case in results.cases if case.quantities]
    return bool(computed) and results.procedure is None and set(computed) <= set(repeated)


def _find_origin(signatures: SignatureReport, all_repeated: bool) -> Origin:
    if signatures.authentic:
        return "authentic"
    if all_repeated and not signatures.roots_given:
        return "repeated"
    return "untrusted" if signatures.signatures else "unsigned"
