"""Writing of mass-drop records in the format of a suffix; reading these files gives the same record."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
import tomli_w

from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.files import produce_atomically, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import CSV, HDF5, UFF, TableFormat
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.core.units import SI_UNITS
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.drop_sidecar import DropSidecar

UNWRITABLE = ",;\t\"'"
"""Characters that are not possible in the head line of a CSV file, because it is read without quoting."""


def write_drop_csv(record: DropRecord, path: Path) -> None:
    """Write a record as CSV (decimal points, commas), with a sidecar beside it.

    Raises:
        InputError: A file cannot be written, or the name of a channel is not possible in a head line.
    """
    for channel in record.channels:
        if set(channel.name) & set(UNWRITABLE) or channel.name.strip().splitlines() != [channel.name]:
            raise InputError(
                f"{path.name}, channel {channel.name!r}",
                "this name is not possible in the head line of a CSV file",
                "Rename the channel without comma, semicolon, tab, quote and line break, or write HDF5.",
            )
    names = ["time_s", *(channel.name for channel in record.channels)]
    values = np.column_stack([record.time, record.signals])
    write_drop_sidecar(record, path)
    produce_atomically(path, lambda temporary: write_csv_table(temporary, names, values, 9))


def write_drop_hdf5(records: tuple[DropRecord, ...], path: Path) -> None:
    """Write the runs of one test as HDF5.

    Raises:
        InputError: The runs differ in channels, rate, quantity or drop, or the file cannot be written.
    """
    from pantocheck.conformance.core.hdf5_table import write_hdf5_table

    first = records[0]
    for other in records[1:]:
        same = (other.channels, other.rate, other.drop) == (first.channels, first.rate, first.drop)
        if not same or other.quantity != first.quantity:
            raise InputError(
                str(path), "the runs differ in channels, rate, quantity or drop", "Write one file per test."
            )
    attributes = {
        "test": first.name,
        "quantity": first.quantity,
        "sampling_rate_hz": first.rate,
        "drop_mass_kg": first.drop.mass,
        "drop_wire": first.drop.wire,
        "drop_position_m": first.drop.position,
        "trigger_nominal_s": first.drop.trigger_nominal,
        "spans_m": list(first.line.spans_m) or None,
        "cw_tension_n": first.line.contact_wire_tension_N,
        "mw_tension_n": first.line.messenger_wire_tension_N,
    }
    channels = _list_channels(first)
    datasets: dict[str, Any] = {f"channels/{key}": [channel[key] for channel in channels] for key in channels[0]}
    datasets["channels/position_m"] = [np.nan if x is None else x for x in datasets["channels/position_m"]]
    datasets |= {f"run_{k}/{record.quantity}": record.signals.T for k, record in enumerate(records, 1)}
    produce_atomically(path, lambda temporary: write_hdf5_table(temporary, _select_known(attributes), datasets))


def check_drop_sidecar(path: Path) -> None:
    """Check that the sidecar of a record replaces no other file, such as the case of the drop.

    Raises:
        InputError: The sidecar would overwrite a file that is not a sidecar of a drop record.
    """
    target = path.with_suffix(".toml")
    if target.exists() and not read_toml(target, "sidecar").keys() <= DropSidecar.model_fields.keys():
        raise InputError(
            f"record '{path}'",
            f"the sidecar would overwrite {target.name}, which is not a sidecar of a drop record",
            "Give the record another name.",
        )


def write_drop_sidecar(record: DropRecord, path: Path) -> None:
    """Write the sidecar of the record at `path`; errors as in `write_drop_csv` and `check_drop_sidecar`."""
    check_drop_sidecar(path)
    tables: dict[str, dict[str, Any]] = {
        "test": {
            "name": record.name,
            "spans_m": list(record.line.spans_m) or None,
            "cw_tension_n": record.line.contact_wire_tension_N,
            "mw_tension_n": record.line.messenger_wire_tension_N,
        },
        "drop": {"mass_kg": record.drop.mass, "wire": record.drop.wire, "position_m": record.drop.position},
        "record": {
            "sampling_rate_hz": record.rate,
            "trigger_nominal_s": record.drop.trigger_nominal,
            "n_channels": len(record.channels),
            "quantity": record.quantity,
        },
    }
    known: dict[str, Any] = {name: _select_known(table) for name, table in tables.items()}
    known["channel"] = [{"column": c} | _select_known(table) for c, table in enumerate(_list_channels(record), 1)]
    write_atomically(path.with_suffix(".toml"), tomli_w.dumps(known).encode())


def _list_channels(record: DropRecord) -> list[dict[str, Any]]:
    """Description of each channel, by the keys of the files."""
    return [
        {
            "name": channel.name,
            "sensor": channel.sensor,
            "wire": channel.wire,
            "position_m": channel.position,
            "direction": f"+{channel.axis}",
            "unit": SI_UNITS[record.quantity],
        }
        for channel in record.channels
    ]


def _select_known(table: dict[str, Any]) -> dict[str, Any]:
    """Table without the values None, which TOML and HDF5 do not have."""
    return {key: value for key, value in table.items() if value is not None}


# Universal files, one data set 58 per channel.
def write_drop_uff(record: DropRecord, path: Path, form: Literal["ascii", "binary"] = "binary") -> None:
    """Write a record as universal file, with a sidecar beside it; ASCII numbers have twelve digits.

    The format has no fields for wire, position, mass and planned release; they stand in its identification lines and in
    the sidecar.

    Raises:
        InputError: A file cannot be written.
    """
    from pantocheck.conformance.core.uff_table import write_data_sets  # an optional package

    sets = [_build_data_set(record, c, form) for c in range(len(record.channels))]
    write_drop_sidecar(record, path)
    write_data_sets(path, sets)


def _build_data_set(record: DropRecord, c: int, form: Literal["ascii", "binary"]) -> dict[str, Any]:
    """Data set 58 of a channel; fields for other kinds of data are 0 or NONE."""
    import pyuff

    from pantocheck.conformance.core.uff_table import DATA_TYPES, encode_identification_line

    channel = record.channels[c]
    data_set = pyuff.prepare_58(
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
        ordinate_spec_data_type=DATA_TYPES[record.quantity],
        ordinate_axis_units_lab=SI_UNITS[record.quantity],
        orddenom_spec_data_type=0,
        orddenom_axis_units_lab="NONE",
        z_axis_spec_data_type=0,
        z_axis_axis_units_lab="NONE",
        id1=encode_identification_line(record.name),
        id2=encode_identification_line(_format_drop(record.drop)),
        id3=encode_identification_line(_format_channel(channel)),
        id4=record.quantity,
        id5="NONE",
    )
    return dict(data_set)


def _format_drop(drop: DropDescription) -> str:
    """Identification line of the mass drop; empty unless the drop is fully known."""
    if drop.mass is None or drop.position is None or not drop.wire:
        return ""
    trigger = "" if drop.trigger_nominal is None else f", trigger at {drop.trigger_nominal:g} s"
    return f"{drop.mass:g} kg on {drop.wire} at {drop.position:g} m{trigger}"


def _format_channel(channel: DropChannel) -> str:
    """Identification line of a channel; empty if the name is not possible there: the sidecar then holds it alone."""
    if channel.position is None or not channel.wire or " " in channel.name or not channel.name.isascii():
        return ""
    return f"{channel.name} {channel.wire} at {channel.position:g} m dir +{channel.axis}"


# Formats of written records, by the suffix of the file.
DROP_WRITERS: dict[TableFormat, Callable[[DropRecord, Path], None]] = {
    UFF: write_drop_uff,
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
