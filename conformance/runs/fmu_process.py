"""FMU as a pantograph of a passage: its process, its units, and its motion step by step."""

import json
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.extras import require_package
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.units import UNIT_FAMILIES
from pantocheck.conformance.pantograph.fmu_archive import unpack_fmu
from pantocheck.conformance.pantograph.fmu_table import FmuTable
from pantocheck.conformance.results.case_facts_format import FmuOutput, FmuRun
from pantocheck.conformance.runs.program import Program, ProgramFailed
from pantocheck.model.description.failures import SimulationError
from pantocheck.model.dynamics.passage import Coupling

LOAD_LIMIT, STEP_LIMIT = 60.0, 10.0
"""Time limit of loading and initialisation, and of one step [s]."""
ALL_ANSWERS = 2**33
"""Largest size of all answers of a process [bytes]."""
WORKER = ("-P", "-m", "pantocheck.conformance.runs.fmu_worker")
"""Arguments of the interpreter that runs the process; it does not import from its working folder."""

BASE_UNITS = {"N": {"kg": 1, "m": 1, "s": -2}, "m": {"m": 1}, "km/h": {"m": 1, "s": -1}}
"""Exponents of the SI base units of the unit of each key."""
KEY_FACTORS = {"N": 1.0, "m": 1.0, "km/h": 1 / 3.6}
"""Factor of the unit of each key to its SI unit."""
INPUTS = {"contact_force_N": "N", "uplift_force_N": "N", "train_speed_km_h": "km/h", "base_height_m": "m"}
OUTPUTS = {"head_height_m": "m"}
"""Keys of inputs and outputs, with their units."""


class FmuFailed(SimulationError):
    """An FMU ended, answered too late, or failed: its motion is not known, so that there is nothing to grade."""


@dataclass(frozen=True)
class FmuFacts:
    """Facts of the model description of an FMU."""

    fmi_version: str
    model_name: str
    model_version: str
    tool: str
    """Tool that generated it; empty: not stated."""
    has_state: bool
    """Whether its state can be kept and restored."""
    variables: Mapping[str, Mapping[str, Any]]
    """Causality, unit and base units of each variable of floating point."""


@dataclass(frozen=True)
class Scale:
    """Conversion of a variable: value in SI units = factor times its value + offset."""

    factor: float
    offset: float = 0.0

    def to_variable(self, value: RealArray) -> RealArray:
        """Values of a variable, from values in SI units."""
        return (value - self.offset) / self.factor


def find_scale(key: str, unit: str, name: str, facts: FmuFacts, where: str) -> Scale:
    """Conversion of the variable of a key to SI units.

    Args:
        key: Key of the table `fmu`.
        unit: Unit of this key.
        name: Name of the variable.
        facts: Model description.
        where: Name of the table in messages.

    Raises:
        InputError: There is no such variable, its causality does not fit, or its unit is that of another quantity.
    """
    variable = facts.variables.get(name)
    if variable is None:
        hint = suggest_names(name, list(facts.variables))
        raise InputError(f"{where}, key {key}", f"the FMU has no real variable {name!r}", hint)
    causalities = ("output", "local") if key in OUTPUTS else ("input", "parameter")
    if variable["causality"] not in causalities or (key == "contact_force_N" and variable["causality"] != "input"):
        found = f"{name!r} is {variable['causality']}"
        raise InputError(f"{where}, key {key}", found, f"Name a variable that is {' or '.join(causalities)}.")
    base, text = variable["base"], variable["unit"]
    if base is not None:
        expected = {"factor": base["factor"], "offset": base["offset"], **BASE_UNITS[unit]}
        if {symbol: value for symbol, value in base.items() if value or symbol in expected} == expected:
            return Scale(base["factor"], base["offset"])
    elif not text:
        return Scale(KEY_FACTORS[unit])
    else:
        family = next(family for family in UNIT_FAMILIES if unit in family.factors)
        if text in family.factors:
            return Scale(family.factors[text])
    raise InputError(f"{where}, key {key}", f"{name!r} has the unit {text!r}", f"A unit as {unit} is expected.")


class FmuPantograph:
    """FMU in a process of its own, which moves a pantograph; see `model.dynamics.foreign_pantograph`.

    Args:
        table: Table `fmu` with an absolute path.
        values: Values of the inputs and parameters by key, in the unit of the key.
        time_step: Length of a step [s].
        offset: Height above the datum of the line minus the height of the FMU [m].

    Raises:
        FmuFailed: The FMU does not start.
        InputError: A variable is missing, or has a wrong unit.
    """

    def __init__(self, table: FmuTable, values: Mapping[str, float], time_step: float, offset: float) -> None:
        self.table, self.where = table, f"FMU '{table.file}'"
        self._values, self._time_step, self._offset = values, time_step, offset
        self._processes = ExitStack()
        self._accepted = False
        self._last: list[float] = []
        self._kept: list[list[float]] = []
        try:
            self.facts = self._start()
        except BaseException:
            self.close()
            raise

    @property
    def can_repeat(self) -> bool:
        """Whether a step can be repeated from its start."""
        return self.facts.has_state or self.table.interface == "model-exchange"

    def _start(self) -> FmuFacts:
        """Start the process and the FMU in it."""
        # Every process has its own copy: an FMU that writes into its folder must not change another one.
        folder = Path(self._processes.enter_context(tempfile.TemporaryDirectory(prefix="pantocheck-fmu-")))
        unpack_fmu(Path(self.table.model), folder, self.table.sha256)
        try:
            self._program = self._processes.enter_context(Program((sys.executable, *WORKER), folder, ALL_ANSWERS))
        except ProgramFailed as error:
            raise FmuFailed(f"{self.where} {error}") from None
        table = self.table
        names = {key: getattr(table, key) for key in (*INPUTS, *OUTPUTS) if getattr(table, key) is not None}
        used = [*(name for found in names.values() for name in np.atleast_1d(found).tolist())]
        used += [*table.parameters, *table.outputs]
        answer = self._ask(LOAD_LIMIT, "describe", folder=str(folder), interface=table.interface, names=used)
        facts = FmuFacts(**answer)
        scales = {
            (key, name): find_scale(key, (INPUTS | OUTPUTS)[key], name, facts, self.where)
            for key, name in ((key, name) for key, found in names.items() for name in np.atleast_1d(found).tolist())
        }
        self._force, self._height = (
            [scales[key, name] for name in names[key]] for key in ("contact_force_N", "head_height_m")
        )
        for name in table.parameters:
            if facts.variables.get(name, {}).get("causality") not in ("parameter", "input"):
                hint = suggest_names(name, list(facts.variables))
                raise InputError(f"{self.where}, key parameters", f"there is no parameter {name!r}", hint)
        for name in table.outputs:
            if facts.variables.get(name, {}).get("causality") not in ("output", "local"):
                hint = suggest_names(name, list(facts.variables))
                raise InputError(f"{self.where}, key outputs", f"there is no output {name!r}", hint)
        values = dict(table.parameters)
        for key in self._values.keys() & names.keys():
            values[names[key]] = float(
                scales[key, names[key]].to_variable(np.array(self._values[key] * KEY_FACTORS[INPUTS[key]]))
            )
        inputs, outputs = list(table.contact_force_N), [*table.head_height_m, *table.outputs]
        self._ask(LOAD_LIMIT, "start", step=self._time_step, inputs=inputs, outputs=outputs, values=values)
        self._accepted = False
        return facts

    def _ask(self, limit: float, request: str, **content: object) -> dict[str, Any]:
        """Answer of the process to a request.

        Raises:
            FmuFailed: It answers too late, with a failure, with something else, or not at all.
        """
        try:
            line = self._program.ask(json.dumps({"request": request, **content}).encode(), limit)
            answer = json.loads(line)
        except (ProgramFailed, ValueError, RecursionError) as error:
            raise FmuFailed(f"{self.where} {error}") from None
        if not isinstance(answer, dict) or "failure" in answer:
            reason = answer.get("failure", "") if isinstance(answer, dict) else answer
            raise FmuFailed(f"{self.where} failed at {request!r}: {reason!s:.500}")
        return answer

    def attempt(self, force: RealArray) -> RealArray:
        """Heights of the strips after a step under held forces [m, N]."""
        sign = 1.0 if self.table.contact_force_positive == "down" else -1.0
        pairs = zip(self._force, sign * force, strict=True)
        values = [float(scale.to_variable(value)) for scale, value in pairs]
        answer = self._ask(STEP_LIMIT, "step", values=values, accept=self._accepted).get("values")
        self._accepted = False
        size = len(self._height)
        expected = size + len(self.table.outputs)
        if (
            not isinstance(answer, list)
            or len(answer) != expected
            or not all(isinstance(v, int | float) for v in answer)
        ):
            raise FmuFailed(f"{self.where} gave no heights: {answer!s:.100}")
        self._last = answer[size:]
        heights = [scale.factor * value + scale.offset for scale, value in zip(self._height, answer, strict=False)]
        if not np.isfinite(heights).all():
            raise FmuFailed(f"{self.where} gave a height that is not a finite number")
        return np.array(heights) + self._offset

    def accept(self) -> None:
        """Keep the state after the last attempt, and its outputs."""
        self._accepted = True
        if self._last:
            self._kept.append(self._last)

    def list_outputs(self, steps: int) -> dict[str, RealArray]:
        """Values of the recorded outputs after each of the last steps, by their names, (steps,) each."""
        return dict(zip(self.table.outputs, np.array(self._kept[-steps:]).T, strict=True)) if self._kept else {}

    def restart(self) -> None:
        """Return to the first state; an FMU without state rollback is loaded again."""
        self._ask(LOAD_LIMIT, "restart")
        self._accepted = False

    def close(self) -> None:
        """End the process."""
        self._processes.close()


@contextmanager
def open_fmu(
    table: FmuTable, values: Mapping[str, float], time_step: float, offset: float = 0.0
) -> Iterator[FmuPantograph]:
    """Start an FMU that the user has named; its process ends with the block. Parameters as in `FmuPantograph`.

    Raises:
        InputError: The user has not named the FMU, or a package is missing.
    """
    if not table.is_named:
        raise InputError(
            f"FMU '{table.file}'",
            "is native code that a case file states, and is not run for that",
            "Name the pantograph file with --pantograph if you trust the code.",
        )
    require_package("fmpy", f"FMU '{table.file}'")
    pantograph = FmuPantograph(table, values, time_step, offset)
    try:
        yield pantograph
    finally:
        pantograph.close()


LARGEST_ENERGY = 0.01
"""Largest energy that a coupling may make, over the work that line and FMU exchange [-]."""


def describe_coupling(number: int, fmu: FmuPantograph, coupling: Coupling, steps: int) -> FmuRun:
    """Facts of the FMU of a pantograph and of its coupling in the steps of a passage.

    Raises:
        FmuFailed: The coupling made too much energy for any verdict.
    """
    if abs(coupling.energy) > LARGEST_ENERGY * coupling.exchanged:
        raise FmuFailed(
            f"{fmu.where}: its coupling with the line made {coupling.energy:.3g} J, more than {LARGEST_ENERGY:.0%} of"
            f" the {coupling.exchanged:.3g} J that were exchanged; halve the time step of the case"
        )
    facts, table = fmu.facts, fmu.table
    return FmuRun(
        pantograph=number,
        file=table.file,
        sha256=table.sha256 or "",
        model=f"{facts.model_name} {facts.model_version}".strip(),
        tool=facts.tool,
        interface=f"FMI {facts.fmi_version} {table.interface}",
        can_repeat=fmu.can_repeat,
        energy_J=coupling.energy,
        exchanged_J=coupling.exchanged,
        largest_difference_mm=1000 * coupling.largest_difference,
        outputs=[
            FmuOutput(name=name, unit=facts.variables[name]["unit"], lowest=values.min(), highest=values.max())
            for name, values in fmu.list_outputs(steps).items()
        ],
    )
