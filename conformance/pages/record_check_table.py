"""Table of the consistency checks of a record: number, thresholds and outcome of each."""

from collections.abc import Iterator

from pantocheck.conformance.core.check_row import MISGIVINGS, CheckRow, NotMeasured
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.words import format_plain, format_value
from pantocheck.conformance.results.results_format import CaseResult

CHECK_HEADINGS = ("Check", "Number", "Value", "Threshold", "Outcome")
CHECK_DIGITS = 3
CHECK_KEY = (
    "A check confirms the record if its number is not beyond its threshold. A number below an allowance is negative."
)


def describe_row(row: CheckRow) -> tuple[str, str, str, str, str]:
    """Cells of a check: name, number with the part of the record, value, thresholds in its unit, and outcome."""
    basis = row.basis
    if isinstance(basis, NotMeasured):
        return row.check, basis.cause, "–", "–", row.outcome
    limits = [(outcome, basis.thresholds[outcome]) for outcome in reversed(MISGIVINGS) if outcome in basis.thresholds]
    bounds = [f"{outcome} {basis.side} {format_plain(limit)} {basis.unit}".rstrip() for outcome, limit in limits]
    number = f"{basis.measure} ({basis.part})" if basis.part else basis.measure
    value = f"{format_value(basis.number, CHECK_DIGITS)} {basis.unit}".rstrip()
    return row.check, number, value, ", ".join(bounds), row.outcome


def build_check_section(case: CaseResult) -> Iterator[doc.Section]:
    """Folded section on the consistency checks of a case; none without checks."""
    if case.record is not None and case.record.checks:
        shares = (0.0, 3.0, 0.0, 2.0, 0.0)
        columns = tuple(doc.Column(heading, share) for heading, share in zip(CHECK_HEADINGS, shares, strict=True))
        table = doc.Table(columns, tuple(map(describe_row, case.record.checks)))
        yield doc.Section("Consistency checks of the record", (doc.SmallPrint(CHECK_KEY), table), folded=True)
