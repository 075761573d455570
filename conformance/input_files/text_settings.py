"""Layout of a text table as a sidecar states it; keys that are not stated are found from the file."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.input_files.sourced_table import InputTable

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
