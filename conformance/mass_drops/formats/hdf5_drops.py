"""HDF5 records: `run_<k>/<quantity>` of shape (channels, samples), facts in root attributes, `channels` in a group."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_assembly import DropColumn, DropColumns
from pantocheck.conformance.mass_drops.drop_record import DropDescription, DropLine
from pantocheck.conformance.mass_drops.drop_sidecar import DropChannelTable, DropSidecar

MOTION_QUANTITIES = ("acceleration", "velocity", "displacement")


def read_hdf5_drops(path: Path, sidecar: DropSidecar | None) -> list[DropColumns]:
    """All runs of an HDF5 file in the order of their numbers; errors as in `read_records`."""
    source = path.name
    try:
        with h5py.File(path, "r") as file:
            runs = sorted((name for name in file if name.startswith("run_")), key=_number)
            if not runs:
                raise InputError(source, "holds no group run_1", "Store each run as run_<k>/acceleration.")
            columns = _columns(file, sidecar is not None, source)
            return [_run(file, name, k if len(runs) > 1 else 0, columns, source) for k, name in enumerate(runs, 1)]
    except (OSError, KeyError, TypeError, ValueError, RuntimeError, OverflowError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(source, f"is damaged or not HDF5 ({str(error)[:120]})", "Export the record again.") from None


def _number(name: str) -> tuple[int, str]:
    tail = name.removeprefix("run_")
    return (int(tail) if tail.isdecimal() else 0, tail)


def _columns(file: h5py.File, described: bool, source: str) -> tuple[DropColumn, ...] | None:
    if "channels" not in file:
        return None
    group = file["channels"]
    names = _texts(group["name"])
    if described:
        return tuple(DropColumn(name, unit) for name, unit in zip(names, _texts(group["unit"]), strict=True))
    listed = zip(
        names,
        group["sensor"][()],
        _texts(group["wire"]),
        group["position_m"][()],
        _texts(group["direction"]),
        _texts(group["unit"]),
        strict=True,
    )
    tables = []
    for column, (name, sensor, wire, position, direction, unit) in enumerate(listed, 1):
        tables.append(
            DropChannelTable(
                column=column,
                name=name,
                sensor=int(sensor),
                wire=wire,
                position_m=float(position) if np.isfinite(position) else None,
                direction=direction,
                unit=unit,
            )
        )
    if not tables:
        raise InputError(source, "describes no channel", "Fill the group 'channels', or write a sidecar.")
    return tuple(DropColumn(table.name, None, table) for table in tables)


def _run(file: h5py.File, name: str, run: int, columns: tuple[DropColumn, ...] | None, source: str) -> DropColumns:
    data = next((file[name][quantity] for quantity in MOTION_QUANTITIES if quantity in file[name]), None)
    if not isinstance(data, h5py.Dataset) or data.ndim != 2:
        raise InputError(
            f"{source}, {name}", "holds no table of samples", f"Store {name}/acceleration (channel, sample)."
        )
    values = np.asarray(data[()], dtype=np.float64).T
    if columns is not None and len(columns) != values.shape[1]:
        raise InputError(
            f"{source}, {name}",
            f"{values.shape[1]} channels, {len(columns)} are described",
            "A channel is missing: export the record again.",
        )
    facts = dict(file.attrs)
    rate = facts.get("sampling_rate_hz")
    return DropColumns(
        values,
        columns if columns is not None else (DropColumn(),) * values.shape[1],
        rate=float(rate) if rate is not None else None,
        title=_text(facts.get("test", "")),
        run=run,
        drop=DropDescription(
            _maybe(facts.get("drop_mass_kg")),
            _text(facts.get("drop_wire", "")).upper(),
            _maybe(facts.get("drop_position_m")),
            _maybe(facts.get("trigger_nominal_s")),
        ),
        line=DropLine(
            tuple(float(span) for span in np.atleast_1d(facts.get("spans_m", ()))),
            _maybe(facts.get("cw_tension_n")),
            _maybe(facts.get("mw_tension_n")),
        ),
    )


def _maybe(value: Any) -> float | None:
    return None if value is None else float(value)


def _text(value: Any) -> str:
    return value.decode("utf-8") if isinstance(value, bytes) else str(value)


def _texts(data: Any) -> list[str]:
    return [_text(value) for value in data[()]]
