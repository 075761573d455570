"""Records of mass drops in the field, with known poles.

The reference simulator releases a mass; droppers slacken under it and after the release. If there is wind, each mode
also has an independent random force below 3 Hz, before and after the release. Sensors add noise, white or coloured, and
may have clocks of their own. The tensions of the line differ from those that it states.

The true poles are the eigenvalues of the equations of motion with every dropper taut, in the discrete time of the
simulator: mass with the correction of `model/fem/mass_correction.py`, and s = (2 / dt) artanh(lambda dt / 2) for the
average acceleration. They include the coupling of the modes by the damping.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.drop_simulation import decimate, describe_line
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_parameters import MECHANICAL, scale_line
from pantocheck.conformance.results.identified_modes import MeasuredLine
from pantocheck.conformance.runs.case_run import integrate_mass_drop
from pantocheck.model import Catenary, DiscretisedLine, Kind, Modes, Rayleigh, discretise
from pantocheck.model.dynamics.drop_values import MassDropSetup
from pantocheck.model.fem.mass_correction import mass_correction
from pantocheck.model.modal.modes import compute_modes_below, deflection_at, free_vectors
from pantocheck.model.statics.assembly import assemble_matrices

LINES = {
    "six spans, 20 and 15 kN": (1.0, 1.0, (63.0, 63.0, 58.5, 63.0, 54.0, 63.0), (0.055, 5e-5, 0.075, 8e-5)),
    "six spans, 27 and 21 kN": (1.35, 1.4, (54.0, 63.0, 58.5, 63.0, 54.0, 58.5), (0.04, 8e-5, 0.06, 5e-5)),
    "five spans, 15 and 12 kN": (0.75, 0.8, (63.0, 54.0, 58.5, 54.0, 63.0), (0.08, 4e-5, 0.05, 9e-5)),
}
"""Factors of the tensions of both wires, spans [m], and coefficients of mass [1/s] and stiffness [s] of each."""
WIRES = {"CW": "contact wire", "MW": "messenger wire"}
"""Names of the wires in a record and in the model."""
RATE, REST, RUN_UP = 100.0, 10.0, 240.0
"""Samples per second; rest before the release, and ambient motion before the record [s]."""
ELEMENT, STEP, PLACES = 0.75, 0.002, 2.25
"""Length of the elements [m], time step [s], and distance of the possible places of mass and sensors [m]."""
HIGHEST = 10.0
"""Highest frequency of a mode [Hz]."""
WIND_CORNER = 3.0
"""Corner of the random forces [Hz]."""


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
class Layout:
    """Places of mass and sensors, and length of a record."""

    mass: float
    """Mass [kg]."""
    drop: tuple[str, float]
    sensors: tuple[tuple[str, float], ...]
    """Wire and position of mass and sensors [-, m]; the first two sensors are on different wires."""
    minutes: float
    """Length after the release [min]."""


@dataclass(frozen=True)
class BuiltLine:
    """Line with the tensions that it has, and with those that it states."""

    stated: Catenary
    description: MeasuredLine
    """Line as its records state it."""
    mesh: DiscretisedLine
    """Line as it is, with stations at mass and sensors."""
    modes: Modes
    poles: ComplexArray
    """Poles of the taut line, one for each mode, (m,) [1/s]."""


@dataclass(frozen=True)
class FieldRecord:
    """Record with its truth."""

    record: DropRecord
    line: BuiltLine
    decay: RealArray
    """Motion by the drop alone, on the clock of the first sensor, (n, c) [m/s2]."""
    taut: float
    """Time after which no dropper is slack, in the time of the record [s]."""
    noise: float
    """Standard deviation of the white noise [m/s2]."""
    coloured: float
    """That of the coloured noise [m/s2]."""
    ambient: RealArray
    """Standard deviation of the acceleration by the force on each mode per sample, far above its resonance, (m,)."""
    shape: RealArray
    """Deflection of the modes at the sensors, (c, m) [kg^-1/2]."""


def draw_layout(random: np.random.Generator, name: str, sensors: int, mass: tuple[float, float]) -> Layout:
    """Layout on a line, with a mass between two bounds [kg] and 2 to 4 minutes."""
    places = np.arange(PLACES, sum(LINES[name][2]), PLACES)
    wires = ["CW", "MW", *("CW",) * (sensors - 2)]
    chosen = random.choice(places, sensors + 1, replace=False).tolist()
    return Layout(
        float(random.uniform(*mass)),
        ("CW", chosen[-1]),
        tuple(zip(wires, chosen[:-1], strict=True)),
        float(random.uniform(2.0, 4.0)),
    )


def build_line(name: str, factors: tuple[float, float], places: tuple[float, ...]) -> BuiltLine:
    """Line whose tensions of contact and messenger wire are the stated ones times factors, with stations [m]."""
    stated, description = build_stated_line(name)
    mesh = discretise(scale_line(stated, MECHANICAL[:2], factors), ELEMENT, places)
    modes = compute_modes_below(mesh, HIGHEST)
    return BuiltLine(stated, description, mesh, modes, compute_poles(mesh, modes))


def build_stated_line(name: str) -> tuple[Catenary, MeasuredLine]:
    """Line of `LINES` with the stated tensions, and its description in a record."""
    contact, messenger, spans, (b_cw, a_cw, b_mw, a_mw) = LINES[name]
    file = read_model(library_folder() / "mass-drop-line" / "line.toml", LineFile, "line")
    schedules = {58.5: "58.5 m", 54.0: "54 m", 63.0: None}
    row = type(file.geometry.span_list[0])
    geometry = {"span_list": tuple(row(length_m=span, droppers=schedules[span]) for span in spans)}
    wires = {
        key: getattr(file, key).model_copy(update={"tension_N": getattr(file, key).tension_N * factor})
        for key, factor in (("contact_wire", contact), ("messenger_wire", messenger))
    }
    file = file.model_copy(update={**wires, "geometry": file.geometry.model_copy(update=geometry)})
    stated = build_catenary(file)
    damping = {Kind.CONTACT_WIRE: Rayleigh(b_cw, a_cw), Kind.MESSENGER_WIRE: Rayleigh(b_mw, a_mw)}
    return replace(stated, damping={**stated.damping, **damping}), describe_line(file)


def compute_poles(mesh: DiscretisedLine, modes: Modes) -> ComplexArray:
    """Poles of the taut line in the discrete time of the simulator, one for each mode, (m,) [1/s]."""
    vectors, omega, m = free_vectors(mesh, modes), 2 * np.pi * modes.frequency, modes.frequency.size
    damping = vectors @ (assemble_matrices(mesh).damping @ vectors.T)
    correction = np.zeros((m, m))
    for row in range(modes.shape.shape[1]):
        ends = np.concatenate([modes.shape[:, row, :-1], modes.shape[:, row, 1:]], axis=2)
        correction += np.einsum("mea,eab,neb->mn", ends, mass_correction(mesh.beams, row, STEP), ends, optimize=True)
    inverse = np.linalg.inv(np.eye(m) - correction)
    system = np.block([[np.zeros((m, m)), np.eye(m)], [-inverse * omega**2, -inverse @ damping]])
    found = np.linalg.eigvals(system)
    found = found[found.imag > 0]
    return np.asarray(2 / STEP * np.arctanh(found[np.argsort(found.imag)] * STEP / 2))


def make_record(
    random: np.random.Generator, line: BuiltLine, layout: Layout, disturbance: Disturbance, noise: float = 0.003
) -> FieldRecord:
    """Simulate a drop and disturb its record; `noise` is the white noise of the sensors [m/s2]."""
    hanging = REST + STEP * round(random.uniform(-0.3, 0.3) / STEP)
    sensors = [(WIRES[wire], x) for wire, x in layout.sensors]
    setup = MassDropSetup(
        mass=layout.mass,
        wire=WIRES[layout.drop[0]],
        position=layout.drop[1],
        release_duration=0.0,
        hanging=hanging,
        duration=60 * layout.minutes,
        time_step=STEP,
        sensors=tuple(sensors),
    )
    motion = integrate_mass_drop(line.mesh.catenary, ELEMENT, setup)
    decay = decimate(motion.motion[:, :, 2].T, round(1 / RATE / STEP))
    rows = [deflection_at(line.mesh, line.modes, line.mesh.mesh.row_of[wire, "z"], x) for wire, x in sensors]
    shape, (n, count) = np.array(rows), decay.shape
    signals, ambient = decay, np.zeros(line.poles.size)
    if disturbance.wind:
        motion_of_wind, scale = move_by_wind(line.poles, shape, random, n, noise * disturbance.wind)
        signals = signals + motion_of_wind
        ambient = scale * force_gain(line.poles)
    if disturbance.clock:
        rates = disturbance.clock * random.standard_normal(count - 1)
        starts = random.uniform(-0.02, 0.02, count - 1)
        signals = read_by_clocks(signals, np.r_[0.0, rates], np.r_[0.0, starts])
    signals = signals + noise * random.standard_normal(signals.shape)
    if disturbance.coloured:
        signals = signals + make_coloured_noise(random, n, count, noise * disturbance.coloured)
    channels = tuple(DropChannel(f"S{i}_z", i, "z", *place) for i, place in enumerate(layout.sensors, 1))
    drop = DropDescription(layout.mass, *layout.drop, REST)
    record = DropRecord("simulated", "simulated", RATE, signals, channels, drop=drop, line=line.description)
    taut = hanging + (motion.last_slack or 0.0)
    return FieldRecord(record, line, decay, taut, noise, noise * disturbance.coloured, ambient, shape)


def force_gain(poles: ComplexArray) -> RealArray:
    """Gain of the filter of the forces at the frequency of each mode, (m,) [-]."""
    low = scipy.signal.butter(1, WIND_CORNER, fs=RATE)
    return np.asarray(np.abs(scipy.signal.freqz(*low, worN=np.abs(poles), fs=2 * np.pi * RATE)[1]))


def move_by_wind(
    poles: ComplexArray, shape: RealArray, random: np.random.Generator, n: int, rms: float, rate: float = RATE
) -> tuple[RealArray, float]:
    """Ambient motion of sensors under independent forces on the modes below 3 Hz, stationary.

    Args:
        poles: Poles of the modes, (m,) [1/s].
        shape: Deflections of the modes at the sensors, (c, m).
        random: Generator of the forces.
        n: Number of samples.
        rms: RMS in the band from 0.6 to 7.6 Hz over all sensors [m/s2].
        rate: Samples per second [Hz].

    Returns:
        Accelerations, (n, c) [m/s2], and standard deviation of the force on each mode per sample before its filter.
    """
    total = n + int(RUN_UP * rate)
    low = scipy.signal.butter(1, WIND_CORNER, fs=rate)
    moved = np.zeros((n, shape.shape[0]))
    for pole, deflection in zip(poles, shape.T, strict=True):
        b, _ = scipy.signal.bilinear([1, 0, 0], [1, -2 * pole.real, abs(pole) ** 2], rate)
        # The bilinear map moves the resonance: the pole of the recursion is that of the mode.
        q = np.exp(pole / rate)
        a = np.array([1.0, -2 * q.real, abs(q) ** 2])
        force = scipy.signal.lfilter(*low, random.standard_normal(total))
        moved += np.outer(scipy.signal.lfilter(b, a, force)[-n:], deflection)
    sections = scipy.signal.butter(4, [0.6, 7.6], "band", fs=rate, output="sos")
    scale = rms / float(np.sqrt(np.mean(scipy.signal.sosfiltfilt(sections, moved, axis=0) ** 2)))
    return scale * moved, scale


def coloured_density(n: int, rate: float = RATE) -> RealArray:
    """Power of the coloured noise at the spectral lines of n samples, over that of white noise of the same RMS [-]."""
    power = 1 / (1 + np.fft.rfftfreq(n, 1 / rate) ** 2)
    return np.asarray(power / power.mean())


def make_coloured_noise(
    random: np.random.Generator, n: int, channels: int, rms: float, rate: float = RATE
) -> RealArray:
    """Noise that falls as 1/f above 1 Hz, (n, channels)."""
    spectrum = np.fft.rfft(random.standard_normal((n, channels)), axis=0)
    noise = np.fft.irfft(spectrum * np.sqrt(coloured_density(n, rate))[:, None], n, axis=0)
    return np.asarray(rms * noise / noise.std(axis=0))


def read_by_clocks(signals: RealArray, rates: RealArray, starts: RealArray, rate: float = RATE) -> RealArray:
    """Signals, (n, c), as sensors read them by clocks with other rates [-] and starts [s]."""
    n, pad, finer = signals.shape[0], 200, 4
    padded = np.pad(signals, ((pad, pad), (0, 0)), mode="edge")
    dense = scipy.signal.resample(padded, finer * padded.shape[0], axis=0)
    time = np.arange(dense.shape[0]) / (finer * rate) - pad / rate
    read = [
        scipy.interpolate.CubicSpline(time, column)(np.arange(n) / rate * (1 + drift) + start)
        for column, drift, start in zip(dense.T, rates, starts, strict=True)
    ]
    return np.column_stack(read)
