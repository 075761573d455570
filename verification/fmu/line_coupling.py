"""Exported lines under the built-in pantographs, in FMPy: their quantities over those of the built-in passage.

`python -m verification.fmu.line_coupling [CASE ...]`: once per version of FMI with repeated steps. Then, for the first
case without repeated steps, over the time step: the pantograph first and the line with its new height, or both at once.
"""

import sys
import tempfile
from collections.abc import Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.case_run import build_passage, record_passage
from pantocheck.conformance.runs.line_fmu import FmiVersion, build_line_fmu
from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator
from pantocheck.conformance.runs.system import Delivered
from pantocheck.conformance.runs.uplift_tuning import estimate_uplift_forces
from pantocheck.model.description.pantograph import Pantograph, equilibrium
from pantocheck.model.dynamics.passage import History
from verification.fmu.coupling_table import compare_quantities, state_forces
from verification.fmu.fmu_builder import find_missing_tool

CASES = ("en50318-2002/250", "en50318-2018/ac-simple/275", "en50318-2018/ac-simple/275-twin")
Order = Literal["repeated", "in turn", "at once"]
"""Order in which an importer advances pantographs and line."""
AGREEMENT = 1e-9
"""Largest change of a force in the last iteration of a step [N]."""


class ImportedLine:
    """Instance of an exported line in FMPy, with the variables by their names."""

    def __init__(self, folder: str, values: dict[str, float]) -> None:
        from fmpy.model_description import read_model_description
        from fmpy.simulation import instantiate_fmu

        described = read_model_description(folder)
        self.number = {variable.name: variable.valueReference for variable in described.modelVariables}
        self.unit: Any = instantiate_fmu(folder, described, "CoSimulation")
        self.second = described.fmiVersion == "2.0"
        self.time_step = float(described.defaultExperiment.stepSize)
        self.start(values)

    def start(self, values: dict[str, float]) -> None:
        """Initialise the instance with other values than its own."""
        if values:
            self.set(values)
        if self.second:
            self.unit.setupExperiment(startTime=0.0)
        self.unit.enterInitializationMode()
        self.unit.exitInitializationMode()
        self.time = 0.0

    def set(self, values: dict[str, float]) -> None:
        """Set variables."""
        write = self.unit.setReal if self.second else self.unit.setFloat64
        write([self.number[name] for name in values], list(values.values()))

    def get(self, kind: str) -> RealArray:
        """Values of all variables of a kind, such as `uplift`."""
        read = self.unit.getReal if self.second else self.unit.getFloat64
        return np.array(read([n for name, n in self.number.items() if name.startswith(f"{kind}_")]))

    def step(self, kind: str, values: RealArray) -> None:
        """Set inputs of a kind and advance by one time step of the line."""
        names = [name for name in self.number if name.startswith(f"{kind}_")]
        self.set(dict(zip(names, values.tolist(), strict=True)))
        self.unit.doStep(self.time, self.time_step)
        self.time += self.time_step

    def save(self) -> Any:
        """State and time."""
        return self.unit.getFMUState(), self.time

    def restore(self, kept: Any) -> None:
        """Return to a state."""
        self.unit.setFMUState(kept[0])
        self.time = kept[1]

    def free(self, kept: Any) -> None:
        """Free a state."""
        (self.unit.freeFMUstate if self.second else self.unit.freeFMUState)(kept[0])

    def reset(self, values: dict[str, float]) -> None:
        """Begin anew."""
        self.unit.reset()
        self.start(values)


@contextmanager
def open_line(archive: Path, values: dict[str, float] | None = None) -> Any:
    """Unpack and load an exported line."""
    from fmpy import extract

    with tempfile.TemporaryDirectory() as folder:
        extract(archive, folder)
        line = ImportedLine(folder, values or {})
        yield line
        line.unit.terminate()
        line.unit.freeInstance()


class MovedPantograph:
    """Linear pantograph with one strip, by average acceleration under the force at the end of each step."""

    def __init__(self, pantograph: Pantograph, height: float, time_step: float) -> None:
        self.model, self.dt = pantograph, time_step
        half, quarter = time_step / 2, time_step**2 / 4
        self.inverse = np.linalg.inv(pantograph.mass + half * pantograph.damping + quarter * pantograph.stiffness)
        self.head = pantograph.strip_shapes[0]
        self.z = equilibrium(pantograph, np.array([height]))[0]
        self.v, self.a = np.zeros_like(self.z), np.zeros_like(self.z)

    def attempt(self, force: float, held: bool = False) -> tuple[RealArray, RealArray, RealArray]:
        """Displacement, velocity and acceleration after a step that ends with a contact force, or holds it."""
        if held:
            load = self.model.force - self.head * force - self.model.damping @ self.v - self.model.stiffness @ self.z
            self.a = np.linalg.solve(self.model.mass, load)
        v = self.v + self.dt / 2 * self.a
        z = self.z + self.dt * self.v + self.dt**2 / 4 * self.a
        load = self.model.force - self.head * force - self.model.damping @ v - self.model.stiffness @ z
        a = self.inverse @ load
        return z + self.dt**2 / 4 * a, v + self.dt / 2 * a, a


def couple_line(
    line: ImportedLine, pantographs: Sequence[Pantograph], steps: int, order: Order = "repeated"
) -> dict[str, RealArray]:
    """Move pantographs along an exported line; a repeated step ends when its forces agree.

    Returns:
        Forces, heights, positions and uplifts at the ends of the steps, by the names of their variables.
    """
    pairs = zip(pantographs, line.get("head_height"), strict=True)
    moved = [MovedPantograph(pantograph, float(height), line.time_step) for pantograph, height in pairs]
    forces, heights, rows = line.get("contact_force"), line.get("head_height"), []
    for _ in range(steps):
        kept = line.save()
        for attempt in range(30):
            if attempt:
                line.restore(kept)
            states = [one.attempt(force, order != "repeated") for one, force in zip(moved, forces, strict=True)]
            last, heights = heights, np.array([one.head @ state[0] for one, state in zip(moved, states, strict=True)])
            line.step("head_height", last if order == "at once" else heights)
            before, forces = forces, line.get("contact_force")
            if order != "repeated" or np.abs(forces - before).max() < AGREEMENT:
                break
        line.free(kept)
        for one, state in zip(moved, states, strict=True):
            one.z, one.v, one.a = state
        rows.append((forces, heights, line.get("position"), line.get("uplift")))
    names = ("contact_force", "head_height", "position", "uplift")
    return dict(zip(names, (np.array(row).T for row in zip(*rows, strict=True)), strict=True))


def run_exported(case: Case, archive: Path, order: Order = "repeated") -> CaseResult:
    """Results of a case whose line is an FMU."""
    discretisation = case.file.discretisation
    line = discretise_line(case.line, discretisation.element_m)
    passage = build_passage(case, line, discretisation, estimate_uplift_forces(case, line))
    steps = round(passage.duration / passage.time_step)
    with open_line(archive) as imported:
        found = couple_line(imported, passage.pantographs, steps, order)
    supports = [list(case.line.geometry.supports).index(x) for _, x in passage.watched]
    motion = np.repeat(found["uplift"][supports][:, :, None], 3, axis=2)
    time = passage.time_step * np.arange(1, steps + 1)
    force = found["contact_force"]
    history = History(time, found["position"], force, found["head_height"], motion, force)
    expected = UnrefinedSimulator().run(case)
    return grade_case(case, Delivered(record_passage(case, passage, history), expected.static), "secondary")


def select_moving(names: Sequence[str]) -> list[Case]:
    """Cases with a train, without a tuning of their forces."""
    return [state_forces(case) for case in select_cases(names or CASES) if not case.is_static]


def measure_orders(case: Case) -> None:
    """Print the differences without repeated steps over the time step."""
    step = case.file.discretisation.time_step_s
    print("| case | order | time step [ms] | largest difference of a quantity | quantity | standard deviation |")
    print("|---|---|--:|--:|---|--:|")
    for part in (1, 2, 4, 8):
        mesh = case.file.discretisation.model_copy(update={"time_step_s": step / part})
        finer = replace(case, file=case.file.model_copy(update={"discretisation": mesh}))
        expected = grade_case(finer, UnrefinedSimulator().run(finer), "secondary")
        orders: tuple[Order, ...] = ("in turn", "at once")
        with tempfile.TemporaryDirectory() as folder:
            archive = Path(folder) / "line.fmu"
            archive.write_bytes(build_line_fmu(finer, "3.0", "height"))
            for order in orders:
                found = run_exported(finer, archive, order)
                difference, quantity = compare_quantities(expected, found)
                spread = np.divide(*(float(result.quantities["1"]["std_force_N"]) for result in (found, expected))) - 1
                sizes = f"{100 * difference:.2g} % | {quantity} | {100 * spread:+.2g} %"
                print(f"| {case.id} | {order} | {1000 * step / part:g} | {sizes} |", flush=True)


def main(names: Sequence[str]) -> None:
    """Print the tables."""
    if (reason := find_missing_tool()) is not None:
        sys.exit(reason)
    print("| case | FMI | largest difference of a quantity | quantity |\n|---|---|--:|---|")
    versions: tuple[FmiVersion, ...] = ("3.0", "2.0")
    for case in select_moving(names):
        expected = grade_case(case, UnrefinedSimulator().run(case), "secondary")
        for fmi in versions:
            with tempfile.TemporaryDirectory() as folder:
                archive = Path(folder) / "line.fmu"
                archive.write_bytes(build_line_fmu(case, fmi, "height"))
                difference, quantity = compare_quantities(expected, run_exported(case, archive))
            print(f"| {case.id} | {fmi} | {100 * difference:.1e} % | {quantity} |", flush=True)
    print()
    measure_orders(select_moving(names)[0])


if __name__ == "__main__":
    main(sys.argv[1:])
