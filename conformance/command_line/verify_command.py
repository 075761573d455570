"""`pantocheck verify`: grade the results embedded in a certificate once more."""

from pathlib import Path
from typing import Annotated

import typer


def verify_command(
    certificate: Annotated[Path, typer.Argument(metavar="CERTIFICATE.pdf", help="The certificate to verify.")],
) -> None:
    """Take the results out of a certificate, grade them once more, and compare.

    Says `consistent` and exits with 0 if every verdict and margin follows from the numbers; lists the discrepancies and
    exits with 1 if not; exits with 2 if the file is no certificate.

    This shows that a certificate agrees with itself, not who made it, nor that its limits are those of the library.

    Example: pantocheck verify report/certificate.pdf
    """
    # The PDF parser is loaded only when it is needed, so that other commands start fast.
    from pantocheck.conformance.authenticity.verification import verify_certificate as verified

    found = verified(certificate)
    size = f"{found.cases} case{'' if found.cases == 1 else 's'}, {found.criteria} criteria"
    if found.consistent:
        typer.echo(f"consistent: the verdict '{found.verdict}' follows from the embedded numbers ({size}).")
        return
    count = len(found.discrepancies)
    typer.echo(
        f"not consistent: {count} discrepanc{'y' if count == 1 else 'ies'} ({size}; stated verdict '{found.verdict}')."
    )
    for text in found.discrepancies:
        typer.echo(f"  {text}")
    raise typer.Exit(1)
