"""Table of the findings of publications that the cases of a run grade."""

from collections.abc import Iterator

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.findings import GradedFinding
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.criteria_table import describe_criterion
from pantocheck.conformance.results.results_format import CaseResult, Results

FINDING_MEANING = (
    "Imposed: the inputs were chosen with this finding, so meeting it shows nothing. Held out: they were chosen "
    "without it. Only held-out findings inside their bounds count as reproduced. Inferred: the publication does not "
    "state it; counted apart."
)


def build_findings_section(results: Results) -> tuple[doc.Section, ...]:
    """Section with every finding of a run, its bounds and its outcome; empty without findings."""
    rows = tuple(_build_finding_row(*graded) for graded in list_findings(results))
    if not rows:
        return ()
    columns = (
        doc.Column("Section", share=1),
        doc.Column("Finding", share=6.5),
        doc.Column("Printed", share=1.2),
        doc.Column("Computed", number=True),
        doc.Column("Bounds", number=True),
        doc.Column("Trust"),
        doc.Column("Outcome", share=1.3),
    )
    counts = doc.Paragraph(" ".join(describe_counts(results)))
    table = doc.Table(columns, rows, layout="cards")
    return (doc.Section("Findings", (counts, table, doc.SmallPrint(FINDING_MEANING)), anchor="findings"),)


def list_findings(results: Results) -> Iterator[tuple[CaseResult, Criterion, GradedFinding]]:
    """Cases and their criteria that grade a finding, in the order of the sections of the publication."""
    graded = [(case, row, row.finding) for case in results.cases for row in case.criteria if row.finding is not None]
    yield from sorted(graded, key=lambda item: item[2].section)


def describe_counts(results: Results) -> list[str]:
    """Sentence on the numbers of findings by outcome; none without findings."""
    if results.findings is None:
        return []
    counts = {name.replace("_", " "): number for name, number in results.findings}
    always = ("imposed", "reproduced", "not reproduced")
    shown = [f"{number} {name}" for name, number in counts.items() if number or name in always]
    return [f"Findings: {', '.join(shown)}."]


def _build_finding_row(case: CaseResult, row: Criterion, finding: GradedFinding) -> tuple[doc.RichText, ...]:
    texts = describe_criterion(row)
    remarks = [finding.tolerance, finding.sensitivity if finding.outcome == "not_reproduced" else ""]
    remark = doc.Remark(" ".join(filter(None, (f"{case.id}:", *remarks))))
    return (
        finding.section,
        (finding.sentence, remark),
        finding.printed,
        texts.value,
        texts.limits,
        doc.TrustMark(texts.trust),
        _describe_outcome(finding),
    )


def _describe_outcome(finding: GradedFinding) -> str:
    """Outcome of a finding, and its role if the outcome does not state it."""
    outcome = finding.outcome.replace("_", " ")
    return f"imposed, {outcome}" if finding.role == "imposed" != outcome else outcome
