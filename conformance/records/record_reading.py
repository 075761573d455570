"""Reading a record from a stranger: everything is checked before it becomes samples or a `Record`."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.atomic_writing import file_digest
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.toml_file import read_model
from pantocheck.conformance.records.record import LARGEST_NUMBER, Record, RecordInvalid
from pantocheck.conformance.records.record_channels import CHANNELS, column_name
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.record_tables import FORMAT, Rows, check_complete, read_csv, read_hdf5
from pantocheck.conformance.records.record_writing import HDF5_SUFFIXES
from pantocheck.conformance.records.samples import RecordSamples, build_record

MAX_RECORD_BYTES = 2_000_000_000


def read_record(path: Path, evaluated: tuple[float, float] | None = None) -> tuple[Record, RecordSidecar]:
    """Read a record by its sidecar, or by its table with the sidecar beside it.

    Parameters
    ----------
    path : Path
        Of either.
    evaluated : tuple[float, float] or None
        Stretch of the case it is read for, which holds where the sidecar names none [m].

    Raises
    ------
    InputError
        a file is missing, damaged or contradicts the other, values are missing, or time is not uniform.
    """
    samples, sidecar, table = read_samples(path)
    try:
        record = build_record(samples, sidecar)
    except RecordInvalid as error:
        raise build_record_error(table, error) from None
    if sidecar.evaluated_m is None and evaluated is not None:
        record = replace(record, evaluated=evaluated)
    return record, sidecar


def read_samples(path: Path) -> tuple[RecordSamples, RecordSidecar, Path]:
    """Read the samples of a record as they are, missing values and uneven times included, and the path of the table.

    Raises
    ------
    InputError
        a file is missing, damaged or contradicts the other.
    """
    sidecar_path = path if path.suffix == ".toml" else path.with_suffix(".toml")
    sidecar = read_model(sidecar_path, RecordSidecar, "sidecar")
    table = sidecar_path.parent / sidecar.file
    where = f"record '{table.name}'"
    try:
        if table.stat().st_size > MAX_RECORD_BYTES:
            raise InputError(where, f"{table.stat().st_size} bytes", f"A record has at most {MAX_RECORD_BYTES} bytes.")
        if sidecar.sha256 is not None and file_digest(table) != sidecar.sha256:
            raise InputError(
                where, "its content is not what the sidecar's sha256 says", "Copy or write the record again."
            )
        if table.suffix.lower() == ".csv":
            rows = read_csv(table, sidecar, where)
        elif table.suffix.lower() in HDF5_SUFFIXES:
            rows = read_hdf5(table, sidecar, where)
        else:
            raise InputError(where, f"the suffix {table.suffix!r} is no format of a record", "Use .csv or .h5 .")
    except OSError as error:
        raise InputError(where, f"cannot be read ({error.strerror})", "The table lies beside its sidecar.") from None
    check_complete(rows, where)
    return _samples(rows, sidecar, where), sidecar, table


def build_record_error(table: Path, error: RecordInvalid) -> InputError:
    """What is impossible in a record, as an error of its file."""
    return InputError(f"record '{table.name}', channel {error.channel}", error.found, FORMAT)


def _samples(rows: Rows, sidecar: RecordSidecar, where: str) -> RecordSamples:
    for name, of in rows.items():
        expected = sidecar.rows(CHANNELS[name].per)
        first_alone = name == "position" and list(of) == [1] and sidecar.spacing_m is not None
        # Uplift is measured at some supports: each column says at which one.
        if name != "uplift" and len(of) != expected and not first_alone:
            raise InputError(
                where,
                f"{len(of)} rows of {CHANNELS[name].key}, expected {expected}",
                "Give one per pantograph, or position_1_m and spacing_m in the sidecar.",
            )
    lengths = {name: next(iter(of.values())).size for name, of in rows.items()}
    for name, length in lengths.items():
        if length != lengths["force"]:
            raise InputError(
                f"{where}, channel {CHANNELS[name].key}",
                f"{length} samples, the force has {lengths['force']}",
                "All channels have the same samples.",
            )
        for number, values in rows[name].items():
            impossible = np.abs(values) > LARGEST_NUMBER  # infinity too; a missing value is not
            if impossible.any():
                at = int(np.argmax(impossible))
                raise InputError(
                    f"{where}, {column_name(CHANNELS[name].key, number)}",
                    f"{values[at]:.3g} at sample {at + 1} is impossible",
                    "Write nan where a value is missing.",
                )
    supports = sorted(rows.get("uplift", {}))
    stacked: dict[str, RealArray] = {
        name: np.ascontiguousarray(np.vstack([of[i] for i in sorted(of)])) for name, of in rows.items()
    }
    return RecordSamples(
        force=stacked["force"],
        time=stacked["time"][0] if "time" in stacked else None,
        speed=stacked["speed"][0] if "speed" in stacked else None,
        position=stacked.get("position"),
        contact_height=stacked.get("contact_height"),
        uplift=stacked.get("uplift"),
        support_position=np.array([(sidecar.support_position_m or ())[i - 1] for i in supports]) if supports else None,
    )
