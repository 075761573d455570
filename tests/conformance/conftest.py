"""A made-up system whose every quantity is known by hand, for the tests of what grades it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import library_folder, load_case
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.outcome import Delivered, Outcome
from pantocheck.conformance.simulation.pantograph_model import build_pantograph

MEAN, SIGMA, UPLIFT_MM = 119.0, 28.0, 50.0


@dataclass(frozen=True)
class Wave:
    """A force of one sine per span about a mean, sigma as given; a bump of uplift as each support is passed."""

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
        uplift = 1e-3 * UPLIFT_MM * np.exp(-(((position[0] - supports[:, None]) / 5) ** 2))
        height = np.array([self.height(*of, case.speed, span) for of in zip(case.pantographs, position, strict=True)])
        return Record(time, case.speed, position, force, case.analysis_section, None, height, supports, uplift)

    def height(self, file: PantographFile, position: np.ndarray, speed: float, span: float) -> np.ndarray:
        """Motion of a pantograph's head under that force, once it has settled."""
        model, omega = build_pantograph(file, 0.0, 0.0), 2 * np.pi * speed / span
        stiffness = model.stiffness + 1j * omega * model.damping - omega**2 * model.mass
        compliance = model.head @ np.linalg.solve(stiffness, model.head)
        return -np.imag(compliance * np.sqrt(2) * self.sigma * np.exp(2j * np.pi * position / span))


@pytest.fixture
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
