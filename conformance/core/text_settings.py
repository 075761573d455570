"""Layout of a text table as a sidecar states it; keys that are not stated are found from the file."""

import codecs
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, BinaryIO, Literal

from pydantic import Field

from pantocheck.conformance.core.files import MAX_FILE_BYTES, open_file
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import InputTable

Separator = Literal[",", ";", "\t", "|", " "]
"""Separator of columns; a blank stands for any number of blanks."""

DecimalSign = Literal[".", ","]

EncodingName = Literal["utf-8", "utf-16", "utf-16-le", "utf-16-be", "cp1252", "latin-1", "cp850", "mac-roman"]


class TextSettings(InputTable):
    """Layout of a text table (CSV, TXT)."""

    separator: Separator | None = None
    r"""Separator of the columns: ",", ";", "\t", "|", or " " for any number of blanks."""
    decimal: DecimalSign | None = None
    """Decimal mark: "." or ","."""
    header_lines: Annotated[int | None, Field(ge=0, le=900)] = None
    """Number of lines above the line of the column names, or above the numbers."""
    encoding: EncodingName | None = None
    """Encoding of the text."""

    @property
    def is_stated(self) -> bool:
        """Whether any key is stated."""
        return any(value is not None for value in (self.separator, self.decimal, self.header_lines, self.encoding))


# Encoding of text files from spreadsheets and data loggers.
_CHUNK = 2**20  # [bytes]


def find_encoding(file: BinaryIO, where: str) -> str:
    """Find the encoding of a text file: UTF-16 with a byte order mark, UTF-8, or else Windows-1252.

    Western single-byte encodings differ in letters with accents only, never in digits. A wrong one makes the name of a
    column unknown, but changes no number.

    Args:
        file: Open file; it is at its start afterwards.
        where: Name of the file in messages.

    Returns:
        Name of the encoding for Python; a byte order mark is left out of the text.

    Raises:
        InputError: The file is not text in one of these encodings.
    """
    start = file.read(2)
    file.seek(0)
    marked = start in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
    candidates = ["utf-16"] if marked else ["utf-8-sig", "cp1252"]
    found = next((name for name in candidates if _decodes(file, name)), None)
    if found is None:
        raise InputError(
            where, "is not text", "Export a text file (UTF-8), or state the encoding in the sidecar: [table] encoding."
        )
    return found


def name_encoding(path: Path, where: str) -> str:
    """Name of the encoding of a text file for messages; errors as in `find_encoding`."""
    with open_file(path, where, MAX_FILE_BYTES) as file:
        return {"utf-8-sig": "UTF-8", "utf-16": "UTF-16", "cp1252": "Windows-1252"}[find_encoding(file, where)]


def _decodes(file: BinaryIO, encoding: str) -> bool:
    """Whether the whole file is text in an encoding; characters of code 0 belong to binary files."""
    decoder = codecs.getincrementaldecoder(encoding)()
    try:
        return not any("\0" in decoder.decode(chunk) for chunk in _read_chunks(file)) and not decoder.decode(b"", True)
    except UnicodeError:
        return False
    finally:
        file.seek(0)


def _read_chunks(file: BinaryIO) -> Iterator[bytes]:
    return iter(lambda: file.read(_CHUNK), b"")
