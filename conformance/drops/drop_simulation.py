"""Mass drops of a case on the reference simulator, as records for the identification."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import MassDrop
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.measured_table import Axis
from pantocheck.conformance.drops.decay_kernel import filter_full_overlap, low_pass_taps
from pantocheck.conformance.drops.drop_record import MOTION_ORDER, DropChannel, DropDescription, DropRecord
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.results.identified_modes import MeasuredLine
from pantocheck.conformance.runs.case_run import integrate_mass_drop
from pantocheck.model import Catenary, Kind
from pantocheck.model.dynamics.drop_values import FreeDecay, MassDropSetup

SHORT_NAME = {"contact_wire": "CW", "messenger_wire": "MW"}
STOP_BAND_DB = 90.0
PASS_BAND = 0.8
"""Upper edge of the pass band of the anti-alias filter, relative to half the rate of the record."""


@dataclass(frozen=True)
class SimulatedDrop:
    """Simulated drop."""

    record: DropRecord
    """Record of the sensors, as of a measurement."""
    decay: FreeDecay
    """Motion at every time step of the simulation."""


def simulate_drop(
    case: Case,
    number: int,
    progress: Callable[[float], None] | None = None,
    line: Catenary | None = None,
    axes: tuple[Axis, ...] = ("z",),
) -> SimulatedDrop:
    """Simulate a drop of a case.

    Args:
        case: Case with a mass drop.
        number: Number of the drop, from 1.
        progress: Function that receives the completed share of the simulation, 0 to 1.
        line: Catenary; default: that of the case.
        axes: Axes of each sensor: vertical, and lateral on a line with stagger.

    Raises:
        NoInitialState, NoEquilibrium, DidNotConverge: The simulation has no solution.
    """
    mass_drop, discretisation = require_mass_drop(case), case.file.discretisation
    drop, catenary = mass_drop.drop[number - 1], line or build_catenary(case.line)
    setup = build_drop_setup(case, number, catenary, axes)
    decay = integrate_mass_drop(catenary, discretisation.element_m, setup, progress)
    motion = decay.motion[:, :, MOTION_ORDER[mass_drop.quantity]].T
    signals = decimate(motion, round(1 / mass_drop.rate_Hz / discretisation.time_step_s))
    if mass_drop.noise_rms:
        # The noise differs between drops; it is the same in every run and under every damping model.
        seed = hashlib.sha256(f"{drop.model_dump_json()} {number}".encode()).digest()
        noise = np.random.default_rng(int.from_bytes(seed[:8], "little"))
        signals = signals + mass_drop.noise_rms * noise.standard_normal(signals.shape)
    return SimulatedDrop(_build_record(case, number, signals, axes), decay)


def build_drop_setup(case: Case, number: int, catenary: Catenary, axes: tuple[Axis, ...] = ("z",)) -> MassDropSetup:
    """Mass, release and sensors of a drop on a line; parameters as in `simulate_drop`."""
    mass_drop = require_mass_drop(case)
    drop = mass_drop.drop[number - 1]
    return MassDropSetup(
        mass=drop.mass_kg,
        wire=_first_wire(catenary, drop.wire, drop.x_m),
        position=drop.x_m,
        release_duration=drop.release_s,
        hanging=mass_drop.hanging_s,
        duration=mass_drop.record_s,
        time_step=case.file.discretisation.time_step_s,
        sensors=tuple((_first_wire(catenary, sensor.wire, sensor.x_m), sensor.x_m) for sensor in mass_drop.sensor),
        axes=axes,
    )


def require_mass_drop(case: Case) -> MassDrop:
    """Mass drop of a case.

    Raises:
        ValueError: The case has no mass drop.
    """
    if case.file.mass_drop is None:
        raise ValueError(f"case {case.id} has no mass drop")
    return case.file.mass_drop


def decimate(signals: RealArray, every: int) -> RealArray:
    """Every k-th sample of signals, (n, c), after a linear-phase low-pass without delay, (n / k, c).

    The filter passes frequencies below 0.8 of half the new rate and attenuates those above half the new rate by 90 dB.
    """
    if every == 1:
        return signals
    taps = low_pass_taps(2.0, PASS_BAND / every, 1 / every, STOP_BAND_DB)
    # The signals are extended by a straight line: the line is at rest before the start.
    line = np.linspace(signals[0], signals[-1], len(signals))
    half = taps.size // 2
    return line[::every] + filter_full_overlap(np.pad(signals - line, ((half, half), (0, 0))), taps)[::every]


def _first_wire(catenary: Catenary, kind: str, x: float) -> str:
    """First wire of a kind at a position; in an overlap it is that of the outgoing section."""
    return next(wire.name for wire in catenary.wires if wire.kind is Kind(kind) and wire.start <= x <= wire.end)


def _build_record(case: Case, number: int, signals: RealArray, axes: tuple[Axis, ...]) -> DropRecord:
    line, mass_drop = case.line, require_mass_drop(case)
    drop = mass_drop.drop[number - 1]
    return DropRecord(
        name=f"{case.id} drop {number}",
        source=case.id,
        rate=mass_drop.rate_Hz,
        signals=signals,
        channels=tuple(
            DropChannel(f"S{i}{axis}", i, axis, SHORT_NAME[sensor.wire], sensor.x_m)
            for i, sensor in enumerate(mass_drop.sensor, 1)
            for axis in axes
        ),
        quantity=mass_drop.quantity,
        drop=DropDescription(drop.mass_kg, SHORT_NAME[drop.wire], drop.x_m, mass_drop.hanging_s),
        line=describe_line(line),
    )


def describe_line(line: LineFile) -> MeasuredLine:
    """Properties of a line as a record of its drops states them."""
    return MeasuredLine(
        spans_m=line.geometry.span_lengths,
        contact_wire_tension_N=line.contact_wire.tension_N,
        messenger_wire_tension_N=line.messenger_wire.tension_N,
    )
