"""System whose quantities are known by hand: a sine of the contact force in every span.

A ripple at 40 Hz gives the force the content above 20 Hz of every contact force. It changes the variance by 2e-6.
"""

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.runs.system import Delivered

MEAN, SIGMA, UPLIFT_MM = 119.0, 28.0, 50.0
RIPPLE_N, RIPPLE_HZ = 0.05, 40.0


@dataclass(frozen=True)
class Wave:
    """A force of one sine per span about a mean, sigma as given; a bump of uplift at each passage of a support."""

    mean: float = MEAN
    sigma: float = SIGMA
    rate: float = 1000.0
    name: str = "wave"
    version: str = "1"
    kind: Literal["builtin"] = "builtin"

    def run(self, case: Case) -> Delivered:
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
        force += RIPPLE_N * np.sin(2 * np.pi * RIPPLE_HZ * time)
        supports = np.array(case.line.geometry.span_limits)
        bumps = np.exp(-(((position - supports[:, None, None]) / 5) ** 2))
        uplift = 1e-3 * UPLIFT_MM * bumps.sum(axis=1)
        height = np.array(
            [self.height(file, x, case.speed, span) for file, x in zip(case.pantographs, position, strict=True)]
        )
        return Record(time, case.speed, position, force, case.analysis_section, None, height, supports, uplift)

    def height(self, file: PantographFile, position: RealArray, speed: float, span: float) -> RealArray:
        """Motion of a pantograph's head under that force, once it has settled."""
        model, omega = build_pantograph(file, 0.0, 0.0), 2 * np.pi * speed / span
        stiffness = model.stiffness + 1j * omega * model.damping - omega**2 * model.mass
        compliance = model.head @ np.linalg.solve(stiffness, model.head)
        return np.asarray(-np.imag(compliance * np.sqrt(2) * self.sigma * np.exp(2j * np.pi * position / span)))


def cut_bare(record: Record, samples: Any) -> Record:
    """Some samples of a record, without contact height and uplift."""
    cut = {name: getattr(record, name)[:, samples] for name in ("position", "force")}
    bare = dict.fromkeys(("contact_height", "support_position", "support_uplift"))
    return replace(record, time=record.time[samples], **cut, **bare)
