"""Writing files so that nobody ever sees half of one."""

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file under a temporary name and move it into place.

    Parameters
    ----------
    path : Path
        The file to write; its folder is made if need be.
    content : bytes
        All of it.

    Raises
    ------
    InputError
        The folder cannot be made or written.
    """
    produce_atomically(path, lambda temporary: temporary.write_bytes(content))


def produce_atomically(path: Path, produce: Callable[[Path], object]) -> None:
    """Let `produce` write a temporary file beside `path`, then move it into place; nothing is left if it fails.

    Raises
    ------
    InputError
        The folder cannot be made or written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=".", suffix=path.suffix, dir=path.parent)
    except OSError as error:
        raise InputError(
            str(path), f"cannot be written ({error.strerror})", "Name a folder that you may write to, with --out."
        ) from None
    os.close(handle)
    temporary = Path(name)
    try:
        produce(temporary)
        temporary.chmod(0o644)
        temporary.replace(path)
    except OSError as error:
        raise InputError(
            str(path), f"cannot be written ({error.strerror})", "Name a folder that you may write to, with --out."
        ) from None
    finally:
        temporary.unlink(missing_ok=True)


def check_writable(folder: Path) -> None:
    """Make a folder and a file in it, before anything is computed that could not be kept.

    Raises
    ------
    InputError
        The folder cannot be made or written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(
            str(folder), f"cannot be written ({error.strerror})", "Name a folder that you may write to, with --out."
        ) from None


def file_digest(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
