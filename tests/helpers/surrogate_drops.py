"""Records of mass drops in the field, by superposition of modes: a cheap surrogate of the full simulation.

The modes of a line are driven by the release of a weight and, if there is wind, by an independent random force on each
mode below 3 Hz, before and after the release. Sensors add noise, white or coloured, and may have clocks of their own.
The line is linear: droppers that slacken are the subject of the full simulation.
"""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from pantocheck.conformance.cases.library import library_folder
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.results.identified_modes import MeasuredLine
from pantocheck.model import Kind, Rayleigh, discretise
from pantocheck.model.modal.modes import compute_modes_below, damping_ratios, deflection_at

Real = NDArray[np.float64]
LINES = {
    "six spans, 20 and 15 kN": (1.0, 1.0, (63.0, 63.0, 58.5, 63.0, 54.0, 63.0), (0.055, 5e-5, 0.075, 8e-5)),
    "six spans, 27 and 21 kN": (1.35, 1.4, (54.0, 63.0, 58.5, 63.0, 54.0, 58.5), (0.04, 8e-5, 0.06, 5e-5)),
    "five spans, 15 and 12 kN": (0.75, 0.8, (63.0, 54.0, 58.5, 54.0, 63.0), (0.08, 4e-5, 0.05, 9e-5)),
}
"""Factors of the tensions of both wires, spans [m], and coefficients of mass [1/s] and stiffness [s] of each."""
RATE, REST, RUN_UP, GRAVITY = 100.0, 10.0, 240.0, 9.80665
HIGHEST = 14.0
"""Highest frequency of a mode [Hz]."""


@dataclass(frozen=True)
class Disturbance:
    """Deviation of a record from white noise on one clock."""

    wind: float = 0.0
    """RMS of the ambient motion in the band from 0.6 to 7.6 Hz over the noise of the sensors [-]."""
    coloured: float = 0.0
    """RMS of further noise that falls as 1/f above 1 Hz, over the white noise [-]."""
    clock: float = 0.0
    """Standard deviation of the rates of the clocks [-]; their starts differ by up to 20 ms."""


@dataclass(frozen=True)
class LineModes:
    """Modes of one line: true frequencies [Hz], damping ratios, and shapes at the possible places of sensors."""

    line: MeasuredLine
    frequency: Real
    ratio: Real
    places: tuple[tuple[str, float], ...]
    shape: Real
    """(places, modes) [kg^-1/2]."""


@dataclass(frozen=True)
class FieldRecord:
    """Record, and the frequencies [Hz] and damping ratios of all its modes."""

    record: DropRecord
    frequency: Real
    ratio: Real


def build_line_modes(name: str, scatter: tuple[float, float] = (0.0, 0.0)) -> LineModes:
    """Modes of a line whose tensions of contact and messenger wire are off by a relative scatter."""
    contact, messenger, spans, (b_cw, a_cw, b_mw, a_mw) = LINES[name]
    file = read_model(library_folder() / "mass-drop-line" / "line.toml", LineFile, "line")
    schedules = {58.5: "58.5 m", 54.0: "54 m", 63.0: None}
    row = type(file.geometry.span_list[0])
    listed = tuple(row(length_m=span, droppers=schedules[span]) for span in spans)
    stated = (file.contact_wire.tension_N * contact, file.messenger_wire.tension_N * messenger)
    wires = {
        key: getattr(file, key).model_copy(update={"tension_N": tension * (1 + error)})
        for key, tension, error in zip(("contact_wire", "messenger_wire"), stated, scatter, strict=True)
    }
    geometry = file.geometry.model_copy(update={"span_list": listed})
    catenary = build_catenary(file.model_copy(update={**wires, "geometry": geometry}))
    damping = {Kind.CONTACT_WIRE: Rayleigh(b_cw, a_cw), Kind.MESSENGER_WIRE: Rayleigh(b_mw, a_mw)}
    catenary = type(catenary)(**{**catenary.__dict__, "damping": {**catenary.damping, **damping}})
    stations = tuple(float(x) for x in np.arange(2.25, sum(spans), 2.25))
    mesh = discretise(catenary, 1.5, stations)
    modes = compute_modes_below(mesh, HIGHEST)
    ratio = damping_ratios(mesh, modes)
    places, shape = [], []
    for kind, short in ((Kind.CONTACT_WIRE, "CW"), (Kind.MESSENGER_WIRE, "MW")):
        for x in stations:
            wire = next((w for w in catenary.wires if w.kind is kind and w.start <= x <= w.end), None)
            if wire is not None:
                places.append((short, x))
                shape.append(deflection_at(mesh, modes, mesh.mesh.row_of[wire.name, "z"], x))
    table = np.array(shape)
    vertical = np.abs(table).max(axis=0) > 1e-3
    line = MeasuredLine(spans_m=spans, contact_wire_tension_N=stated[0], messenger_wire_tension_N=stated[1])
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
    ambient = np.zeros((modes.frequency.size, n))
    if disturbance.wind:
        ambient = _ambient_motion(modes, rng, n)
        ambient *= noise * disturbance.wind / _band_rms((shape @ ambient).T)
    signals = np.empty((n, sensors))
    poles = omega * (-modes.ratio + 1j * np.sqrt(1 - modes.ratio**2))
    for s in range(sensors):
        t = np.arange(n) / RATE * (1 + rates[s]) + starts[s]
        after = t >= release
        # Free decay from the static deflection under the weight: acceleration phi_s phi_d m g at the release.
        start = -mass * GRAVITY * modes.shape[drop] * shape[s] / omega**2
        free = np.zeros(n)
        residue = start * poles.conj() / (poles.conj() - poles) * poles**2
        free[after] = 2 * (np.exp(np.outer(t[after] - release, poles)) @ residue).real
        wind = np.interp(t, np.arange(n) / RATE, shape[s] @ ambient) if rates[s] or starts[s] else shape[s] @ ambient
        signals[:, s] = free + wind
    signals += noise * rng.standard_normal(signals.shape)
    if disturbance.coloured:
        signals += noise * disturbance.coloured * _coloured_noise(rng, n, sensors)
    channels = tuple(DropChannel(f"S{i}_z", i, "z", *modes.places[place]) for i, place in enumerate(drawn, 1))
    wire, x = modes.places[drop]
    record = DropRecord(
        "surrogate", "surrogate", RATE, signals, channels, drop=DropDescription(mass, wire, x, REST), line=modes.line
    )
    return FieldRecord(record, modes.frequency, modes.ratio)


def _ambient_motion(modes: LineModes, rng: np.random.Generator, n: int) -> Real:
    """Acceleration of the modal coordinates under independent forces below 3 Hz, stationary, (m, n)."""
    total = n + int(RUN_UP * RATE)
    low = scipy.signal.butter(1, 3.0, fs=RATE)
    rows = []
    for omega, ratio in zip(2 * np.pi * modes.frequency, modes.ratio, strict=True):
        b, a = scipy.signal.bilinear([1, 0, 0], [1, 2 * ratio * omega, omega**2], RATE)
        # The bilinear map moves the resonance: the pole of the recursion is that of the mode.
        q = np.exp((-ratio + 1j * np.sqrt(1 - ratio**2)) * omega / RATE)
        a = np.array([1.0, -2 * q.real, abs(q) ** 2])
        force = scipy.signal.lfilter(*low, rng.standard_normal(total))
        rows.append(scipy.signal.lfilter(b, a, force)[-n:])
    return np.array(rows)


def _band_rms(signals: Real) -> float:
    sections = scipy.signal.butter(4, [0.6, 7.6], "band", fs=RATE, output="sos")
    return float(np.sqrt(np.mean(scipy.signal.sosfiltfilt(sections, signals, axis=0) ** 2)))


def _coloured_noise(rng: np.random.Generator, n: int, channels: int) -> Real:
    spectrum = np.fft.rfft(rng.standard_normal((n, channels)), axis=0)
    spectrum /= np.sqrt(1 + np.fft.rfftfreq(n, 1 / RATE)[:, None] ** 2)
    noise = np.fft.irfft(spectrum, n, axis=0)
    return np.asarray(noise / noise.std(axis=0))
