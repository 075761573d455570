"""`pantocheck verify`: verification of a certificate as PDF or HTML page, or of a results.json."""

import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.authenticity.authenticity_check import CheckOutcome
from pantocheck.conformance.authenticity.verification import Verification
from pantocheck.conformance.command_line.cases_option import CasesOption
from pantocheck.conformance.command_line.guard import strip_control_characters
from pantocheck.conformance.command_line.results_output import EXIT_CODES
from pantocheck.conformance.interface.verified_report import verify_report

WIDTH = 80
"""Columns of the output, so that it can be read in any terminal and mail."""

HEADINGS: dict[CheckOutcome, str] = {
    "contradicted": "Contradictions",
    "incomplete": "Not compared in full",
    "proved": "Proved",
    "open": "Not proved",
}
"""Headings of the checks by their outcome, in the order of the output."""


def verify_command(
    document: Annotated[
        Path, typer.Argument(metavar="FILE", help="certificate.pdf, certificate.html or results.json.")
    ],
    trust_roots: Annotated[
        Path | None, typer.Option(help="PEM file of the authorities whose signatures are trusted.")
    ] = None,
    record: Annotated[
        list[Path] | None, typer.Option(help="Record of a case: its quantities are computed from the samples again.")
    ] = None,
    folders: CasesOption = None,
    rerun: Annotated[
        bool, typer.Option("--rerun", help="Run the built-in simulator again and compare every number.")
    ] = False,
    any_verdict: Annotated[
        bool, typer.Option("--any-verdict", help="Exit code 0 for a consistent document of any verdict.")
    ] = False,
) -> None:
    """Verify a document: its verdicts, its pages, its cases and its signatures.

    The results in the document are graded again, the pages are made again and compared, and the cases are compared
    with the installed library. Exit code 0: no contradiction, compared in full, and the verdict is `pass`. Exit code 1:
    another verdict, a contradiction, or a document of another version that cannot be compared in full. Exit code 2: the
    verdict is `error`, or the file is no such document.

    A consistent document need not be authentic: invented results can be consistent. A signature shows who made it: with
    --trust-roots, every signature must lead to one of these authorities. Without, signers are named, but not trusted.

    Invented numbers can be consistent, too. --record computes the quantities of a record again, and --rerun runs the
    built-in simulator again.

    Examples:

    pantocheck verify report/certificate.pdf

    pantocheck verify report/certificate.pdf --rerun --trust-roots authority.pem

    pantocheck verify report/results.json --record run.csv
    """
    report = verify_report(document, record or (), rerun, trust_roots, folders or ())
    word = "authentic" if report.authentic else "consistent"
    typer.echo("\n".join(_describe(report.verification, word)))
    raise typer.Exit(_exit_code(report.verification, any_verdict))


def _exit_code(verification: Verification, any_verdict: bool) -> int:
    if not verification.consistent:
        return 1
    return 0 if any_verdict else EXIT_CODES[verification.verdict]


def _describe(verification: Verification, word: str) -> Iterator[str]:
    size = f"{_count(verification.cases, 'case', 'cases')}, {_count(verification.criteria, 'criterion', 'criteria')}"
    verdict = verification.verdict
    match verification.state:
        case "consistent":
            yield _wrap(f"{word}: the verdict '{verdict}' follows from the embedded numbers ({size}).", "")
        case "incomplete":
            yield _wrap(f"consistent in part: the verdict '{verdict}' follows ({size}), but not all was compared.", "")
        case "contradicted":
            count = _count(len(verification.discrepancies), "contradiction", "contradictions")
            yield _wrap(f"not consistent: {count} ({size}; stated verdict '{verdict}').", "")
    for outcome, heading in HEADINGS.items():
        checks = [check for check in verification.checks if check.outcome == outcome]
        if checks:
            yield f"{heading}:"
        for check in checks:
            yield _wrap(check.statement, "  * ")
            yield from (_wrap(line, "    - ") for line in check.details)


def _wrap(text: str, mark: str) -> str:
    """Paragraph of the width of the output; a long word such as a digest is not broken."""
    return textwrap.fill(
        strip_control_characters(text.strip()),
        WIDTH,
        initial_indent=mark,
        subsequent_indent=" " * len(mark),
        break_on_hyphens=False,
        break_long_words=False,
    )


def _count(number: int, singular: str, plural: str) -> str:
    return f"{number} {singular if number == 1 else plural}"
