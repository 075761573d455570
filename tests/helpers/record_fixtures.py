"""Fixtures for all tests: a record of two pantographs, and the same record in other units."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from helpers.toml_edit import edit_toml
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.hdf5_table import write_hdf5_table
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record


@pytest.fixture
def two_pantograph_record() -> Record:
    """Two pantographs 100 m apart and three supports, 2 s at 200 Hz; every channel has other numbers."""
    time = np.arange(400) / 200
    position = 150 + 60 * time - np.array([[0.0], [100.0]])
    supports = np.array([60.0, 120.0, 180.0])
    return Record(
        time=time,
        speed=60.0,
        position=position,
        force=np.array([[120.0], [110.0]]) + 30 * np.sin(2 * np.pi * position / 60),
        evaluated=(160.0, 165.0),
        contact_height=0.01 * np.cos(2 * np.pi * position / 60),
        support_position=supports,
        support_uplift=0.05 * np.exp(-(((position[0] - supports[:, None]) / 5) ** 2)),
    )


@pytest.fixture(params=["csv", "h5"])
def converted_record(request: pytest.FixtureRequest, tmp_path: Path, two_pantograph_record: Record) -> Path:
    """Record of two pantographs in other units: time in ms, position in km, force in kN, height in cm, uplift in mm."""
    record = two_pantograph_record
    path = tmp_path / f"converted.{request.param}"
    sidecar = edit_toml(write_record(path, record), {"sha256": None})
    channels = {
        ("time", "ms"): 1e3 * record.time,
        ("position", "km"): 1e-3 * record.position,
        ("force", "kN"): 1e-3 * record.force,
        ("contact_height", "cm"): 1e2 * record.contact_height,
        ("uplift", "mm"): 1e3 * record.support_uplift,
    }
    if request.param == "h5":
        write_hdf5_table(path, {}, {f"{name}_{unit}": values for (name, unit), values in channels.items()})
    else:
        columns = {
            f"{name}_{unit}" if values.ndim == 1 else f"{name}_{row}_{unit}": samples
            for (name, unit), values in channels.items()
            for row, samples in enumerate(np.atleast_2d(values), 1)
        }
        write_csv_table(path, list(columns), np.column_stack(list(columns.values())), 15)
    return sidecar


def change(
    record: Record, channel: str, row: int, edit: Callable[[NDArray[np.float64]], NDArray[np.float64]]
) -> Record:
    """The record with one channel of one pantograph changed."""
    channels = getattr(record, channel).copy()
    channels[row] = edit(channels[row])
    return replace(record, **{channel: channels})
