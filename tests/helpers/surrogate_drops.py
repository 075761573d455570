"""Records of mass drops in the field, by superposition of modes: a cheap surrogate of the full simulation.

The modes of a line are driven by the release of a weight and, if there is wind, by an independent random force on each
mode below 3 Hz, before and after the release. Sensors add noise, white or coloured, and may have clocks of their own.
The line is linear: droppers that slacken are the subject of the full simulation.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.units import STANDARD_GRAVITY
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.results.identified_modes import MeasuredLine
from pantocheck.model import Kind, discretise
from pantocheck.model.modal.modes import compute_modes_below, damping_ratios, deflection_at
from verification.tables.field_records import (
    PLACES,
    RATE,
    REST,
    Disturbance,
    build_stated_line,
    make_coloured_noise,
    move_by_wind,
)

ELEMENT = 1.5
"""Length of the elements [m]."""
HIGHEST = 14.0
"""Highest frequency of a mode [Hz]."""


@dataclass(frozen=True)
class LineModes:
    """Modes of one line: true frequencies [Hz], damping ratios, and shapes at the possible places of sensors."""

    line: MeasuredLine
    frequency: RealArray
    ratio: RealArray
    places: tuple[tuple[str, float], ...]
    shape: RealArray
    """(places, modes) [kg^-1/2]."""


@dataclass(frozen=True)
class FieldRecord:
    """Record, and the frequencies [Hz] and damping ratios of all its modes."""

    record: DropRecord
    frequency: RealArray
    ratio: RealArray


@cache
def build_line_modes(name: str) -> LineModes:
    """Modes of a line of `field_records.LINES`."""
    catenary, line = build_stated_line(name)
    stations = tuple(np.arange(PLACES, sum(line.spans_m), PLACES).tolist())
    mesh = discretise(catenary, ELEMENT, stations)
    modes = compute_modes_below(mesh, HIGHEST)
    places, shape = [], []
    for short, kind in (("CW", Kind.CONTACT_WIRE), ("MW", Kind.MESSENGER_WIRE)):
        for x in stations:
            wire = next((w for w in catenary.wires if w.kind is kind and w.start <= x <= w.end), None)
            if wire is not None:
                places.append((short, x))
                shape.append(deflection_at(mesh, modes, mesh.mesh.row_of[wire.name, "z"], x))
    table = np.array(shape)
    vertical = np.abs(table).max(axis=0) > 1e-3
    ratio = damping_ratios(mesh, modes)
    return LineModes(line, modes.frequency[vertical], ratio[vertical], tuple(places), table[:, vertical])


def make_record(
    modes: LineModes,
    rng: np.random.Generator,
    disturbance: Disturbance,
    sensors: int = 4,
    minutes: float = 2.0,
    mass: float = 40.0,
    noise: float = 0.003,
) -> FieldRecord:
    """Record of one drop; the places of the mass and of the sensors are drawn."""
    wires = [[i for i, (wire, _) in enumerate(modes.places) if wire == short] for short in ("CW", "MW")]
    drawn = [int(rng.choice(wires[number % 2 if number < 2 else 0])) for number in range(sensors)]
    drop = int(rng.choice(wires[0]))
    release = REST + rng.uniform(-0.3, 0.3)
    n = int((REST + 60 * minutes) * RATE)
    omega = 2 * np.pi * modes.frequency
    shape = modes.shape[drawn]
    rates = np.concatenate([[0.0], disturbance.clock * rng.standard_normal(sensors - 1)])
    starts = np.concatenate([[0.0], rng.uniform(-0.02, 0.02, sensors - 1)]) * (disturbance.clock > 0)
    signals = np.empty((n, sensors))
    poles = omega * (-modes.ratio + 1j * np.sqrt(1 - modes.ratio**2))
    ambient = np.zeros((n, sensors))
    if disturbance.wind:
        ambient, _ = move_by_wind(poles, shape, rng, n, noise * disturbance.wind)
    for s in range(sensors):
        t = np.arange(n) / RATE * (1 + rates[s]) + starts[s]
        after = t >= release
        # Free decay from the static deflection under the weight: acceleration phi_s phi_d m g at the release.
        start = -mass * STANDARD_GRAVITY * modes.shape[drop] * shape[s] / omega**2
        free = np.zeros(n)
        residue = start * poles.conj() / (poles.conj() - poles) * poles**2
        free[after] = 2 * (np.exp(np.outer(t[after] - release, poles)) @ residue).real
        signals[:, s] = free + np.interp(t, np.arange(n) / RATE, ambient[:, s])
    signals += noise * rng.standard_normal(signals.shape)
    if disturbance.coloured:
        signals += make_coloured_noise(rng, n, sensors, noise * disturbance.coloured)
    channels = tuple(DropChannel(f"S{i}_z", i, "z", *modes.places[place]) for i, place in enumerate(drawn, 1))
    wire, x = modes.places[drop]
    record = DropRecord(
        "surrogate", "surrogate", RATE, signals, channels, drop=DropDescription(mass, wire, x, REST), line=modes.line
    )
    return FieldRecord(record, modes.frequency, modes.ratio)
