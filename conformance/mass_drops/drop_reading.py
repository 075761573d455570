"""One door for all formats of mass-drop records."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_assembly import Table, assemble
from pantocheck.conformance.mass_drops.drop_record import DropRecord
from pantocheck.conformance.mass_drops.drop_sidecar import Sidecar, read_sidecar

LARGEST_FILE = 2_000_000_000  # bytes


def read_records(path: Path) -> tuple[DropRecord, ...]:
    """All runs in a file of records.

    Parameters
    ----------
    path : .csv, .txt, .uff, .unv, .mat, .h5, .hdf5, .tdms or .mf4; its sidecar has the same stem and .toml

    Raises
    ------
    InputError : the file cannot be read, is damaged, or does not say what it holds
    """
    source = path.name
    reader = _reader(path.suffix.lower(), source)
    try:
        size = path.stat().st_size
    except OSError as error:
        raise InputError(source, f"cannot be read ({error.strerror})", "Check the path.") from None
    if not path.is_file():
        raise InputError(source, "is not a file", "Name a record file.")
    if size == 0:
        raise InputError(source, "is empty", "Export the record again.")
    if size > LARGEST_FILE:
        raise InputError(source, f"has {size} bytes", f"A record has at most {LARGEST_FILE} bytes.")
    sidecar = read_sidecar(path)
    file = str(path.resolve())
    return tuple(replace(assemble(table, sidecar, source), file=file) for table in reader(path, sidecar))


Reader = Callable[[Path, Sidecar | None], list[Table]]


def _reader(suffix: str, source: str) -> Reader:
    # Each format's library is loaded only when a file of that format comes.
    match suffix:
        case ".csv" | ".txt":
            from pantocheck.conformance.mass_drops.formats.csv_drops import read
        case ".uff" | ".unv" | ".uf" | ".uff58" | ".58":
            from pantocheck.conformance.mass_drops.formats.uff_drops import read
        case ".mat":
            from pantocheck.conformance.mass_drops.formats.matlab_drops import read
        case ".h5" | ".hdf5":
            from pantocheck.conformance.mass_drops.formats.hdf5_drops import read
        case ".tdms":
            from pantocheck.conformance.mass_drops.formats.tdms_drops import read
        case ".mf4" | ".mdf":
            from pantocheck.conformance.mass_drops.formats.mdf_drops import read
        case ".toml":
            raise InputError(source, "is a sidecar", "Name the record beside it: .csv, .uff, .mat, .h5, .tdms or .mf4.")
        case _:
            raise InputError(
                source, f"format '{suffix}' is not known", "Known are .csv, .uff, .mat, .h5, .tdms and .mf4."
            )
    return read
