"""`pantocheck verify`: grading of the results in a certificate once more."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.authenticity.verification import verify_certificate
from pantocheck.conformance.command_line.results_output import EXIT_CODES


def verify_command(
    certificate: Annotated[Path, typer.Argument(metavar="CERTIFICATE.pdf", help="Certificate to verify.")],
) -> None:
    """Check that the verdict of a certificate follows from its numbers.

    The results in the PDF are graded again. Exit code 0: every verdict and margin follows from the numbers, and the
    verdict is `pass`. Exit code 1: discrepancies, which are listed, or another verdict. Exit code 2: the verdict is
    `error`, or the file is not a certificate.

    The check does not show who made the certificate, nor that its limits are those of the library.

    Example: pantocheck verify report/certificate.pdf
    """
    verification = verify_certificate(certificate)
    size = f"{_count(verification.cases, 'case', 'cases')}, {verification.criteria} criteria"
    if verification.consistent:
        typer.echo(f"consistent: the verdict '{verification.verdict}' follows from the embedded numbers ({size}).")
        raise typer.Exit(EXIT_CODES[verification.verdict])
    count = _count(len(verification.discrepancies), "discrepancy", "discrepancies")
    typer.echo(f"not consistent: {count} ({size}; stated verdict '{verification.verdict}').")
    for text in verification.discrepancies:
        typer.echo(f"  {text}")
    raise typer.Exit(1)


def _count(number: int, singular: str, plural: str) -> str:
    return f"{number} {singular if number == 1 else plural}"
