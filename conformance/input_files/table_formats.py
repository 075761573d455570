"""File formats of measured tables. A new format is a module in `formats/` and a row in `TABLE_FORMATS`."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from pantocheck.conformance.input_files.bounded_file import MAX_FILE_BYTES, open_file
from pantocheck.conformance.input_files.extras import refuse_missing_package, require_package
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import ChannelNames, MeasuredTable
from pantocheck.conformance.input_files.text_settings import TextSettings

Reader = Callable[[Path, ChannelNames, int], list[MeasuredTable]]
"""Reader of a format. Its arguments are the path, the names of the channels in the sidecar (empty for a file that
describes itself, `EVERY_CHANNEL` for all channels by their names in the file) and the largest accepted number of
values. The reader of text tables has the stated layout as fourth argument. It raises `InputError` for a file that
cannot be used."""


@dataclass(frozen=True)
class TableFormat:
    """File format of measured tables."""

    module: str
    """Module of its reader in `formats/`; the reader is called `read_` and the name of the module."""
    suffixes: tuple[str, ...]
    """Suffixes of its files in lower case, the usual one first."""
    library: str = ""
    """Package of an extra that reads and writes it; empty if none is needed."""

    def read(self, path: Path, names: ChannelNames, largest: int, *layout: TextSettings) -> list[MeasuredTable]:
        """Read a file of this format; arguments and errors as in `Reader`.

        The library of the format is imported only here, because imports take time.
        """
        with refuse_missing_package(f"record '{path.name}'"):
            module = import_module(f"pantocheck.conformance.input_files.formats.{self.module}")
            reader: Callable[..., list[MeasuredTable]] = getattr(module, f"read_{self.module}")
            return reader(path, names, largest, *layout)

    def require_library(self, path: Path) -> None:
        """Require the package of this format before a file of it is computed.

        Raises:
            InputError: The package is not installed.
        """
        if self.library:
            require_package(self.library, f"record '{path.name}'")


CSV = TableFormat("csv_table", (".csv", ".txt", ".asc", ".dat"))
MDF = TableFormat("mdf_table", (".mf4", ".mdf"), library="asammdf")
UFF = TableFormat("uff_table", (".uff", ".unv", ".uf", ".uff58", ".58"), library="pyuff")
HDF5 = TableFormat("hdf5_table", (".h5", ".hdf5"), library="h5py")

TABLE_FORMATS = (
    CSV,
    UFF,
    TableFormat("matlab_table", (".mat",), library="h5py"),
    HDF5,
    TableFormat("tdms_table", (".tdms",), library="nptdms"),
    MDF,
)


def list_suffixes(formats: tuple[TableFormat, ...]) -> str:
    """Usual suffixes of formats as text for a message: `.csv, .uff or .h5`."""
    first = [table_format.suffixes[0] for table_format in formats]
    return " or ".join(part for part in (", ".join(first[:-1]), first[-1]) if part)


def find_table_format(path: Path, formats: tuple[TableFormat, ...]) -> TableFormat:
    """Find the format of a file by its suffix, among the accepted formats of the suite.

    Raises:
        InputError: The suffix belongs to none of the formats.
    """
    where, suffix = f"record '{path.name}'", path.suffix.lower()
    if suffix == ".toml":
        raise InputError(
            where, "is a sidecar, not a table", f"Give the table in the same folder ({list_suffixes(formats)})."
        )
    for table_format in formats:
        if suffix in table_format.suffixes:
            return table_format
    known = f"Known formats are {list_suffixes(formats)}."
    if suffix == "":
        raise InputError(where, "has no suffix", f"Did you mean {path.name}{formats[0].suffixes[0]} ? {known}")
    raise InputError(where, f"has the unknown suffix '{suffix}'", known)


def read_tables(
    path: Path,
    names: ChannelNames,
    largest: int,
    formats: tuple[TableFormat, ...] = TABLE_FORMATS,
    layout: TextSettings | None = None,
) -> list[MeasuredTable]:
    """Read all runs in a file.

    Args:
        path: The file.
        names: Names of the channels in its sidecar, in the order of the columns; empty for a file that describes
            itself.
        largest: Largest accepted number of values.
        formats: Accepted formats.
        layout: Layout of a text table, as far as it is stated.

    Returns:
        One table per run.

    Raises:
        InputError: The file cannot be read, is damaged, too large or of another format.
    """
    table_format = find_table_format(path, formats)
    where = f"record '{path.name}'"
    with open_file(path, where, MAX_FILE_BYTES) as file:
        if not file.read(1):
            raise InputError(where, "is empty", "Export the record again.")
    if layout is None or not layout.is_stated:
        return table_format.read(path, names, largest)
    if table_format is not CSV:
        raise InputError(
            f"sidecar of {where}, key table",
            f"states the layout of a text table, but {path.suffix} is no text table",
            "Remove separator, decimal, header_lines and encoding.",
        )
    return table_format.read(path, names, largest, layout)
