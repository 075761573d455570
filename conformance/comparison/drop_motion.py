"""Motion of a recorded drop and of its simulations on one time grid, aligned by the best fit after the release."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil
from typing import NamedTuple

import numpy as np
import scipy

from pantocheck.conformance.comparison.recorded_drop import RecordedDrop
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.step_log import ShareCallback, build_part_callback, ignore_progress
from pantocheck.conformance.drops.decay_kernel import LOWEST_FREQUENCY
from pantocheck.conformance.drops.drop_record import MOTION_ORDER
from pantocheck.conformance.drops.drop_simulation import decimate
from pantocheck.conformance.drops.release import MIN_REST, Release, find_release
from pantocheck.conformance.runs.case_run import integrate_mass_drop
from pantocheck.model import Catenary
from pantocheck.model.dynamics.drop_values import MassDropSetup

# Velocity and acceleration in a frequency band, from samples of a displacement, velocity or acceleration.
#
# The edges of neighbouring bands are crossfades whose squares add up to one, so that the bands share out the power.
RELATIVE_EDGE = 0.1
"""Half-width of the crossfade at the edge of a band over the frequency of the edge [-]."""

NARROWEST_EDGE_HZ = 0.15
"""Smallest half-width of a crossfade [Hz]; a narrower one would ring for more than some seconds."""

TAPER_S = 1.0
"""Length of the fade at the end of the samples, where the decay is cut off [s]."""

PADDING_S = 10.0
"""Rest behind the samples, so that a filter does not carry their end to their start [s]."""


class MotionBand(NamedTuple):
    """Frequency band [Hz] of a motion."""

    low: float
    high: float

    @property
    def text(self) -> str:
        """Edges with their unit."""
        return f"{self.low:g} to {self.high:g} Hz"


MOTION_BANDS = (
    MotionBand(LOWEST_FREQUENCY, 5.0),
    MotionBand(5.0, 20.0),
    MotionBand(20.0, 50.0),
    MotionBand(LOWEST_FREQUENCY, 20.0),
)
"""Compared bands: low, medium and high frequencies (Vo Van et al. 2015), and all up to 20 Hz."""

GRAPHIC_BAND = MOTION_BANDS[-1]
"""Band of curves and residual energies."""


def filter_motion(
    samples: RealArray, rate: float, derivatives: int, band: MotionBand, advance: float = 0.0
) -> RealArray:
    """Part of a motion in a frequency band, differentiated or integrated in time.

    Args:
        samples: Motion of c places, at rest at its start, (n, c).
        rate: Sampling rate [Hz].
        derivatives: Number of derivatives in time; negative: integrals.
        band: Frequency band.
        advance: Time by which the motion is advanced, also a part of a sample [s].

    Returns:
        Motion in the band, (n, c); the last `TAPER_S` is faded.
    """
    n = samples.shape[0]
    fade = min(round(TAPER_S * rate), n)
    tapered = np.array(samples, dtype=np.float64)
    tapered[n - fade :] *= (0.5 + 0.5 * np.cos(np.pi * (np.arange(fade) + 0.5) / fade))[:, None]
    length = scipy.fft.next_fast_len(n + round(PADDING_S * rate), real=True)
    frequency: RealArray = np.asarray(np.fft.rfftfreq(length, 1 / rate), dtype=np.float64)
    gain = np.zeros(frequency.size, dtype=np.complex128)
    inside = frequency > 0
    omega = 2j * np.pi * frequency[inside]
    gain[inside] = band_gain(frequency[inside], band) * omega**derivatives * np.exp(omega * advance)
    return np.asarray(np.fft.irfft(gain[:, None] * np.fft.rfft(tapered, length, axis=0), length, axis=0)[:n])


def noise_rms(rest: RealArray, rate: float, derivatives: int, band: MotionBand) -> RealArray:
    """RMS of a motion at rest in a frequency band, by its spectral density.

    Args:
        rest: Samples of c places at rest, (n, c).
        rate: Sampling rate [Hz].
        derivatives: Number of derivatives in time; negative: integrals.
        band: Frequency band.

    Returns:
        RMS in the band, (c,).
    """
    frequency, density = scipy.signal.periodogram(rest, rate, "hann", detrend="linear", axis=0)
    inside = frequency > 0
    gain = band_gain(frequency[inside], band) * (2 * np.pi * frequency[inside]) ** derivatives
    return np.asarray(np.sqrt(frequency[1] * (gain**2 @ density[inside])))


def band_gain(frequency: RealArray, band: MotionBand) -> RealArray:
    """Gain of a band at frequencies [Hz]: one inside, with crossfades at its edges."""
    return np.sqrt(_share_above(frequency, band.low) * (1 - _share_above(frequency, band.high)))


def _share_above(frequency: RealArray, edge: float) -> RealArray:
    """Share of the power above an edge: from zero to one across the crossfade."""
    width = max(RELATIVE_EDGE * edge, NARROWEST_EDGE_HZ)
    place = np.clip((frequency - edge) / (2 * width) + 0.5, 0.0, 1.0)
    return np.asarray(np.sin(0.5 * np.pi * place) ** 2)


WORKING_RATE_HZ = 200.0
"""Rate to which faster records are decimated [Hz]: the highest band ends at half of its Nyquist frequency."""

LEAD_S = 2.0
"""Rest before the release that is compared [s]."""

MARGIN_S = 1.0
"""Simulated time between the last window and the fade at the end [s]."""

ALIGNED_S = 2.0
"""Length of the motion after the release that is aligned [s]: damping and errors of frequency have no effect yet."""

ARRIVAL = 0.01
"""Motion over its largest value at which the first wave has arrived at a sensor [-]."""

SEARCH_S = 1.0
"""Largest distance between the estimated and the aligned release [s]: filters of slow records ring before it."""

UPSAMPLING = 16
"""Samples of the search per sample of the record; at 200 samples per second, a step is 0.3 ms."""


@dataclass(frozen=True)
class DropSimulation:
    """Settings of the simulations of a recorded drop."""

    element: float
    """Largest element length [m]."""
    time_step: float
    """Largest time step [s]; the used one divides the sampling interval."""
    release_duration: float
    """Time in which the weight decreases linearly to zero [s]."""
    last: float
    """End of the last compared window after the release [s]."""
    aligned: tuple[int, ...] = ()
    """Numbers of the sensors that find the release; empty: all sensors."""


@dataclass(frozen=True)
class DropMotion:
    """Motion of a record and of models at the sensors, and of models at the mass; n samples, c sensors."""

    rate: float
    """Sampling rate [Hz]."""
    lead: int
    """Number of samples before the release."""
    quantity: str
    """Quantity of the samples: displacement, velocity or acceleration."""
    record: RealArray
    """Record, from `lead` samples before the sample that precedes the release, (n, c)."""
    advance: float
    """Time from this sample to the release [s]."""
    rest: RealArray
    """Record at rest, (r, c); empty if it is too short for an estimate of the noise."""
    models: Mapping[str, RealArray]
    """Simulated motion by model, (n, c + 1); the last column is that of the mass."""
    last_slack: Mapping[str, float | None]
    """Last time with a slack dropper by model [s]."""
    release: Release
    """First motion of the record and its warnings."""
    release_time: float
    """Release in the time of the record [s]."""
    correlation: float
    """Correlation of the record and the first model at this release [-]."""

    @property
    def time(self) -> RealArray:
        """Time of the samples after the release [s]."""
        return np.asarray((np.arange(self.record.shape[0]) - self.lead) / self.rate, dtype=np.float64)

    @property
    def end(self) -> float:
        """Latest end of a window after the release [s]."""
        return float(self.time[-1] + 1 / self.rate - TAPER_S)

    def filter_record(self, motion: str, band: MotionBand) -> RealArray:
        """Velocity or acceleration of the record in a band, (n, c)."""
        return filter_motion(self.record, self.rate, self._derivatives(motion), band, self.advance)

    def filter_model(self, name: str, motion: str, band: MotionBand) -> RealArray:
        """Velocity or acceleration of a model in a band, (n, c + 1)."""
        return filter_motion(self.models[name], self.rate, self._derivatives(motion), band)

    def noise(self, motion: str, band: MotionBand) -> RealArray | None:
        """RMS of the noise of each sensor in a band, (c,); None if it is not known."""
        return noise_rms(self.rest, self.rate, self._derivatives(motion), band) if self.rest.size else None

    def _derivatives(self, motion: str) -> int:
        return MOTION_ORDER[motion] - MOTION_ORDER[self.quantity]


def simulate_models(
    drop: RecordedDrop,
    models: Mapping[str, Catenary],
    settings: DropSimulation,
    progress: ShareCallback = ignore_progress,
) -> DropMotion:
    """Simulate a recorded drop under several models, and align the record with the first one.

    Args:
        drop: The drop.
        models: Line with the damping of each model; the first one finds the release.
        settings: Settings of the simulations.
        progress: Called from time to time with the completed share of all simulations, 0 to 1.

    Returns:
        Motion on one time grid.

    Raises:
        InputError: The record has no release, or ends too early.
        NoInitialState, NoEquilibrium, DidNotConverge: A simulation has no solution.
    """
    record = drop.record
    every = max(1, int(record.rate / WORKING_RATE_HZ))
    signals = record.signals[:, list(drop.columns)]
    aligned = [c for c, channel in enumerate(drop.channels) if channel.sensor in settings.aligned]
    aligned = aligned or list(range(signals.shape[1]))
    release = find_release(signals[:, aligned], record.rate, record.drop.trigger_nominal, record.name)
    rest_end = int(release.rest_end * record.rate)
    offset = np.median(signals[:rest_end] if rest_end else signals, axis=0)
    rate, samples = record.rate / every, decimate(signals - offset, every)
    available = samples.shape[0] / rate - release.time
    if available < ALIGNED_S + SEARCH_S:
        raise InputError(
            f"record '{record.source}'",
            f"ends {available:.2f} s after the first motion",
            f"At least {ALIGNED_S + SEARCH_S:g} s are needed to find the release.",
        )
    lead = round(LEAD_S * rate)
    duration = min(settings.last + MARGIN_S + TAPER_S, available)
    simulated, slack = {}, {}
    for number, (name, catenary) in enumerate(models.items()):
        part = build_part_callback(progress, number / len(models), (number + 1) / len(models))
        simulated[name], slack[name] = _simulate(drop, catenary, settings, (rate, lead, duration), part)
    first = next(iter(simulated.values()))[:, aligned]
    record_part, model_part = (filter_motion(part, rate, 0, GRAPHIC_BAND) for part in (samples[:, aligned], first))
    # Without rest, the planned release stands in place of the first motion.
    estimate = release.time - (find_arrival(model_part[lead:], rate) if rest_end else 0.0)
    time, correlation = align_release(record_part, model_part[lead:], rate, estimate)
    begin = int(time * rate)
    missing = max(lead - begin, 0)
    length = min(first.shape[0] - missing, samples.shape[0] - begin + lead - missing)
    rest = samples[: int(release.rest_end * rate)] if release.rest_end >= MIN_REST else samples[:0]
    return DropMotion(
        rate=rate,
        lead=lead - missing,
        quantity=record.quantity,
        record=samples[begin - lead + missing : begin - lead + missing + length],
        advance=time - begin / rate,
        rest=rest,
        models={name: motion[missing : missing + length] for name, motion in simulated.items()},
        last_slack=slack,
        release=release,
        release_time=time,
        correlation=correlation,
    )


def _simulate(
    drop: RecordedDrop,
    catenary: Catenary,
    settings: DropSimulation,
    grid: tuple[float, int, float],
    progress: ShareCallback,
) -> tuple[RealArray, float | None]:
    """Motion in the quantity of the record on a grid of a rate [Hz], a number of samples before the release and a
    duration after it [s]; last time with a slack dropper [s].
    """
    rate, lead, duration = grid
    steps = ceil(1 / (rate * settings.time_step) - 1e-9)
    wire, position = drop.places[-1]
    decay = integrate_mass_drop(
        catenary,
        settings.element,
        MassDropSetup(
            mass=drop.mass,
            wire=wire,
            position=position,
            release_duration=settings.release_duration,
            # The first of the simulated samples is one step after the start.
            hanging=(lead * steps + 1) / (rate * steps),
            duration=duration,
            time_step=1 / (rate * steps),
            sensors=drop.places,
        ),
        progress,
    )
    motion = decay.motion[:, :, MOTION_ORDER[drop.record.quantity]].T
    return decimate(motion - motion[0], steps), decay.last_slack


def find_arrival(simulated: RealArray, rate: float) -> float:
    """Time from the release to the first motion of a sensor [s].

    Args:
        simulated: Simulated motion of c sensors from the release on, (m, c).
        rate: Sampling rate [Hz].
    """
    model = simulated[: round(ALIGNED_S * rate)]
    moving = np.any(np.abs(model) > ARRIVAL * np.abs(model).max(axis=0), axis=1)
    return float(np.argmax(moving)) / rate


def align_release(record: RealArray, simulated: RealArray, rate: float, estimate: float) -> tuple[float, float]:
    """Find the release by the correlation of record and simulation at all sensors together.

    Args:
        record: Recorded motion of c sensors, low-pass filtered, (n, c).
        simulated: Simulated motion from the release on, with the same filter, (m, c).
        rate: Sampling rate of both [Hz].
        estimate: Estimate of the release in the time of the record [s].

    Returns:
        Release in the time of the record [s], and correlation over `ALIGNED_S` from this release [-].
    """
    model = simulated[: round(ALIGNED_S * rate)]
    fine = scipy.signal.resample_poly(record, UPSAMPLING, 1, axis=0)
    middle, reach = round(estimate * rate * UPSAMPLING), round(SEARCH_S * rate * UPSAMPLING)
    last = fine.shape[0] - UPSAMPLING * (model.shape[0] - 1) - 1
    starts = np.arange(max(middle - reach, 0), min(max(middle, 0) + reach, last) + 1)
    values = np.array([_correlation(fine[s : s + UPSAMPLING * model.shape[0] : UPSAMPLING], model) for s in starts])
    k = int(np.clip(np.argmax(values), 1, starts.size - 2))
    below, middle_value, above = values[k - 1 : k + 2]
    curvature = below - 2 * middle_value + above
    offset = float(np.clip(0.5 * (below - above) / curvature, -1, 1)) if curvature < 0 else 0.0
    return max(float(starts[k] + offset) / (rate * UPSAMPLING), 0.0), float(values[k])


def _correlation(a: RealArray, b: RealArray) -> float:
    norm = float(np.sqrt(np.sum(a**2) * np.sum(b**2)))
    return float(np.sum(a * b)) / norm if norm > 0 else 0.0
