"""Passphrase of a key: from a file, from the environment, or typed. It is never an argument, which other users see."""

import getpass
import os
import sys
from pathlib import Path

from pantocheck.conformance.input_files.bounded_file import read_bytes
from pantocheck.conformance.input_files.input_error import InputError

PASSPHRASE_VARIABLE = "PANTOCHECK_PASSPHRASE"

MAX_PASSPHRASE_BYTES = 4096
"""Largest file of a passphrase [bytes]."""


def read_passphrase(file: Path | None) -> bytes:
    """Passphrase from a file without the end of its first line, else from the environment, else typed by the user.

    Args:
        file: File of the passphrase; None to read the variable `PANTOCHECK_PASSPHRASE` or to ask.

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
