"""Mass drops simulated on a line of three unequal spans, as records with known damping, release and noise."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from helpers.static_records import read_unequal_line
from pantocheck.conformance.comparison.drop_comparison import DampingChoice, DropTask
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.drop_simulation import decimate, describe_line
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.damping import Damping
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model.dynamics.drop_values import MassDropSetup
from pantocheck.model.dynamics.mass_drop import simulate_mass_drop

ELEMENT, TIME_STEP = 2.25, 1e-3
RATE, EVERY = 200.0, 5
RELEASE = 3.001
"""Release in the time of the records [s]: between two samples."""
DURATION = 11.0
WINDOWS = ((0.0, 4.0), (6.0, 9.0))
SENSORS = (("CW", 81.0), ("MW", 99.0))
MASS, PLACE = 30.0, 94.5
WIRES = {"CW": "contact wire", "MW": "messenger wire"}


@cache
def read_short_line() -> LineFile:
    """First three spans of the unequal line, 63 m, 63 m and 58.5 m."""
    return read_unequal_line().shorten(3)


def damp_masses(coefficient: float) -> Damping:
    """Damping proportional to all masses: every mode decays with exp(-coefficient t / 2)."""
    table = {"mass_coefficient_1_s": coefficient}
    return Damping.model_validate(dict.fromkeys(("contact_wire", "messenger_wire", "droppers", "steady_arms"), table))


@cache
def _simulate_signals(coefficient: float, order: int) -> NDArray[np.float64]:
    """Motion of the sensors at the rate of the record; the release lies between two samples."""
    line = read_short_line().model_copy(update={"damping": damp_masses(coefficient)})
    step = 1 / (RATE * EVERY)
    # The first sample is one step after the start.
    sensors = tuple((WIRES[wire], x) for wire, x in SENSORS)
    test = MassDropSetup(MASS, "contact wire", PLACE, 0.0, RELEASE + step, DURATION, step, sensors)
    motion = simulate_mass_drop(build_catenary(line), ELEMENT, test).motion[:, :, order].T
    return decimate(motion - motion[0], EVERY)


def record_drop(
    coefficient: float = 0.1, noise: float = 1e-3, quantity: str = "acceleration", **changes: Any
) -> DropRecord:
    """Record of a drop under a mass coefficient [1/s], with white noise; `changes` replace fields of the record."""
    signals = _simulate_signals(coefficient, ("displacement", "velocity", "acceleration").index(quantity))
    line = read_short_line()
    record = DropRecord(
        name="drop",
        source="drop.h5",
        rate=RATE,
        signals=signals + noise * np.random.default_rng(1).standard_normal(signals.shape),
        channels=tuple(DropChannel(f"S{i}_z", i, "z", wire, x) for i, (wire, x) in enumerate(SENSORS, 1)),
        quantity=quantity,  # type: ignore[arg-type]
        drop=DropDescription(MASS, "CW", PLACE, RELEASE),
        line=describe_line(line),
    )
    return replace(record, **changes)


def build_task(*coefficients: float, **changes: Any) -> DropTask:
    """Comparison with the mass coefficients of some models [1/s], named after them."""
    models = {f"b{coefficient:g}": DampingChoice("made", damp_masses(coefficient)) for coefficient in coefficients}
    task = DropTask(read_short_line(), models, WINDOWS, ELEMENT, TIME_STEP, 0.0)
    return replace(task, **changes)
