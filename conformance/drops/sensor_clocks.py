"""Clocks of the sensors: rate and start of each clock against that of the first sensor, from the decays themselves.

A clock that is fast by a rate e stretches its record: all poles of the sensor are lower by the factor 1 / (1 + e). The
rates are unknowns beside the poles in one Gauss-Newton step from the poles of a common clock; the start of a clock
turns the phase of each mode by omega times the start.

Two poles nearer than a spectral line, with residues of their own at each sensor, also fit a mode that clocks show at
two frequencies. The rates are then badly determined. If the rates alone explain what the second poles explain, they
count.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.line_fit import FittedBlock, LineFit, fit_line
from pantocheck.conformance.drops.model_order import detection_threshold
from pantocheck.conformance.drops.pole_refinement import (
    NormalEquations,
    add_clock_rates,
    bound_estimates,
    build_normal_equations,
)

REFUTED = 4.5
"""Rate over its standard deviation, from which on a common clock is refuted [-]."""
LEAST_AGREEMENT, FEWEST_MODES = 0.9, 2.0
"""Mean cosine of the phases, and effective number of modes, below which they show no start [-]."""
CORRECTED = 2.0
"""Rest of a corrected rate over its standard deviation, from which on it is corrected again [-]."""
LEAST_RATE = 1e-6
"""Smallest rate that counts: crystals of one recorder differ by less [-]."""
LONGEST_START, LEAST_START = 0.25, 0.002
"""Largest start of a clock that the phases of the modes show, and the smallest that counts [s]."""
MERGED_STEPS = 4
"""Largest number of steps of the refinement of poles after near ones are merged."""
TAPS, SMOOTH = 32, 8.0
"""Number of samples and shape (Kaiser) of the interpolation between samples."""


@dataclass(frozen=True)
class SensorClock:
    """Clock of a sensor against that of the first sensor of the first record."""

    sensor: int
    rate: float
    """Relative rate, positive: the clock is fast [-]."""
    rate_std: float
    start: float
    """Start of its record after that of the first sensor [s]."""
    start_std: float
    """Standard deviation of the start, from the scatter of the phases [s]."""

    @property
    def deviates(self) -> bool:
        """Whether the clock is not that of the first sensor."""
        return abs(self.rate) > max(REFUTED * self.rate_std, LEAST_RATE)

    @property
    def is_late(self) -> bool:
        """Whether its record starts at another time than that of the first sensor."""
        return abs(self.start) > max(REFUTED * self.start_std, LEAST_START)


@dataclass(frozen=True)
class ClockComparison:
    """Clocks of the sensors of a fit, and its poles if all rates are unknown."""

    clocks: tuple[SensorClock, ...]
    """Empty: a single sensor has none to compare with."""
    poles: ComplexArray
    """Poles after a Gauss-Newton step of poles and rates together, (m,) [1/s]."""
    covariance: RealArray
    """Covariance of decay rates and angular frequencies that contains that of the rates, (2 m, 2 m)."""
    explained: float = 0.0
    """Reduction of the squared residual by that step [-]."""


def compare_clocks(fit: LineFit) -> ClockComparison:
    """Compare the clocks of the sensors of a fit; clocks that explain the second of two near poles are preferred."""
    found, merged = _compare_rates(fit), _merge_near_poles(fit)
    removed = fit.poles.size - merged.poles.size
    if not removed or not found.clocks:
        return found
    simpler = _compare_rates(merged)
    left = _squared_residual(merged) - simpler.explained - _squared_residual(fit)
    is_enough = left < removed * detection_threshold([block.data for block in fit.blocks])
    is_needed = any(clock.deviates for clock in simpler.clocks)
    return replace(found, clocks=simpler.clocks) if is_enough and is_needed else found


def _merge_near_poles(fit: LineFit) -> LineFit:
    """Fit with the stronger one of poles that are nearer than a spectral line; the fit itself if there are none."""
    line = 2 * np.pi / min(block.data.duration for block in fit.blocks)
    energy = sum(np.sum(np.abs(block.fit.residues / block.noise) ** 2, axis=1) for block in fit.blocks)
    kept: list[int] = []
    for pole in np.argsort(-np.asarray(energy)):
        if all(abs(fit.poles[pole] - fit.poles[other]) > line for other in kept):
            kept.append(int(pole))
    if len(kept) == fit.poles.size:
        return fit
    decays = [record.decay for record in fit.records]
    numbers = {id(block): number for number, block in enumerate(fit.blocks)}
    places = [(numbers[id(record.block)], record.columns) for record in fit.records]
    data = [block.data for block in fit.blocks]
    noise = [block.noise if block.process is None else block.process for block in fit.blocks]
    return fit_line(decays, places, data, fit.poles[sorted(kept)], noise, fit.band, MERGED_STEPS)


def _squared_residual(fit: LineFit) -> float:
    return float(sum(np.sum(np.abs(block.white_residual) ** 2) for block in fit.blocks))


def _compare_rates(fit: LineFit) -> ClockComparison:
    """Compare the clocks of the sensors by one step of poles and rates from the poles of a fit."""
    sensors = list(dict.fromkeys(channel.sensor for record in fit.records for channel in record.decay.channels))
    m = fit.poles.size
    if len(sensors) < 2 or not m:
        return ClockComparison((), fit.poles, fit.covariance)
    matrix, gradient = np.zeros((2 * m + len(sensors),) * 2), np.zeros(2 * m + len(sensors))
    for block in fit.blocks:
        part = build_equations(fit, block, sensors)
        matrix, gradient = matrix + part.matrix, gradient + part.gradient
    matrix[range(2 * m), range(2 * m)] += bound_estimates(fit.poles)
    used = np.delete(np.arange(gradient.size), 2 * m)
    scale = np.sqrt(np.maximum(np.diag(matrix)[used], np.finfo(float).tiny))
    covariance = np.linalg.pinv(matrix[np.ix_(used, used)] / np.outer(scale, scale), hermitian=True)
    covariance /= np.outer(scale, scale)
    change, std = covariance @ gradient[used], np.sqrt(np.diag(covariance))
    starts = [_find_start(fit, sensors[0], sensor) for sensor in sensors[1:]]
    clocks = tuple(
        SensorClock(sensor, float(rate), float(deviation), *start)
        for sensor, rate, deviation, start in zip(sensors[1:], change[2 * m :], std[2 * m :], starts, strict=True)
    )
    moved = -change[:m] + 1j * change[m : 2 * m]
    # A step beyond the half-power band of a weak mode is not linear.
    poles = np.where(np.abs(moved) < -fit.poles.real / 2, fit.poles + moved, fit.poles)
    explained = float(change @ gradient[used])
    return ClockComparison(clocks, np.asarray(poles), np.asarray(covariance[: 2 * m, : 2 * m]), explained)


def build_equations(fit: LineFit, block: FittedBlock, sensors: Sequence[int]) -> NormalEquations:
    """Normal equations of the poles and of the rates of all sensors in a block."""
    own = np.zeros((len(sensors), block.noise.size), dtype=np.bool_)
    for record in fit.records:
        for number, channel in enumerate(record.decay.channels):
            own[sensors.index(channel.sensor), record.columns.start + number] |= record.block is block
    if block.process is not None:
        return add_clock_rates(fit.poles, block.data, own)
    # Channels with white noise of their own are independent of each other.
    m, slower = fit.poles.size, -np.concatenate([-fit.poles.real, fit.poles.imag])
    matrix, gradient = np.zeros((2 * m + len(own),) * 2), np.zeros(2 * m + len(own))
    for number, columns in enumerate(own):
        white = replace(block.data, spectrum=block.data.spectrum[:, columns] / block.noise[columns])
        if columns.any():
            part = build_normal_equations(fit.poles, [white])
            spread = np.eye(2 * m, gradient.size)
            spread[:, 2 * m + number] = slower
            matrix, gradient = matrix + spread.T @ part.matrix @ spread, gradient + spread.T @ part.gradient
    return NormalEquations(0.0, lambda: (matrix, gradient))


def _find_start(fit: LineFit, first: int, sensor: int) -> tuple[float, float]:
    """Start of a clock that makes the phases of the modes at both sensors equal or opposite, and its deviation [s]."""
    omega, phase, weight = [], [], []
    for record in fit.records:
        columns = {channel.sensor: number for number, channel in enumerate(record.decay.channels)}
        if first in columns and sensor in columns:
            a, b = (record.residues[:, columns[key]] / record.residue_std[:, columns[key]] for key in (first, sensor))
            omega.append(fit.poles.imag)
            phase.append(2 * np.angle(b * a.conj()))
            weight.append(np.minimum(np.abs(a), np.abs(b)))
    if not omega:
        return 0.0, np.inf
    w, p, s = (np.concatenate(values) for values in (omega, phase, weight))
    trials = np.arange(-LONGEST_START, LONGEST_START, 1e-4)
    score = np.cos(p[:, None] - 2 * np.outer(w, trials)).T @ s
    modes = np.sum(s * w**2) ** 2 / np.sum((s * w**2) ** 2)
    if score.max() < LEAST_AGREEMENT * s.sum() or modes < FEWEST_MODES:
        return 0.0, np.inf
    start = float(trials[int(np.argmax(score))])
    left = np.angle(np.exp(1j * (p - 2 * w * start))) / 2
    scatter = float(np.sqrt(np.sum((s * w * left) ** 2)) / np.sum(s * w**2))
    return start, scatter * float(np.sqrt(modes / (modes - 1)))


def list_corrections(clocks: Sequence[SensorClock], applied: Sequence[SensorClock]) -> list[SensorClock]:
    """Next corrections: rates that deviate; once none does, starts that differ. Wrong rates disturb the phases.

    A rate that was corrected before is corrected until its rest is small; the last step contains this rest.
    """
    corrected = {clock.sensor for clock in applied if clock.rate}
    rates = [
        clock
        for clock in clocks
        if clock.deviates or (clock.sensor in corrected and abs(clock.rate) > CORRECTED * clock.rate_std)
    ]
    if rates:
        return [replace(clock, start=0.0) for clock in rates]
    if any(clock.is_late for clock in clocks):
        return [replace(clock, rate=0.0) for clock in clocks if clock.is_late]
    return []


def sum_clocks(last: Sequence[SensorClock], applied: Sequence[SensorClock]) -> tuple[SensorClock, ...]:
    """Clocks found last, with the corrections that were applied before."""
    return tuple(
        replace(
            clock,
            rate=clock.rate + sum(other.rate for other in applied if other.sensor == clock.sensor),
            start=clock.start + sum(other.start for other in applied if other.sensor == clock.sensor),
        )
        for clock in last
    )


def refuse_shared_clock(records: Sequence[DropRecord], clocks: Iterable[SensorClock]) -> None:
    """Refuse records whose sidecar states a clock that their sensors do not share.

    Raises:
        InputError: A rate or a start differs.
    """
    stated = next((record for record in records if record.shared_clock), None)
    worst = max(clocks, key=lambda clock: abs(clock.rate / max(clock.rate_std, LEAST_RATE)), default=None)
    if stated is not None and worst is not None:
        raise InputError(
            stated.name,
            f"states one clock for all sensors, but that of sensor {worst.sensor} {_describe_clock(worst)}",
            "Correct the times of the sensors, or state shared_clock = false: clocks are then found from the record.",
        )


def describe_clocks(clocks: Iterable[SensorClock]) -> tuple[str, ...]:
    """Sentence on the corrected clocks; none if the sensors share a clock."""
    wrong = [clock for clock in clocks if clock.deviates or clock.is_late]
    if not wrong:
        return ()
    parts = "; ".join(f"sensor {clock.sensor} {_describe_clock(clock)}" for clock in wrong)
    return (f"the sensors have clocks of their own, which are corrected: {parts}, against the first sensor",)


def _describe_clock(clock: SensorClock) -> str:
    rate = (
        f"runs {'fast' if clock.rate > 0 else 'slow'} by {1e6 * abs(clock.rate):.1f} +- {1e6 * clock.rate_std:.1f} ppm"
    )
    return f"{rate} and starts {1e3 * abs(clock.start):.1f} ms {'late' if clock.start > 0 else 'early'}"


def align_record(record: DropRecord, clocks: Sequence[SensorClock]) -> DropRecord:
    """Record with the samples of every sensor at the times of the first one."""
    signals = record.signals.copy()
    for clock in clocks:
        columns = [number for number, channel in enumerate(record.channels) if channel.sensor == clock.sensor]
        place = (record.time * (1 + clock.rate) - clock.start) * record.rate
        signals[:, columns] = interpolate(signals[:, columns], place)
    return replace(record, signals=signals)


def interpolate(samples: RealArray, place: RealArray) -> RealArray:
    """Band-limited signals, (n, c), at places between their samples, (p,); beyond the ends they are constant."""
    whole = np.floor(place).astype(int)
    offsets = np.arange(1 - TAPS // 2, TAPS // 2 + 1)
    distance = place[:, None] - whole[:, None] - offsets
    window = np.i0(SMOOTH * np.sqrt(np.maximum(1 - (2 * distance / TAPS) ** 2, 0))) / np.i0(SMOOTH)
    weights = np.sinc(distance) * window
    weights /= weights.sum(axis=1, keepdims=True)
    nearby = samples[np.clip(whole[:, None] + offsets, 0, samples.shape[0] - 1)]
    return np.asarray(np.einsum("pt,ptc->pc", weights, nearby))
