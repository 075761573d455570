"""Formats of written mass-drop records, by the suffix of the file."""

from collections.abc import Callable
from pathlib import Path

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import CSV, HDF5, UFF, TableFormat
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_writing import check_drop_sidecar, write_drop_csv, write_drop_hdf5


def _write_universal_file(record: DropRecord, path: Path) -> None:
    from pantocheck.conformance.drops.uff_writing import write_drop_uff  # an optional package

    write_drop_uff(record, path)


DROP_WRITERS: dict[TableFormat, Callable[[DropRecord, Path], None]] = {
    UFF: _write_universal_file,
    CSV: write_drop_csv,
    HDF5: lambda record, path: write_drop_hdf5((record,), path),
}
"""Writer of a record by its format."""

FORMATS_WITH_SIDECAR = (UFF, CSV)
"""Formats whose writer puts a sidecar beside the record."""


def select_drop_writer(out: Path) -> Callable[[DropRecord, Path], None]:
    """Writer of the format of a file, by its suffix.

    Raises:
        InputError: Drop records are not written in this format, or its package is not installed.
    """
    suffixes = {table_format.suffixes[0]: table_format for table_format in DROP_WRITERS}
    if (table_format := suffixes.get(out.suffix.lower())) is None:
        raise InputError(str(out), f"format '{out.suffix}' cannot be written", f"Write one of {', '.join(suffixes)}.")
    table_format.require_library(out)
    return DROP_WRITERS[table_format]


def check_drop_target(out: Path) -> None:
    """Check before a simulation that its record replaces no other file, as in `check_drop_sidecar`."""
    if any(out.suffix.lower() in table_format.suffixes for table_format in FORMATS_WITH_SIDECAR):
        check_drop_sidecar(out)
