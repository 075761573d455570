"""Atomic writing: a file is complete or absent."""

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file under a temporary name and move it into place.

    Args:
        path: File to write; a missing folder is created.
        content: Complete content.

    Raises:
        InputError: The folder cannot be created or written.
    """
    produce_atomically(path, lambda temporary: temporary.write_bytes(content))


def produce_atomically(path: Path, produce: Callable[[Path], object]) -> None:
    """Write a temporary file beside `path`, then move it into place; a failure leaves no file.

    Args:
        path: File to write; a missing folder is created.
        produce: Function that writes the content to the path of the temporary file.

    Raises:
        InputError: The folder cannot be created or written.
    """
    with _convert_write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=".", suffix=path.suffix, dir=path.parent)
        os.close(handle)
        temporary = Path(name)
        try:
            produce(temporary)
            temporary.chmod(0o644)
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)


def check_writable(folder: Path) -> None:
    """Create a folder and a test file in it, so that a long computation does not end without a place for its results.

    Raises:
        InputError: The folder cannot be created or written.
    """
    with _convert_write_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass


@contextmanager
def _convert_write_errors(path: Path) -> Iterator[None]:
    """Convert errors of the file system into `InputError`."""
    try:
        yield
    except OSError as error:
        raise InputError(
            str(path), f"cannot be written ({error.strerror})", "Name a folder that you may write to, with --out."
        ) from None
