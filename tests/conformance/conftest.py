"""Fixtures: a system whose quantities are known by hand, copies of a case, and records with known samples."""

import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import library_folder, load_case
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.input_files.formats.csv_table import write_csv_table
from pantocheck.conformance.input_files.formats.hdf5_table import write_hdf5_table
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.outcome import Delivered, Outcome
from pantocheck.conformance.simulation.pantograph_model import build_pantograph

MEAN, SIGMA, UPLIFT_MM = 119.0, 28.0, 50.0


@dataclass(frozen=True)
class Wave:
    """A force of one sine per span about a mean, sigma as given; a bump of uplift at each passage of a support."""

    mean: float = MEAN
    sigma: float = SIGMA
    rate: float = 1000.0
    name: str = "wave"
    version: str = "1"
    kind: Literal["builtin"] = "builtin"

    def run(self, case: Case) -> Outcome:
        record = self.record(case)
        refined = Delivered(Wave(self.mean, 1.01 * self.sigma, 2 * self.rate).record(case))
        return Delivered(
            record,
            run=RunTable(simulated_s=float(record.time[-1]), wall_s=0.1, dt_s=1 / self.rate, element_m=0.5),
            refined=refined,
        )

    def record(self, case: Case) -> Record:
        time = np.arange(int((case.end - case.start) / case.speed * self.rate)) / self.rate
        last = case.start + case.speed * time
        position = np.array([last + case.offsets[-1] - behind for behind in case.offsets])
        start, end = case.line.geometry.span(1)
        span = end - start
        force = self.mean + np.sqrt(2) * self.sigma * np.sin(2 * np.pi * position / span)
        supports = np.array(case.line.geometry.span_limits)
        bumps = np.exp(-(((position - supports[:, None, None]) / 5) ** 2))
        uplift = 1e-3 * UPLIFT_MM * bumps.sum(axis=1)
        height = np.array([self.height(*of, case.speed, span) for of in zip(case.pantographs, position, strict=True)])
        return Record(time, case.speed, position, force, case.analysis_section, None, height, supports, uplift)

    def height(self, file: PantographFile, position: np.ndarray, speed: float, span: float) -> np.ndarray:
        """Motion of a pantograph's head under that force, once it has settled."""
        model, omega = build_pantograph(file, 0.0, 0.0), 2 * np.pi * speed / span
        stiffness = model.stiffness + 1j * omega * model.damping - omega**2 * model.mass
        compliance = model.head @ np.linalg.solve(stiffness, model.head)
        return -np.imag(compliance * np.sqrt(2) * self.sigma * np.exp(2j * np.pi * position / span))


@pytest.fixture(scope="session")
def wave() -> type[Wave]:
    return Wave


@pytest.fixture
def case_250() -> Case:
    return load_case(library_folder() / "en50318-2002" / "250.toml")


@pytest.fixture
def own_case(tmp_path: Path) -> Callable[..., Path]:
    """Copy of the 250 km/h case with one text replaced in one of its files; gives the path of the case."""

    def copy(file: str, old: str, new: str) -> Path:
        for name in ("250.toml", "line.toml", "pantograph.toml"):
            text = (library_folder() / "en50318-2002" / name).read_text(encoding="utf-8")
            if name == file:
                assert old in text
                text = text.replace(old, new, 1)
            (tmp_path / name).write_text(text, encoding="utf-8")
        return tmp_path / "250.toml"

    return copy


@pytest.fixture
def edited_case(tmp_path: Path) -> Callable[[str, dict[str, Any]], Path]:
    """Copy of the 250 km/h case with values changed in one of its files; gives the path of the case."""

    def copy(file: str, changes: dict[str, Any]) -> Path:
        for name in ("250.toml", "line.toml", "pantograph.toml"):
            shutil.copy(library_folder() / "en50318-2002" / name, tmp_path / name)
        edit_toml(tmp_path / file, changes)
        return tmp_path / "250.toml"

    return copy


@pytest.fixture
def two_pantograph_case(case_250: Case) -> Case:
    """The 250 km/h case with a second pantograph 150 m behind the first."""
    file = case_250.file.model_copy(update={"spacing_m": (150.0,), "pantograph": case_250.file.pantograph * 2})
    return replace(case_250, file=file, pantographs=case_250.pantographs * 2)


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
    assert record.contact_height is not None
    assert record.support_uplift is not None
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
