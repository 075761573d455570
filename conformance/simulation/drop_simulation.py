"""Mass drops of a case on the reference simulator, as records that the identification reads."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.signal import firwin, kaiserord, resample_poly

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.drop_test import DropTest, MassDrop
from pantocheck.conformance.mass_drops.drop_record import DropChannel, DropRecord
from pantocheck.conformance.mass_drops.drop_record import DropDescription as DropFacts
from pantocheck.conformance.mass_drops.drop_record import DropLine as LineFacts
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.model import Catenary, Kind
from pantocheck.model.dynamics.mass_drop import FreeDecay, MassDropSetup, simulate_mass_drop

SHORT_NAME = {"contact_wire": "CW", "messenger_wire": "MW"}
ORDER = {"displacement": 0, "velocity": 1, "acceleration": 2}
STOP_BAND_DB = 90.0
PASS_BAND = 0.8
"""Share of half the record's rate that the anti-alias filter passes unchanged."""


@dataclass(frozen=True)
class SimulatedDrop:
    """A simulated drop.

    Parameters
    ----------
    record : DropRecord
        As a measuring team would have it.
    decay : FreeDecay
        As the simulator has it, at every time step.
    """

    record: DropRecord
    decay: FreeDecay


def simulate_drop(
    case: Case, number: int, progress: Callable[[float], None] | None = None, line: Catenary | None = None
) -> SimulatedDrop:
    """Simulate one drop of a case.

    Parameters
    ----------
    case : Case
        With a mass drop.
    number : int
        Of the drop, from 1.
    progress : Callable[[float], None] or None
        Called now and then with the share done, 0 to 1.
    line : Catenary or None
        In place of the case's own.

    Raises
    ------
    NoInitialState, NoEquilibrium, DidNotConverge
        The simulation has no solution.
    """
    told, steps = require_mass_drop(case), case.file.discretisation
    test, own = told.drop[number - 1], line or build_catenary(case.line)
    decay = simulate_mass_drop(
        own,
        steps.element_m,
        MassDropSetup(
            mass=test.mass_kg,
            wire=_wire(own, test.wire),
            position=test.x_m,
            release_duration=test.release_s,
            hanging=told.hanging_s,
            duration=told.record_s,
            time_step=steps.time_step_s,
            sensors=tuple((_wire(own, sensor.wire), sensor.x_m) for sensor in told.sensor),
        ),
        progress,
    )
    motion = decay.motion[:, :, ORDER[told.quantity]].T
    signals = decimate(motion, round(1 / told.rate_Hz / steps.time_step_s))
    if told.noise_rms:
        signals = signals + told.noise_rms * _generator(test, number).standard_normal(signals.shape)
    return SimulatedDrop(_record(case, told, test, number, signals), decay)


def require_mass_drop(case: Case) -> MassDrop:
    """The mass drop of a case that has one.

    Raises
    ------
    ValueError
        It has none.
    """
    if case.file.mass_drop is None:
        raise ValueError(f"case {case.id} has no mass drop")
    return case.file.mass_drop


def decimate(signals: RealArray, every: int) -> RealArray:
    """Every k-th sample after a linear-phase low-pass whose delay is taken out.

    Passes frequencies below 0.8 of half the new rate, and lowers all above half of it by 90 dB.

    Parameters
    ----------
    signals : ndarray
        (n, c).
    every : int
        k.
    """
    if every == 1:
        return signals
    length, beta = kaiserord(STOP_BAND_DB, (1 - PASS_BAND) / every)
    taps = firwin(length | 1, (1 + PASS_BAND) / 2 / every, window=("kaiser", beta))
    # Before its beginning the line hangs still; after its end the record goes on as it was going.
    return np.asarray(resample_poly(signals, 1, every, axis=0, window=taps, padtype="line"))


def _wire(line: Catenary, name: str) -> str:
    """The first wire of a kind."""
    return next(wire.name for wire in line.wires if wire.kind is Kind(name))


def _generator(test: DropTest, number: int) -> np.random.Generator:
    """Noise of its own for every drop, the same each time and under every damping model."""
    seed = hashlib.sha256(f"{test.model_dump_json()} {number}".encode()).digest()
    return np.random.default_rng(int.from_bytes(seed[:8], "little"))


def _record(case: Case, told: MassDrop, test: DropTest, number: int, signals: RealArray) -> DropRecord:
    line = case.line
    return DropRecord(
        name=f"{case.id} drop {number}",
        source=case.id,
        rate=told.rate_Hz,
        signals=signals,
        channels=tuple(
            DropChannel(f"S{i}z", i, "z", SHORT_NAME[sensor.wire], sensor.x_m)
            for i, sensor in enumerate(told.sensor, 1)
        ),
        quantity=told.quantity,
        drop=DropFacts(test.mass_kg, SHORT_NAME[test.wire], test.x_m, told.hanging_s),
        line=LineFacts(line.geometry.span_lengths, line.contact_wire.tension_N, line.messenger_wire.tension_N),
    )
