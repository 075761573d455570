"""One door for all formats of mass-drop records."""

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_assembly import DropColumns, assemble_drop_records
from pantocheck.conformance.mass_drops.drop_record import DropRecord
from pantocheck.conformance.mass_drops.drop_sidecar import DropSidecar, read_drop_sidecar

MAX_DROP_BYTES = 2_000_000_000  # bytes


def read_drop_records(path: Path) -> tuple[DropRecord, ...]:
    """All runs in a file of records.

    Parameters
    ----------
    path : Path
        .csv, .txt, .uff, .unv, .mat, .h5, .hdf5, .tdms or .mf4; its sidecar has the same stem and .toml.

    Raises
    ------
    InputError
        The file cannot be read, is damaged, or does not say what it holds.
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
    if size > MAX_DROP_BYTES:
        raise InputError(source, f"has {size} bytes", f"A record has at most {MAX_DROP_BYTES} bytes.")
    sidecar = read_drop_sidecar(path)
    file = str(path.resolve())
    return tuple(replace(assemble_drop_records(table, sidecar, source), file=file) for table in reader(path, sidecar))


Reader = Callable[[Path, DropSidecar | None], list[DropColumns]]

# Module of each format and the suffixes of its files; its library is loaded only when a file of that format comes.
_READERS = {
    "csv_drops": (".csv", ".txt"),
    "uff_drops": (".uff", ".unv", ".uf", ".uff58", ".58"),
    "matlab_drops": (".mat",),
    "hdf5_drops": (".h5", ".hdf5"),
    "tdms_drops": (".tdms",),
    "mdf_drops": (".mf4", ".mdf"),
}


def _reader(suffix: str, source: str) -> Reader:
    if suffix == ".toml":
        raise InputError(source, "is a sidecar", "Name the record beside it: .csv, .uff, .mat, .h5, .tdms or .mf4.")
    for name, suffixes in _READERS.items():
        if suffix in suffixes:
            module = import_module(f"pantocheck.conformance.mass_drops.formats.{name}")
            reader: Reader = getattr(module, f"read_{name}")
            return reader
    raise InputError(source, f"format '{suffix}' is not known", "Known are .csv, .uff, .mat, .h5, .tdms and .mf4.")
