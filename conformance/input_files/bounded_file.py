"""Bounded reading: the size of a file is known before its content enters the memory."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError


def check_file(path: Path, where: str, largest: int) -> None:
    """Refuse a file that is missing, is not a regular file or is too large.

    Parameters
    ----------
    path : Path
        The file.
    where : str
        Name of the file in messages, e.g. `results 'results.json'`.
    largest : int
        Limit of its size [bytes].

    Raises
    ------
    InputError
        The file must not be read. A pipe or device is refused because it may never end.
    """
    with convert_read_errors(path, where):
        size = path.stat().st_size
    if not path.is_file():
        raise InputError(where, f"cannot be read from {path} (not a regular file)", "Name a file.")
    if size > largest:
        raise InputError(where, f"{size} bytes", f"At most {largest} bytes are read.")


def read_bytes(path: Path, where: str, largest: int) -> bytes:
    """Read a file as bytes; parameters and errors as in `check_file`."""
    check_file(path, where, largest)
    with convert_read_errors(path, where):
        return path.read_bytes()


def read_text(path: Path, where: str, largest: int) -> str:
    """Read a file of UTF-8 text, with or without byte order mark; parameters and errors as in `check_file`."""
    with convert_read_errors(path, where):
        return read_bytes(path, where, largest).decode("utf-8-sig")


@contextmanager
def convert_read_errors(path: Path, where: str) -> Iterator[None]:
    """Convert errors of the file system, and bytes that are not UTF-8 text, into `InputError`."""
    try:
        yield
    except OSError as error:
        raise InputError(where, f"cannot be read from {path} ({error.strerror or error})", "Check the path.") from None
    except UnicodeDecodeError as error:
        raise InputError(where, f"byte {error.start + 1} is not UTF-8 text", "Save the file as UTF-8.") from None
