"""`pantocheck verify`: grading of the results in a certificate once more."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.authenticity.signatures.signature_check import check_signatures
from pantocheck.conformance.authenticity.signatures.signature_facts import describe_signatures
from pantocheck.conformance.authenticity.verification import verify_certificate
from pantocheck.conformance.command_line.guard import strip_control_characters
from pantocheck.conformance.command_line.results_output import EXIT_CODES


def verify_command(
    certificate: Annotated[Path, typer.Argument(metavar="CERTIFICATE.pdf", help="Certificate to verify.")],
    trust_roots: Annotated[
        Path | None, typer.Option(help="PEM file of the authorities whose signatures are trusted.")
    ] = None,
) -> None:
    """Check that the verdict of a certificate follows from its numbers.

    The results in the PDF are graded again. Exit code 0: every verdict and margin follows from the numbers, and the
    verdict is `pass`. Exit code 1: discrepancies, which are listed, or another verdict. Exit code 2: the verdict is
    `error`, or the file is not a certificate.

    A signature shows who made the certificate: with --trust-roots, every signature must lead to one of these
    authorities. Without, signers are named, but not trusted. The check does not show that the limits are those of the
    library.

    Example: pantocheck verify report/certificate.pdf
    """
    verification = verify_certificate(certificate)
    size = f"{_count(verification.cases, 'case', 'cases')}, {verification.criteria} criteria"
    report = check_signatures(certificate, trust_roots)
    discrepancies = (*verification.discrepancies, *report.contradictions)
    if not discrepancies:
        word = "authentic" if report.authentic else "consistent"
        typer.echo(f"{word}: the verdict '{verification.verdict}' follows from the embedded numbers ({size}).")
    else:
        count = _count(len(discrepancies), "discrepancy", "discrepancies")
        typer.echo(f"not consistent: {count} ({size}; stated verdict '{verification.verdict}').")
    for text in (*(f"  {text}" for text in discrepancies), *describe_signatures(report)):
        typer.echo(strip_control_characters(text))
    raise typer.Exit(1 if discrepancies else EXIT_CODES[verification.verdict])


def _count(number: int, singular: str, plural: str) -> str:
    return f"{number} {singular if number == 1 else plural}"
