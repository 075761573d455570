"""Writing records: UFF 58, CSV with a sidecar, HDF5. What is written here reads back the same."""

import warnings
from pathlib import Path
from typing import Any, Literal

import h5py
import numpy as np
import pyuff
import tomli_w

from pantocheck.conformance.input_files.atomic_writing import produce_atomically, write_atomically
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_record import DropRecord
from pantocheck.conformance.mass_drops.drop_sidecar import find_drop_sidecar

SI_UNIT = {"acceleration": "m/s2", "velocity": "m/s", "displacement": "m"}
DATA_TYPE = {"acceleration": 12, "velocity": 11, "displacement": 8}

UNWRITABLE = ",;\t\"'"  # in the head line of a CSV file, which is read without quoting


def write_drop_csv(record: DropRecord, path: Path) -> None:
    """Write a record as CSV (decimal point, commas) and its sidecar beside it.

    Parameters
    ----------
    record : DropRecord
        One run.
    path : Path
        The .csv file.

    Raises
    ------
    InputError
        It cannot be written, or a channel has a name that a head line cannot hold.
    """
    for channel in record.channels:
        if set(channel.name) & set(UNWRITABLE) or channel.name.strip().splitlines() != [channel.name]:
            raise InputError(
                f"{path.name}, channel {channel.name!r}",
                "has a name that a head line cannot hold",
                "Leave out commas, semicolons, tabs, quotes and line breaks, or write HDF5.",
            )
    head = ",".join(["time_s", *(channel.name for channel in record.channels)])
    table = np.column_stack([record.time, record.signals])
    body = "\n".join(",".join(f"{value:.9g}" for value in row) for row in table)
    write_atomically(find_drop_sidecar(path), tomli_w.dumps(_sidecar(record)).encode())
    write_atomically(path, f"{head}\n{body}\n".encode())


def write_drop_uff(record: DropRecord, path: Path, form: Literal["ascii", "binary"] = "binary") -> None:
    """Write a record as universal file, one data set 58 per channel; parameters and errors as in `write_csv`.

    What the format has no field for (wire, position, mass, trigger) stands in its id lines and in a sidecar.
    """
    sets = [_set_58(record, c, form) for c in range(len(record.channels))]

    def produce(temporary: Path) -> None:
        # pyuff's mode 'overwrite' destroys binary files; a new file filled by adding does not suffer from it.
        temporary.unlink()
        with warnings.catch_warnings():
            # pyuff drops open files instead of closing them; they are closed when it returns.
            warnings.simplefilter("ignore", ResourceWarning)
            pyuff.UFF(str(temporary)).write_sets(sets, mode="add")

    write_atomically(find_drop_sidecar(path), tomli_w.dumps(_sidecar(record)).encode())
    produce_atomically(path, produce)


def _set_58(record: DropRecord, c: int, form: Literal["ascii", "binary"]) -> dict[str, Any]:
    channel, drop = record.channels[c], record.drop
    told = "NONE"
    if drop.mass is not None and drop.position is not None and drop.wire:
        told = f"{drop.mass:g} kg on {drop.wire} at {drop.position:g} m"
        told += f", trigger at {drop.trigger_nominal:g} s" if drop.trigger_nominal is not None else ""
    named = "NONE"
    # A name that the line would change is left to the sidecar.
    if channel.position is not None and channel.wire and " " not in channel.name and channel.name.isascii():
        named = f"{channel.name} {channel.wire} at {channel.position:g} m dir +{channel.axis}"
    data = pyuff.prepare_58(
        binary=int(form == "binary"),
        func_type=1,
        rsp_node=channel.sensor,
        rsp_dir="xyz".index(channel.axis) + 1,
        ref_node=0,
        ref_dir=0,
        ord_data_type=4,
        num_pts=record.signals.shape[0],
        data=record.signals[:, c].copy(),
        x=record.time,
        abscissa_spacing=1,
        abscissa_min=0.0,
        abscissa_inc=1 / record.rate,
        abscissa_spec_data_type=17,
        abscissa_axis_units_lab="s",
        ordinate_spec_data_type=DATA_TYPE[record.quantity],
        ordinate_axis_units_lab=SI_UNIT[record.quantity],
        # The format's denominator and z axis, which a time history does not use.
        orddenom_spec_data_type=0,
        orddenom_axis_units_lab="NONE",
        z_axis_spec_data_type=0,
        z_axis_axis_units_lab="NONE",
        id1=_ascii(record.name),
        id2=_ascii(told),
        id3=_ascii(named),
        id4=record.quantity,
        id5="NONE",
    )
    return dict(data)


def _ascii(text: str) -> str:
    """An identification line: 80 ASCII characters, never empty."""
    return text.encode("ascii", "replace").decode("ascii")[:80].strip() or "NONE"


def write_drop_hdf5(records: tuple[DropRecord, ...], path: Path) -> None:
    """Write the runs of one test as HDF5; parameters and errors as in `write_csv`.

    Raises
    ------
    InputError
        The runs differ in channels, rate or drop, or the file cannot be written.
    """
    first = records[0]
    for other in records[1:]:
        if (other.channels, other.rate, other.drop, other.quantity) != (
            first.channels,
            first.rate,
            first.drop,
            first.quantity,
        ):
            raise InputError(str(path), "the runs are of different tests", "Write one file per test.")

    def produce(temporary: Path) -> None:
        """Write the file under a temporary name."""
        with h5py.File(temporary, "w") as file:
            for name, value in _facts(first).items():
                file.attrs[name] = value
            group = file.create_group("channels")
            text = h5py.string_dtype("utf-8")
            group.create_dataset("name", data=[channel.name for channel in first.channels], dtype=text)
            group.create_dataset("sensor", data=[channel.sensor for channel in first.channels])
            group.create_dataset("wire", data=[channel.wire for channel in first.channels], dtype=text)
            positions = [np.nan if channel.position is None else channel.position for channel in first.channels]
            group.create_dataset("position_m", data=positions)
            group.create_dataset("direction", data=[f"+{channel.axis}" for channel in first.channels], dtype=text)
            group.create_dataset("unit", data=[SI_UNIT[first.quantity]] * len(first.channels), dtype=text)
            for k, record in enumerate(records, 1):
                file.create_dataset(f"run_{k}/{record.quantity}", data=record.signals.T, compression="gzip")

    produce_atomically(path, produce)


def _facts(record: DropRecord) -> dict[str, Any]:
    facts = {
        "test": record.name,
        "quantity": record.quantity,
        "sampling_rate_hz": record.rate,
        "drop_mass_kg": record.drop.mass,
        "drop_wire": record.drop.wire,
        "drop_position_m": record.drop.position,
        "trigger_nominal_s": record.drop.trigger_nominal,
        "spans_m": np.array(record.line.spans) if record.line.spans else None,
        "cw_tension_n": record.line.contact_wire_tension,
        "mw_tension_n": record.line.messenger_wire_tension,
    }
    return {name: value for name, value in facts.items() if value is not None}


def _sidecar(record: DropRecord) -> dict[str, Any]:
    tables: dict[str, dict[str, Any]] = {
        "test": {
            "name": record.name,
            "spans_m": list(record.line.spans) or None,
            "cw_tension_n": record.line.contact_wire_tension,
            "mw_tension_n": record.line.messenger_wire_tension,
        },
        "drop": {"mass_kg": record.drop.mass, "wire": record.drop.wire, "position_m": record.drop.position},
        "record": {
            "sampling_rate_hz": record.rate,
            "trigger_nominal_s": record.drop.trigger_nominal,
            "n_channels": len(record.channels),
            "quantity": record.quantity,
        },
    }
    channels: list[dict[str, Any]] = [
        {
            "column": c,
            "name": channel.name,
            "sensor": channel.sensor,
            "wire": channel.wire,
            "position_m": channel.position,
            "direction": f"+{channel.axis}",
            "unit": SI_UNIT[record.quantity],
        }
        for c, channel in enumerate(record.channels, 1)
    ]
    return {name: _known(table) for name, table in tables.items()} | {"channel": [_known(one) for one in channels]}


def _known(table: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None}
