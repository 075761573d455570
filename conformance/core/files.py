"""Bounded reading and atomic writing. Only regular files are read, up to the size checked on opening."""

import hashlib
import io
import os
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pantocheck.conformance.core.input_error import InputError

MAX_FILE_BYTES = 2_000_000_000
"""Largest file that is read [bytes]: a table of samples."""

NO_LINK = getattr(os, "O_NOFOLLOW", 0)
"""Flag for `open_file` that refuses a symbolic link."""

_CHUNK = 2**20  # [bytes]

# A pipe without a writer must not block; Windows needs O_BINARY and has no pipes in its folders.
_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)


class _RawFile(io.FileIO):
    """Regular file of known size; reading beyond this size is an error, because the file has grown."""

    def __init__(self, descriptor: int, where: str, size: int) -> None:
        super().__init__(descriptor)
        self._where, self._size = where, size

    def readinto(self, buffer: Any) -> int:
        count = super().readinto(buffer) or 0
        if count and self.tell() > self._size:
            raise InputError(self._where, "grew while it was read", "Wait until the program that writes it has ended.")
        return count

    # The methods of FileIO bypass `readinto`.
    def read(self, size: int | None = -1) -> bytes:
        return io.RawIOBase.read(self, -1 if size is None else size) or b""

    def readall(self) -> bytes:
        return io.RawIOBase.readall(self)


class BoundedFile(io.BufferedReader):
    """Buffered regular file; a request for more bytes than the file has takes no memory for them."""

    def __init__(self, descriptor: int, where: str, size: int) -> None:
        super().__init__(_RawFile(descriptor, where, size), _CHUNK)
        self._size = size

    def read(self, size: int | None = -1, /) -> bytes:
        """Read at most `size` bytes, and at most one byte more than the file had when it was opened."""
        return super().read(-1 if size is None or size < 0 else min(size, self._size + 1))


@contextmanager
def open_file(path: Path, where: str, largest: int, flags: int = 0) -> Iterator[BoundedFile]:
    """Open a regular file for reading; kind and size are checked on the open file, whose name may meanwhile change.

    Args:
        path: The file.
        where: Name of the file in messages, e.g. `results 'results.json'`.
        largest: Largest accepted size [bytes].
        flags: Further flags of `os.open`, such as `NO_LINK`.

    Yields:
        Open file; it is closed at the end of the block.

    Raises:
        InputError: The file is missing, is not a regular file, is too large, or grows while it is read. A pipe or
            device is refused because it may never end.
    """
    with convert_read_errors(path, where):
        descriptor = os.open(path, _FLAGS | flags)
        try:
            status = os.fstat(descriptor)
            if not stat.S_ISREG(status.st_mode):
                raise OSError(0, "not a regular file")
            if status.st_size > largest:
                raise InputError(where, f"has {status.st_size} bytes", f"At most {largest} bytes are accepted.")
            file = BoundedFile(descriptor, where, status.st_size)
        except BaseException:
            os.close(descriptor)
            raise
    with file:
        yield file


def check_file(path: Path, where: str, largest: int) -> None:
    """Check a file before a library opens it by its path; parameters and errors as in `open_file`."""
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
    """SHA-256 of a file in hexadecimal; parameters and errors as in `open_file`."""
    with open_file(path, f"file '{path.name}'", MAX_FILE_BYTES, flags) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@contextmanager
def convert_read_errors(path: Path, where: str) -> Iterator[None]:
    """Convert errors of the file system, and of text that is not UTF-8, into `InputError`; see `open_file`."""
    try:
        yield
    except OSError as error:
        place = "" if str(path) in where else f" from {path}"
        hint = "Check the path." if error.errno else "Give a regular file."
        raise InputError(where, f"cannot be read{place} ({error.strerror or error})", hint) from None
    except UnicodeDecodeError as error:
        raise InputError(where, f"byte {error.start + 1} is not UTF-8 text", "Save the file as UTF-8.") from None


# Atomic writing: a file is complete or absent.
def write_atomically(path: Path, content: bytes) -> None:
    """Write a file under a temporary name and move it into place.

    Args:
        path: File to write; a missing folder is created.
        content: Complete content.

    Raises:
        InputError: The folder cannot be created or written.
    """
    produce_atomically(path, lambda temporary: temporary.write_bytes(content))


@contextmanager
def stage_file(path: Path) -> Iterator[Path]:
    """Path of a temporary file beside `path`, which is moved into place; a failure leaves no file.

    Args:
        path: File to write; a missing folder is created.

    Raises:
        InputError: The folder cannot be created or written.
    """
    with _convert_write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=".", suffix=path.suffix, dir=path.parent)
        os.close(handle)
        temporary = Path(name)
        try:
            yield temporary
            temporary.chmod(0o644)
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)


def produce_atomically(path: Path, produce: Callable[[Path], object]) -> None:
    """Write a file by a function that takes the path of a temporary file, as in `stage_file`."""
    with stage_file(path) as temporary:
        produce(temporary)


def check_writable(folder: Path) -> None:
    """Write a test file into a folder, so that a long computation does not end without a place for its results.

    A missing folder is not created: a refused input leaves none. The test is made in the folder that would hold it.

    Raises:
        InputError: The folder cannot be created or written.
    """
    with _convert_write_errors(folder):
        existing = next(path for path in (folder, *folder.absolute().parents) if path.exists())
        with tempfile.TemporaryFile(dir=existing):
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
