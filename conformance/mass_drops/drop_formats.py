"""Formats of written mass-drop records, by the suffix of the file."""

from collections.abc import Callable
from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_record import DropRecord
from pantocheck.conformance.mass_drops.drop_writing import write_drop_csv, write_drop_hdf5


def _write_universal_file(record: DropRecord, path: Path) -> None:
    from pantocheck.conformance.mass_drops.uff_writing import write_drop_uff  # an optional package

    write_drop_uff(record, path)


DROP_WRITERS: dict[str, Callable[[DropRecord, Path], None]] = {
    ".uff": _write_universal_file,
    ".csv": write_drop_csv,
    ".h5": lambda record, path: write_drop_hdf5((record,), path),
}
"""Writer of a record by the suffix of its file."""


def select_drop_writer(out: Path) -> Callable[[DropRecord, Path], None]:
    """Writer of the format of a file, by its suffix.

    Raises
    ------
    InputError
        Drop records are not written in this format.
    """
    if (write := DROP_WRITERS.get(out.suffix.lower())) is None:
        raise InputError(
            str(out), f"format '{out.suffix}' cannot be written", f"Write one of {', '.join(DROP_WRITERS)}."
        )
    return write
