"""Reading a record from a stranger: everything is checked before it becomes a `Record`."""

import hashlib
import re
import warnings
from pathlib import Path

import numpy as np
from pantocheck.conformance.cases.toml_file import read_model
from pantocheck.conformance.cases.units import converted
from pantocheck.conformance.errors import InputError
from pantocheck.conformance.record import MAX_SAMPLES, Array, Record, RecordInvalid
from pantocheck.conformance.record_files.sidecar import REQUIRED, Sidecar, column_name
from pantocheck.conformance.record_files.writing import HDF5_SUFFIXES
from pantocheck.conformance.suggestions import nearest

LARGEST_FILE = 2_000_000_000


def read_record(path: Path) -> tuple[Record, Sidecar]:
    """Read a record by its sidecar, or by its table with the sidecar beside it.

    Raises
    ------
    InputError : a file is missing, damaged or contradicts the other
    """
    sidecar_path = path if path.suffix == ".toml" else path.with_suffix(".toml")
    sidecar = read_model(sidecar_path, Sidecar, "sidecar")
    table = sidecar_path.parent / sidecar.file
    where = f"record '{table.name}'"
    try:
        if table.stat().st_size > LARGEST_FILE:
            raise InputError(where, f"{table.stat().st_size} bytes", f"A record has at most {LARGEST_FILE} bytes.")
        if sidecar.sha256 is not None and hashlib.sha256(table.read_bytes()).hexdigest() != sidecar.sha256:
            raise InputError(
                where, "its content is not what the sidecar's sha256 says", "Copy or write the record again."
            )
    except OSError as error:
        raise InputError(where, f"cannot be read ({error.strerror})", "The table lies beside its sidecar.") from None
    if table.suffix.lower() == ".csv":
        channels = _read_csv(table, sidecar, where)
    elif table.suffix.lower() in HDF5_SUFFIXES:
        channels = _read_hdf5(table, sidecar, where)
    else:
        raise InputError(where, f"the suffix {table.suffix!r} is no format of a record", "Use .csv or .h5 .")
    try:
        record = Record(
            time=channels["time_s"][0],
            speed=sidecar.speed_km_h / 3.6,
            position=channels["position_m"],
            force=channels["force_N"],
            evaluated=(sidecar.evaluated_m[0], sidecar.evaluated_m[1]),
            filter_applied_Hz=None if isinstance(sidecar.filter_applied_Hz, str) else sidecar.filter_applied_Hz,
            contact_height=channels.get("contact_height_m"),
            support_position=np.array(sidecar.support_position_m) if "uplift_m" in channels else None,
            support_uplift=channels.get("uplift_m"),
        )
    except RecordInvalid as error:
        raise InputError(f"{where}, channel {error.channel}", error.found, "See the format of records.") from None
    return record, sidecar


def _read_csv(path: Path, sidecar: Sidecar, where: str) -> dict[str, Array]:
    known = {column_name(key, i): (key, i) for key, rows in sidecar.columns().items() for i in range(1, rows + 1)}
    try:
        with path.open(encoding="utf-8-sig") as file:
            names = [name.strip() for name in file.readline(100_000).split(",")]
            for name in names:
                if name not in known:
                    raise InputError(
                        f"{where}, column {name[:80]!r}",
                        "unknown column",
                        converted(name, None, list(known)) or nearest(name, list(known)),
                    )
            if len(set(names)) != len(names):
                raise InputError(where, "two columns have the same name", "Each channel stands in one column.")
            with warnings.catch_warnings():
                warnings.filterwarnings("ignore", "loadtxt: input contained no data")  # said below, as an error
                samples = np.loadtxt(file, delimiter=",", ndmin=2, max_rows=MAX_SAMPLES // len(names) + 1)
    except UnicodeDecodeError as error:
        raise InputError(where, f"byte {error.start + 1} is not text", "A CSV record is UTF-8 text.") from None
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(where, _telling(str(error)), "Separate columns by commas and decimals by points.") from None
    if samples.size == 0 or samples.shape[1] != len(names):
        raise InputError(
            where,
            f"{samples.shape[1] if samples.size else 'no'} columns of numbers under {len(names)} names",
            "Give one number per column on every line.",
        )
    _check_complete({known[name][0] for name in names}, where)
    rows = sidecar.columns()
    channels = {}
    for key in rows:
        present = [name for name in known if known[name][0] == key and name in names]
        if present and len(present) != rows[key]:
            raise InputError(
                where, f"{len(present)} columns of {key}, expected {rows[key]}", "Give one per pantograph or support."
            )
        if present:
            channels[key] = np.ascontiguousarray(samples[:, [names.index(name) for name in present]].T)
    return channels


def _telling(message: str) -> str:
    """numpy's message with the line of the file in place of its row."""
    bad = re.search(r"could not convert string '(.{0,40}).*' to float64 at row (\d+), column (\d+)", message, re.DOTALL)
    if bad:
        return f"line {int(bad[2]) + 2}, column {bad[3]}: {bad[1]!r} is not a number"
    changed = re.search(r"columns changed from (\d+) to (\d+) at row (\d+)", message)
    if changed:
        return f"line {int(changed[3]) + 1}: {changed[2]} columns where there were {changed[1]}"
    return f"cannot be read as numbers ({message[:120]})"


def _read_hdf5(path: Path, sidecar: Sidecar, where: str) -> dict[str, Array]:
    import h5py

    channels = {}
    try:
        with h5py.File(path, "r") as file:
            _check_complete(set(file), where)
            for key, rows in sidecar.columns().items():
                if key not in file:
                    continue
                dataset = file[key]
                if not isinstance(dataset, h5py.Dataset) or dataset.dtype.kind not in "fiu":
                    raise InputError(f"{where}, dataset {key}", "not an array of numbers", "See the format of records.")
                shape = dataset.shape if key != "time_s" else (1, *dataset.shape)
                if len(shape) != 2 or shape[0] != rows or dataset.size > MAX_SAMPLES:
                    raise InputError(
                        f"{where}, dataset {key}", f"its shape is {dataset.shape}", f"Expected {rows} rows of samples."
                    )
                channels[key] = np.asarray(dataset[()], dtype=np.float64).reshape(shape)
    except InputError:
        raise
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:  # all that h5py says of damaged bytes
        raise InputError(
            where, f"is not a readable HDF5 file ({str(error)[:120]})", "Write the record again."
        ) from None
    return channels


def _check_complete(present: set[str], where: str) -> None:
    for key in REQUIRED:
        if key not in present:
            raise InputError(where, f"there is no channel {key}", f"A record needs {', '.join(REQUIRED)}.")
