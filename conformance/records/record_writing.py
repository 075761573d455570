"""Writing a record: the table first, the sidecar last, so that a sidecar never names a table that is not there."""

from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.atomic_writing import file_digest, produce_atomically, write_atomically
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.toml_file import read_toml
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_channels import column_name
from pantocheck.conformance.records.record_sidecar import RECORD_SCHEMA, RecordSidecar

HDF5_SUFFIXES = (".h5", ".hdf5")


def write_record(
    path: Path,
    record: Record,
    case: str | None = None,
    system: dict[str, str] | None = None,
    run: dict[str, float | None] | None = None,
) -> Path:
    """Write a record as CSV or HDF5, by the suffix of its name, and its sidecar.

    Parameters
    ----------
    path : Path
        Of the table, ending in .csv, .h5 or .hdf5.
    record : Record
        To be written.
    case : str or None
        Id of the case that was run.
    system : dict[str, str] or None
        `name` and `version` of what it comes from.
    run : dict[str, float or None] or None
        Keys of the sidecar's run table; None is left out.

    Returns
    -------
    Path
        Path of the sidecar.

    Raises
    ------
    InputError
        The suffix is another one, a file cannot be written, or the sidecar would overwrite another file.
    """
    check_record_path(path)
    channels = _channels(record)
    if path.suffix.lower() == ".csv":
        produce_atomically(path, lambda temporary: _write_csv(temporary, channels))
    else:
        produce_atomically(path, lambda temporary: _write_hdf5(temporary, channels))
    sidecar: dict[str, Any] = {
        "schema": RECORD_SCHEMA,
        "case": case,
        "file": path.name,
        "sha256": file_digest(path),
        "speed_km_h": float(f"{3.6 * record.speed:.12g}"),
        "pantographs": record.pantographs,
        "evaluated_m": [float(x) for x in record.evaluated],
        "filter_applied_Hz": "none" if record.filter_applied_Hz is None else record.filter_applied_Hz,
        "support_position_m": None if record.support_position is None else record.support_position.tolist(),
        "system": system,
        "run": {key: value for key, value in (run or {}).items() if value is not None},
    }
    said = {key: value for key, value in sidecar.items() if value is not None}
    RecordSidecar.model_validate(said)
    target = path.with_suffix(".toml")
    write_atomically(target, tomli_w.dumps(said).encode())
    return target


def check_record_path(path: Path) -> None:
    """Refuse a name that a record cannot have, before anything is computed; errors as in `write_record`."""
    if path.suffix.lower() not in (".csv", *HDF5_SUFFIXES):
        raise InputError(
            f"record '{path}'", f"the suffix {path.suffix!r} is no format of a record", "Use .csv or .h5 ."
        )
    target = path.with_suffix(".toml")
    if target.exists() and read_toml(target, "sidecar").get("schema") != RECORD_SCHEMA:
        raise InputError(
            f"record '{path}'",
            f"its sidecar {target.name} would overwrite a file that is none",
            "Give the record another name.",
        )


def _channels(record: Record) -> dict[str, RealArray]:
    channels = {
        "time_s": record.time[None],
        "position_m": record.position,
        "force_N": record.force,
        "contact_height_m": record.contact_height,
        "uplift_m": record.support_uplift,
    }
    return {key: values for key, values in channels.items() if values is not None}


def _write_csv(path: Path, channels: dict[str, RealArray]) -> None:
    names = [column_name(key, i) for key, values in channels.items() for i in range(1, len(values) + 1)]
    np.savetxt(path, np.vstack(list(channels.values())).T, "%.12g", ",", header=",".join(names), comments="")


def _write_hdf5(path: Path, channels: dict[str, RealArray]) -> None:
    import h5py

    # Without times in the file, the same record gives the same bytes.
    with h5py.File(path, "w", track_order=True) as file:
        for key, values in channels.items():
            file.create_dataset(key, data=values[0] if key == "time_s" else values, track_times=False)
