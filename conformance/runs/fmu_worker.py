"""Process that runs the native code of one FMU, with limits of the operating system.

It answers one JSON object per line for each that it receives; `fmu_process` is the other end. Nothing of the suite is
loaded here. The code of the FMU may do what the user of this process may do, except use more memory, processor time or
disk than the limits: it is isolated from the suite, not from the user.

| request | answer |
|---|---|
| `describe`: folder, interface, names | facts of the model description, and of the named variables of floating point |
| `start`: time step, variables, values | empty: the FMU is initialised |
| `step`: values of the inputs, whether the last step is accepted | values of the outputs |
| `restart` | empty: the state before the first step |
"""

import json
import math
import os
import re
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import IO, Any

LARGEST_MEMORY, LARGEST_FILE = 4 * 2**30, 2**28
"""Limits of address space and of a written file [bytes]."""
LONGEST_RUN_S = 3600
"""Limit of processor time [s]."""
IDENTIFIER = re.compile(r"[A-Za-z_]\w{0,200}")
"""Model identifier: name of the shared library, without a path."""
LARGEST_LIST = 500_000
"""Largest size of the facts of variables in an answer; multibody models have tens of thousands of variables."""
ATTEMPTS, TOLERANCE = 30, 1e-12
"""Iterations of a step of model exchange, and its relative accuracy."""


def _limit_resources() -> None:
    """Set the limits of this process; Windows has none of them."""
    with suppress(ImportError):
        import resource

        limits = {"AS": LARGEST_MEMORY, "FSIZE": LARGEST_FILE, "CPU": LONGEST_RUN_S, "CORE": 0}
        for name, value in limits.items():
            number = getattr(resource, f"RLIMIT_{name}")
            hard = resource.getrlimit(number)[1]
            largest = value if hard == resource.RLIM_INFINITY else min(value, hard)
            resource.setrlimit(number, (largest, largest))


class CoSimulation:
    """Instance that integrates itself."""

    kind = "CoSimulation"

    def __init__(self, unit: Any, major: int, step: float) -> None:
        self.unit, self.major, self.step, self.time = unit, major, step, 0.0

    def advance(self) -> None:
        """Step of the instance from the current time."""
        if self.major == 2:
            self.unit.doStep(self.time, self.step)
            return
        _, ended, early, reached = self.unit.doStep(self.time, self.step)
        if ended or early:
            raise RuntimeError(f"fmi3DoStep ended at {reached:g} s, before the end of the step")

    def complete(self) -> None:
        """End of an accepted step."""
        self.time += self.step

    def mark(self) -> Any:
        """Time of the instance, beside its FMU state."""
        return self.time

    def reset(self, mark: Any) -> None:
        """Return to a marked time."""
        self.time = mark


class ModelExchange(CoSimulation):
    """Instance that gives derivatives, integrated by the midpoint rule; events act at the end of their step."""

    kind = "ModelExchange"

    def __init__(self, unit: Any, major: int, step: float, states: int, indicators: int) -> None:
        super().__init__(unit, major, step)
        import numpy

        self.numpy, self.states, self.indicators = numpy, states, indicators
        self.derivatives = unit.getDerivatives if major == 2 else unit.getContinuousStateDerivatives
        self._handle_events()
        self.jacobian: Any = None
        self.signs = self._indicator_signs()

    def _vector(self, read: Callable[..., Any], size: int) -> Any:
        import ctypes

        values = (ctypes.c_double * size)()
        read(values, size)
        return self.numpy.array(values)

    def _place(self, time: float, state: Any) -> None:
        import ctypes

        self.unit.setTime(time)
        if self.states:
            self.unit.setContinuousStates((ctypes.c_double * self.states)(*state), self.states)

    def _slope(self, state: Any) -> Any:
        """Derivatives of the states in the middle of the step."""
        self._place(self.time + self.step / 2, state)
        return self._vector(self.derivatives, self.states)

    def _indicator_signs(self) -> list[bool]:
        return (self._vector(self.unit.getEventIndicators, self.indicators) > 0).tolist() if self.indicators else []

    def _handle_events(self) -> None:
        """Event iteration, then continuous time; the instance is in event mode."""
        while (self.unit.newDiscreteStates() if self.major == 2 else self._update_discrete_states())[0]:
            pass
        self.unit.enterContinuousTimeMode()

    def _update_discrete_states(self) -> Any:
        from ctypes import byref

        from fmpy.fmi3 import fmi3Boolean, fmi3Float64

        flags = [fmi3Boolean() for _ in range(5)]
        self.unit.fmi3UpdateDiscreteStates(self.unit.component, *map(byref, flags), byref(fmi3Float64()))
        return [flag.value for flag in flags]

    def advance(self) -> None:
        """Step by the midpoint rule, solved by Newton's method with a kept Jacobian."""
        numpy, h = self.numpy, self.step
        start = self._vector(self.unit.getContinuousStates, self.states)
        if self.jacobian is None:
            slope, columns = self._slope(start), []
            for k in range(self.states):
                change = numpy.zeros(self.states)
                change[k] = 1e-6 * max(1.0, abs(start[k]))
                columns.append((self._slope(start + change) - slope) / change[k])
            self.jacobian = numpy.array(columns).T.reshape(self.states, self.states)
        matrix, end = numpy.eye(self.states) - h / 2 * self.jacobian, start.copy()
        attempts, change = 0, numpy.full(self.states, numpy.inf)
        while numpy.abs(change).max(initial=0.0) > TOLERANCE * max(1.0, numpy.abs(end).max(initial=0.0)):
            attempts += 1
            change = numpy.linalg.solve(matrix, start + h * self._slope((start + end) / 2) - end)
            end = end + change
            if attempts > ATTEMPTS or not numpy.isfinite(end).all():
                raise RuntimeError("the midpoint rule did not converge")
        if attempts > 5:
            self.jacobian = None
        self._place(self.time + h, end)

    def complete(self) -> None:
        """End of an accepted step, with the events that it has met."""
        super().complete()
        needed, ended = self.unit.completedIntegratorStep()
        if ended:
            raise RuntimeError("the instance has ended the simulation")
        signs = self._indicator_signs()
        if needed or signs != self.signs:
            self.unit.enterEventMode()
            self._handle_events()
            self.signs = self._indicator_signs()

    def mark(self) -> Any:
        """Time and continuous states."""
        return self.time, self._vector(self.unit.getContinuousStates, self.states)

    def reset(self, mark: Any) -> None:
        """Return to marked continuous states."""
        self.time = mark[0]
        self._place(*mark)


class Session:
    """Loaded FMU."""

    def describe(self, folder: str, interface: str, names: list[str]) -> dict[str, Any]:
        """Read the model description; of many variables, those with the names are listed, and the first others."""
        from fmpy.model_description import read_model_description

        self.folder = folder
        described = self.described = read_model_description(folder, validate=True)
        if not str(described.fmiVersion).startswith(("2.", "3.")):
            raise RuntimeError(f"FMI {described.fmiVersion} found, FMI 2.0 or 3.0 expected")
        self.kind = "CoSimulation" if interface == "co-simulation" else "ModelExchange"
        found = self.part = described.coSimulation if interface == "co-simulation" else described.modelExchange
        if found is None:
            raise RuntimeError(f"the FMU has no {interface}")
        if not IDENTIFIER.fullmatch(found.modelIdentifier or ""):
            raise RuntimeError(f"the model identifier {found.modelIdentifier!r} is not a valid name")
        self.major = int(described.fmiVersion[0])
        return {
            "fmi_version": described.fmiVersion,
            "model_name": described.modelName,
            "tool": described.generationTool or "",
            "model_version": described.version or "",
            "has_state": self._has_state,
            "variables": self._list_variables(set(names)),
        }

    def _list_variables(self, names: set[str]) -> dict[str, dict[str, Any]]:
        units = {unit.name: unit for unit in self.described.unitDefinitions}
        real = (variable for variable in self.described.modelVariables if str(variable.type) in ("Real", "Float64"))
        listed, size = {}, 0
        for variable in sorted(real, key=lambda variable: variable.name not in names):
            unit = variable.unit or getattr(variable.declaredType, "unit", None) or ""
            base = self._describe_unit(units.get(unit))
            facts = {"causality": str(variable.causality), "unit": unit, "base": base}
            size += len(variable.name) + len(json.dumps(facts))
            if size > LARGEST_LIST:
                break
            listed[variable.name] = facts
        return listed

    @property
    def _has_state(self) -> bool:
        return bool(getattr(self.part, "canGetAndSetFMUstate", False))

    @staticmethod
    def _describe_unit(unit: Any) -> dict[str, float] | None:
        """Factor, offset and exponents of a unit over SI base units."""
        base = getattr(unit, "baseUnit", None)
        names = ("factor", "offset", "kg", "m", "s", "A", "K", "mol", "cd", "rad")
        return None if base is None else {name: float(getattr(base, name)) for name in names}

    def start(self, step: float, inputs: list[str], outputs: list[str], values: dict[str, float]) -> dict[str, Any]:
        """Instantiate and initialise the FMU."""
        from fmpy.simulation import instantiate_fmu

        self.arguments = step, inputs, outputs, values
        variables = {variable.name: variable for variable in self.described.modelVariables}
        numbers = {name: variable.valueReference for name, variable in variables.items()}
        self.inputs, self.outputs = ([numbers[name] for name in names] for names in (inputs, outputs))
        unit = self.unit = instantiate_fmu(self.folder, self.described, self.kind)
        self.read, self.write = (unit.getReal, unit.setReal) if self.major == 2 else (unit.getFloat64, unit.setFloat64)
        fixed = {name: value for name, value in values.items() if str(variables[name].causality) != "input"}
        self.write([numbers[name] for name in fixed], list(fixed.values()))
        if self.major == 2:
            unit.setupExperiment(startTime=0.0)
        unit.enterInitializationMode()
        varied = {name: value for name, value in values.items() if name not in fixed}
        self.write([numbers[name] for name in varied], list(varied.values()))
        unit.exitInitializationMode()
        if self.kind == "CoSimulation":
            self.instance: CoSimulation = CoSimulation(unit, self.major, step)
        else:
            sizes = self.described.numberOfContinuousStates, self.described.numberOfEventIndicators
            if self.major == 3:
                sizes = unit.getNumberOfContinuousStates(), unit.getNumberOfEventIndicators()
            self.instance = ModelExchange(unit, self.major, step, *sizes)
        self.first = self._keep()
        self.kept = self._keep()
        return {}

    @property
    def _can_repeat(self) -> bool:
        return self._has_state or self.kind == "ModelExchange"

    def _keep(self) -> Any:
        """State of the instance, and its mark."""
        return (self.unit.getFMUState() if self._has_state else None), self.instance.mark()

    def _return(self, kept: Any) -> None:
        if kept[0] is not None:
            self.unit.setFMUState(kept[0])
        self.instance.reset(kept[1])

    def step(self, values: list[float], accept: bool) -> dict[str, Any]:
        """One step under held inputs, from the end of the last one if that is accepted, else from its start."""
        if accept:
            self.instance.complete()
            if self._can_repeat:
                self._free(self.kept)
                self.kept = self._keep()
        elif self._can_repeat:
            self._return(self.kept)
        self.write(self.inputs, values)
        self.instance.advance()
        outputs = self.read(self.outputs)
        if not all(map(math.isfinite, outputs)):
            raise RuntimeError(f"the outputs are {outputs}, and must be finite numbers")
        return {"values": outputs}

    def _free(self, kept: Any) -> None:
        if kept[0] is not None:
            (self.unit.freeFMUstate if self.major == 2 else self.unit.freeFMUState)(kept[0])

    def restart(self) -> dict[str, Any]:
        """Return to the state before the first step; without state rollback, load the FMU again."""
        if not self._has_state:
            self.unit.terminate()
            self.unit.freeInstance()
            return self.start(*self.arguments)
        self._return(self.first)
        self._free(self.kept)
        self.kept = self._keep()
        return {}


def _answer(lines: IO[str], channel: IO[str]) -> None:
    """Answer requests until the input ends; a failure ends the process."""
    session = Session()
    actions: dict[str, Callable[..., dict[str, Any]]] = {
        "describe": session.describe,
        "start": session.start,
        "step": session.step,
        "restart": session.restart,
    }
    for line in lines:
        request = json.loads(line)
        try:
            answer = actions[request.pop("request")](**request)
            text = json.dumps(answer, allow_nan=False)
        except Exception as error:
            reason = " ".join(f"{error}".split())[:500] or type(error).__name__
            print(json.dumps({"failure": reason}), file=channel, flush=True)
            break
        print(text, file=channel, flush=True)
    # An FMU that does not unload must not delay the end.
    os._exit(0)


if __name__ == "__main__":
    # What the FMU prints must not reach the channel of the answers.
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as channel:
        os.dup2(2, 1)
        _limit_resources()
        _answer(sys.stdin, channel)
