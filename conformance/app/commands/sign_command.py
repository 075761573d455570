"""`pantocheck sign`: a signature for a certificate or for results."""

import getpass
import os
import sys
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.core.files import read_bytes
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.key_files import Encoding
from pantocheck.conformance.documents.signing import SigningOptions, sign_document

PASSPHRASE_VARIABLE = "PANTOCHECK_PASSPHRASE"

MAX_PASSPHRASE_BYTES = 4096
"""Largest file of a passphrase [bytes]."""


def read_passphrase(file: Path | None) -> bytes:
    """Passphrase from the first line of a file, else from the variable `PANTOCHECK_PASSPHRASE`, else typed by the user.

    It is never an argument, which other users see.

    Raises:
        InputError: The file cannot be read, or there is neither a file, nor the variable, nor a terminal.
    """
    if file is not None:
        lines = read_bytes(file, f"passphrase file '{file.name}'", MAX_PASSPHRASE_BYTES).splitlines()
        return lines[0] if lines else b""
    stated = os.environ.get(PASSPHRASE_VARIABLE)
    if stated is not None:
        return stated.encode("utf-8")
    if not sys.stdin.isatty():
        hint = (
            f"Give --passphrase-file FILE, set the variable {PASSPHRASE_VARIABLE}, or start the command in a terminal."
        )
        raise InputError("key", "needs a passphrase, and none is given", hint)
    return getpass.getpass("Passphrase of the key: ").encode("utf-8")


def sign_command(
    document: Annotated[Path, typer.Argument(metavar="FILE", help="Document to sign: PDF, HTML or JSON.")],
    key: Annotated[Path, typer.Option(help="Private key: PKCS#12 (.p12, .pfx) or PEM.")],
    certificate: Annotated[
        Path | None, typer.Option(help="Certificate of a PEM key and its authorities, if the key file lacks them.")
    ] = None,
    role: Annotated[str, typer.Option(help="Role of the signer, such as author or assessor.")] = "author",
    passphrase_file: Annotated[
        Path | None, typer.Option(help="File of the passphrase; else PANTOCHECK_PASSPHRASE, else typed.")
    ] = None,
    timestamp_url: Annotated[str | None, typer.Option(help="Address of a time-stamp server (RFC 3161).")] = None,
    visible: Annotated[
        str | None,
        typer.Option(
            metavar="PLACE", help="Box on page 1 of a PDF: top-left, top-centre or top-right.", show_default="invisible"
        ),
    ] = None,
    encoding: Annotated[Encoding, typer.Option(help="Form of a signature file.")] = "der",
    out: Annotated[
        Path | None, typer.Option(help="File to write.", show_default="FILE-signed.pdf, or FILE.p7s for HTML and JSON")
    ] = None,
) -> CommandOutput:
    """Sign a certificate or results.

    A PDF gets a PAdES signature as an incremental update: the unsigned document is kept, and the signed copy begins
    with its bytes. HTML and JSON get a signature file beside them. A signed document gets one more signature.

    The passphrase of the key is read from a file, from the environment or from the terminal, never from an argument.

    Example: pantocheck sign report/certificate.pdf --key author.p12 --visible top-left
    """
    options = SigningOptions(role, timestamp_url, visible, encoding, out)
    signed = sign_document(document, key, certificate, partial(read_passphrase, passphrase_file), options)
    data = {"holder": signed.holder, "role": signed.role}
    return CommandOutput(escape_text(f"Signed by {signed.holder} as {signed.role}"), data, files=(signed.path,))
