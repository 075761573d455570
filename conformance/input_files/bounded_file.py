"""Bounded reading: a file is regular, its size is known before its content enters the memory, and no more is read."""

import hashlib
import io
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pantocheck.conformance.input_files.input_error import InputError

MAX_FILE_BYTES = 2_000_000_000
"""Largest file that is read [bytes]: a table of samples."""

NO_LINK = getattr(os, "O_NOFOLLOW", 0)
"""Flag of `open_file` that refuses a symbolic link."""

_CHUNK = 2**20  # [bytes]

# A pipe without a writer must not block; Windows needs O_BINARY and has no pipes in its folders.
_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)


class _RawFile(io.FileIO):
    """Regular file whose size was checked: a read behind this size is refused, because the file grows."""

    def __init__(self, descriptor: int, where: str, size: int) -> None:
        super().__init__(descriptor)
        self._where, self._size = where, size

    def readinto(self, buffer: Any) -> int:
        count = super().readinto(buffer) or 0
        if count and self.tell() > self._size:
            raise InputError(self._where, "grows while it is read", "Read it after the writing program has ended.")
        return count

    # The methods of FileIO bypass `readinto`.
    def read(self, size: int | None = -1) -> bytes:
        return io.RawIOBase.read(self, -1 if size is None else size) or b""

    def readall(self) -> bytes:
        return io.RawIOBase.readall(self)


class BoundedFile(io.BufferedReader):
    """Buffered regular file; a library that asks for more bytes than the file has takes no memory for them."""

    def __init__(self, descriptor: int, where: str, size: int) -> None:
        super().__init__(_RawFile(descriptor, where, size), _CHUNK)
        self._size = size

    def read(self, size: int | None = -1, /) -> bytes:
        return super().read(-1 if size is None or size < 0 else min(size, self._size + 1))


@contextmanager
def open_file(path: Path, where: str, largest: int, flags: int = 0) -> Iterator[BoundedFile]:
    """Open a regular file for reading; kind and size are those of the open file, not of its name.

    Parameters
    ----------
    path : Path
        The file.
    where : str
        Name of the file in messages, e.g. `results 'results.json'`.
    largest : int
        Limit of its size [bytes].
    flags : int
        Further flags of `os.open`, such as `NO_LINK`.

    Raises
    ------
    InputError
        The file is missing, is not a regular file, is too large, or grows while it is read. A pipe or device is
        refused because it may never end.
    """
    with convert_read_errors(path, where):
        descriptor = os.open(path, _FLAGS | flags)
        try:
            status = os.fstat(descriptor)
            if not stat.S_ISREG(status.st_mode):
                raise InputError(where, f"cannot be read from {path} (not a regular file)", "Name a file.")
            if status.st_size > largest:
                raise InputError(where, f"has {status.st_size} bytes", f"The largest accepted size is {largest} bytes.")
            file = BoundedFile(descriptor, where, status.st_size)
        except BaseException:
            os.close(descriptor)
            raise
    with file:
        yield file


def check_file(path: Path, where: str, largest: int) -> None:
    """Refuse a file that a library opens by its path; parameters and errors as in `open_file`."""
    with open_file(path, where, largest):
        pass


def read_bytes(path: Path, where: str, largest: int) -> bytes:
    """Read a file as bytes; parameters and errors as in `open_file`."""
    with open_file(path, where, largest) as file, convert_read_errors(path, where):
        return b"".join(iter(lambda: file.read(_CHUNK), b""))


def read_text(path: Path, where: str, largest: int) -> str:
    """Read a file of UTF-8 text, with or without byte order mark; parameters and errors as in `open_file`."""
    with convert_read_errors(path, where):
        return read_bytes(path, where, largest).decode("utf-8-sig")


def file_digest(path: Path, flags: int = 0) -> str:
    """SHA-256 of a file, in hexadecimal; parameters and errors as in `open_file`."""
    with open_file(path, f"file '{path.name}'", MAX_FILE_BYTES, flags) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@contextmanager
def convert_read_errors(path: Path, where: str) -> Iterator[None]:
    """Convert errors of the file system, and bytes that are not UTF-8 text, into `InputError`."""
    try:
        yield
    except OSError as error:
        raise InputError(where, f"cannot be read from {path} ({error.strerror or error})", "Check the path.") from None
    except UnicodeDecodeError as error:
        raise InputError(where, f"byte {error.start + 1} is not UTF-8 text", "Save the file as UTF-8.") from None
