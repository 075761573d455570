"""Page of the self-test: the checks of a record and the verdict on every mutant."""

from pantocheck.conformance.consistency.record_checks import RECORD_CHECKS
from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.self_test.bench import MutantResult, SelfTest
from pantocheck.conformance.self_test.numerical_faults import NumericalResult

LIMITS_ALONE_KEY = (
    "Limits alone: verdict without the checks. Where it is ",
    doc.Code("pass"),
    ", the fault would go unnoticed. Where it is ",
    doc.Code("skip"),
    ", a quantity could not be computed: the verdict is not ",
    doc.Code("pass"),
    ", but the reason would be missing.",
)
UNDETECTED_FAULTS = (
    "A gain within 3 % and a shift of a few milliseconds stay below the tolerances of the dynamics check, which allow "
    "for other integration schemes and for rounding. A record of force and position alone cannot be checked for "
    "dynamics: deliver contact height and uplift. A mesh of 4 m can stay within the limits; the table shows where."
)

NUMERICAL_FAULTS = (
    "A record of a faulty simulator is consistent with itself, so that no check detects it. The verification up to "
    "50 Hz must detect the faults on every case, except those marked optional, which show its limit of detection."
)


def build_self_test_page(self_test: SelfTest) -> doc.Document:
    """The page `docs/self-test.md`."""
    reference = tuple(
        ("The unchanged system on ", doc.Code(case), ": ", doc.Code(verdict))
        for case, (verdict, _) in self_test.reference.items()
    )
    return doc.Document(
        title="Self-test",
        header=doc.PlainHeader(
            "Self-test: can the suite fail?",
            "Show that the suite detects faulty simulators. The self-test grades the reference simulator, which must "
            "pass, and mutants of it. A mutant is a system with one deliberate fault, which must end in fail or error "
            "for the reason stated here.",
        ),
        blocks=(
            doc.Paragraph(
                ("Written by ", doc.Code("pantocheck system self-test --markdown docs/self-test.md"), "; do not edit.")
            ),
            doc.Section(
                "Checks of a record",
                (
                    doc.Paragraph(
                        "The limits of a case bound statistics of the force. A wrong record can have statistics inside "
                        "them. Every record therefore undergoes checks that need no other simulator."
                    ),
                    _checks(),
                    doc.Paragraph(
                        "A record that contradicts itself ends as error before any limit. If the channel of a check is "
                        "missing, a note of the case says so."
                    ),
                ),
            ),
            doc.Section(
                "Detected faults",
                (doc.BulletList(reference), _mutants(self_test.severe), doc.Paragraph(LIMITS_ALONE_KEY)),
            ),
            doc.Section(
                "Numerical faults and the two verdicts",
                (doc.Paragraph(NUMERICAL_FAULTS), _numerical_faults(self_test.numerical)),
            ),
            doc.Section(
                "Faults that may remain undetected",
                (
                    doc.Paragraph("Smaller faults of the same kinds show the limit of detection."),
                    _mild_mutants(self_test.mild),
                    doc.Paragraph(UNDETECTED_FAULTS),
                ),
            ),
        ),
    )


def _checks() -> doc.Table:
    columns = ("Check", "Condition", "Needs", "Reason")
    rows = tuple((check.name, check.must_hold, check.needs, check.why) for check in RECORD_CHECKS)
    return doc.Table(tuple(map(doc.Column, columns)), rows)


def _mutants(rows: tuple[MutantResult, ...]) -> doc.Table:
    columns = ("Mutant", "Fault", "Case", "Verdict", "Detected by", "Limits alone", "Quantities outside their limits")
    cells = tuple((*_fault(row), row.mutant.expected_check or "–", row.by_limits, _names(row.outside)) for row in rows)
    return doc.Table(tuple(map(doc.Column, columns)), cells)


def _mild_mutants(rows: tuple[MutantResult, ...]) -> doc.Table:
    columns = ("Mutant", "Fault", "Case", "Verdict", "Failed check", "Quantities outside their limits")
    cells = tuple((*_fault(row), ", ".join(row.checks) or "none", _names(row.outside)) for row in rows)
    return doc.Table(tuple(map(doc.Column, columns)), cells)


def _numerical_faults(rows: tuple[NumericalResult, ...]) -> doc.Table:
    columns = ("Fault", "Case", "EN 50318 criteria", "Verification", "Verified quantities outside their limits")
    cells = tuple(
        (
            row.fault.name if row.fault.must_be_detected else f"{row.fault.name} (optional)",
            doc.Code(row.case),
            row.criteria,
            row.verification,
            _names(row.outside),
        )
        for row in rows
    )
    return doc.Table(tuple(map(doc.Column, columns)), cells)


def _fault(row: MutantResult) -> tuple[doc.RichText, ...]:
    return row.mutant.name, row.mutant.fault, doc.Code(row.case), row.verdict


def _names(quantities: tuple[str, ...]) -> doc.RichText:
    if not quantities:
        return "none"
    return tuple(part for name in quantities for part in (", ", doc.Code(name)))[1:]
