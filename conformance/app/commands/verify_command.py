"""`pantocheck verify`: verification of a certificate as PDF or HTML page, or of a results.json."""

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.cases_option import CasesOption
from pantocheck.conformance.app.commands.command_output import EXIT_CODES, CommandOutput
from pantocheck.conformance.app.commands.console import escape_text, indent_text
from pantocheck.conformance.app.notebook.verified_report import VerifiedReport, verify_report
from pantocheck.conformance.core.files import file_digest, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.documents.authenticity_check import CheckOutcome
from pantocheck.conformance.documents.verification import Verification
from pantocheck.conformance.pages.verdict_marks import mark_results
from pantocheck.conformance.pages.words import name_verdict

HEADINGS: dict[CheckOutcome, str] = {
    "contradicted": "Contradictions",
    "incomplete": "Not compared in full",
    "proved": "Proved",
    "open": "Not proved",
}
"""Headings of the checks by their outcome, in the order of the output."""


def verify_command(
    document: Annotated[
        Path | None, typer.Argument(metavar="FILE", help="certificate.pdf, certificate.html or results.json.")
    ] = None,
    trust_roots: Annotated[
        Path | None, typer.Option(help="PEM file of the authorities that are trusted, and of their revocation lists.")
    ] = None,
    record: Annotated[
        list[Path] | None, typer.Option(help="Record of a case: its quantities are computed from the samples again.")
    ] = None,
    folders: CasesOption = None,
    rerun: Annotated[
        bool, typer.Option("--rerun", help="Run the built-in simulator again and compare every number.")
    ] = False,
    numbers_only: Annotated[
        bool, typer.Option("--numbers-only", help="Exit code 0 for consistent numbers, whoever made the document.")
    ] = False,
    any_verdict: Annotated[
        bool, typer.Option("--any-verdict", help="Exit code 0 for a document of any verdict.")
    ] = False,
    write_verifier: Annotated[
        Path | None, typer.Option(help="Write the verifier for a browser to this file; without FILE, do no more.")
    ] = None,
) -> CommandOutput:
    """Verify a document: verdicts, pages, cases, signatures.

    The results in the document are graded again, the pages are made again and compared, and the cases are compared
    with the installed library. Exit code 0: the verdict is `pass`, nothing contradicts it, and one of these shows that
    the document is genuine. --trust-roots: every signature leads to one of these authorities. --record, for each case:
    its quantities follow from the record. --rerun: a new run of the built-in simulator gives the same numbers.

    Exit code 1: another verdict, a contradiction, a document of another version, or one of unknown origin. Anyone can
    invent numbers without a contradiction. --numbers-only accepts them. Exit code 2: the verdict is `error`, or the
    file is not such a document.

    Examples:

    pantocheck verify report/certificate.pdf --rerun

    pantocheck verify report/certificate.pdf --trust-roots authority.pem

    pantocheck verify report/results.json --record run.csv

    pantocheck verify --write-verifier verifier.html
    """
    if write_verifier is not None:
        from pantocheck.conformance.grading.results_building import build_suite
        from pantocheck.conformance.pages.page_code import build_verifier

        suite = build_suite()
        write_atomically(write_verifier, build_verifier(suite.version, suite.digest))
        if document is None:
            digest = file_digest(write_verifier)
            conclusion = escape_text(f"Verifier for a browser, {digest}: open it, and drop a certificate on it.")
            return CommandOutput(conclusion, {"digest": digest}, files=[write_verifier])
    if document is None:
        raise InputError("argument FILE", "missing", "Name a certificate or a results.json.")
    report = verify_report(document, record or (), rerun, trust_roots, folders or ())
    verification, numbers_only = report.verification, numbers_only and trust_roots is None
    facts = {name: getattr(verification, name) for name in ("state", "verdict", "cases", "criteria")}
    accepted = verification.consistent and (numbers_only or report.origin in ("authentic", "repeated"))
    exit_code = 1 if not accepted else 0 if any_verdict else EXIT_CODES[verification.verdict]
    return CommandOutput(
        escape_text(_conclude(report, numbers_only)),
        {**facts, "origin": report.origin, "checks": [asdict(check) for check in verification.checks]},
        [*_list_checks(verification)],
        exit_code=exit_code,
    )


def _conclude(report: VerifiedReport, numbers_only: bool) -> str:
    """State of the document in one sentence."""
    verification = report.verification
    size = f"{count_noun(verification.cases, 'case')}, {count_noun(verification.criteria, 'criterion', 'criteria')}"
    verdict = name_verdict(mark_results(verification.results))
    match verification.state:
        case "consistent":
            stated = f"the verdict '{verdict}' follows from the embedded numbers ({size})."
            return f"{_name_origin(report, numbers_only)}{stated}"
        case "incomplete":
            return f"consistent in part: the verdict '{verdict}' follows ({size}), but not all was compared."
        case "contradicted":
            count = count_noun(len(verification.discrepancies), "contradiction")
            return f"not consistent: {count} ({size}; stated verdict '{verdict}')."


def _name_origin(report: VerifiedReport, numbers_only: bool) -> str:
    """Beginning of the sentence on a consistent document."""
    match report.origin:
        case "authentic":
            return "authentic: "
        case "untrusted" if not numbers_only:
            return f"NOT TRUSTED: the document claims to be signed by {', '.join(report.signers)}; "
        case "unsigned" if not numbers_only:
            return "UNSIGNED: the numbers are consistent, anyone can have written this document; "
        case _:
            return "consistent: "


def _list_checks(verification: Verification) -> Iterator[RenderableType]:
    """Checks with their details, by outcome."""
    for outcome, heading in HEADINGS.items():
        checks = [check for check in verification.checks if check.outcome == outcome]
        if checks:
            yield Text(f"{heading}:")
        for check in checks:
            yield indent_text(check.statement.strip(), "  * ")
            yield from (indent_text(line.strip(), "    - ") for line in check.details)
