"""Repeatability of a mass drop: its records at the start and a minute later; conversion of motion."""

import numpy as np
import scipy.fft

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.units import MotionQuantity
from pantocheck.conformance.drops.decay_kernel import filter_full_overlap, low_pass_taps
from pantocheck.conformance.drops.decay_preparation import PreparedDecay
from pantocheck.conformance.drops.drop_record import MOTION_ORDER
from pantocheck.conformance.results.identification_format import (
    Comparison,
    Curve,
    CurveWindow,
    Overlay,
    OverlayRun,
    Repeatability,
)

WINDOW = 10.0
"""Length of a compared window [s]."""

EARLY = 1.5
"""Start of the first compared window after the release [s]; earlier, slack droppers make the repeats differ."""

LATER = 60.0
"""Start of the second compared window after the release [s]."""

MIN_CORRELATION_AT_START, MIN_CORRELATION_LATER = 0.98, 0.95
"""Smallest correlations of a repeatable drop, over the correlation of equal signals with the same noise [-]."""

HIGHEST_COMPARED = 6.0
"""Highest frequency of the comparison [Hz]."""

CURVE_STEP = 0.025
"""Time step of the drawn curves [s]."""


def compare_records(repeats: tuple[PreparedDecay, ...]) -> Repeatability:
    """Compare the repeats of a drop with its first record, at each channel."""
    comparisons = [comparison for other in repeats[1:] for comparison in _compare_pair(repeats[0], other)]
    failed = next((c for c in comparisons if not _is_repeatable(c)), None)
    if failed is None:
        worst = min(comparisons, key=lambda c: c.correlation_at_start / c.possible_at_start)
        reason = f"lowest correlation at the start {worst.correlation_at_start:.4f} ({worst.channel})"
        return Repeatability(verdict="repeatable", reason=reason, comparisons=tuple(comparisons))
    later = "" if failed.correlation_later is None else f", {failed.correlation_later:.3f} a minute later"
    start = f"correlation {failed.correlation_at_start:.3f} at the start"
    reason = f"{failed.second}, channel {failed.channel}: {start}{later}"
    return Repeatability(verdict="not repeatable", reason=reason, comparisons=tuple(comparisons))


def overlay_records(repeats: tuple[PreparedDecay, ...]) -> Overlay:
    """Curves of the records of a drop at the channel with the largest motion."""
    lowest_rate = min(decay.record.rate for decay in repeats)
    curves = [_align_record(decay, lowest_rate) for decay in repeats]
    channel = int(np.argmax(curves[0][1].std(axis=0)))
    runs = []
    for decay, (time, samples) in zip(repeats, curves, strict=True):
        measured, rate, given = samples[:, [channel]], decay.record.rate, decay.record.quantity
        velocity, acceleration = (convert_motion(measured, rate, given, q) for q in ("velocity", "acceleration"))
        motion = np.hstack([measured, velocity, acceleration])
        windows = tuple(_cut_window(time, motion, begin) for begin in (0.0, LATER) if begin + WINDOW <= time[-1])
        runs.append(OverlayRun(name=decay.record.name, windows=windows))
    return Overlay(channel=repeats[0].channel_names[channel], runs=tuple(runs))


def _cut_window(time: RealArray, motion: RealArray, begin: float) -> CurveWindow:
    """Measured quantity, velocity and acceleration, (n, 3), in a window after the release, each without its mean."""
    grid = np.arange(begin, begin + WINDOW, CURVE_STEP)
    curves = [np.interp(grid, time, column) for column in motion.T]
    signal, velocity, acceleration = (round_curve(curve - curve.mean()) for curve in curves)
    return CurveWindow(time_s=round_curve(grid), signal=signal, velocity_m_s=velocity, acceleration_m_s2=acceleration)


def round_curve(values: RealArray) -> Curve:
    """Values with six significant digits, for a figure."""
    return [float(f"{value:.6g}") for value in values]


def _is_repeatable(c: Comparison) -> bool:
    if c.correlation_at_start < MIN_CORRELATION_AT_START * c.possible_at_start:
        return False
    if c.correlation_later is None or c.possible_later is None:
        return True
    return c.correlation_later >= MIN_CORRELATION_LATER * c.possible_later


def _align_record(decay: PreparedDecay, lowest_rate: float) -> tuple[RealArray, RealArray]:
    """Time from the release, (n,) [s], and the low-pass filtered vertical channels, (n, c).

    The cut-off is `HIGHEST_COMPARED`, or lower if the lowest sampling rate of the repeats [Hz] requires it.
    """
    rate, passes = decay.record.rate, min(HIGHEST_COMPARED, 0.28 * lowest_rate)
    taps = low_pass_taps(rate, passes, 1.5 * passes, 50.0)
    samples = filter_full_overlap(decay.record.signals[:, list(decay.columns)], taps)
    time = (np.arange(samples.shape[0]) + (taps.size - 1) / 2) / rate - decay.release.time
    return np.asarray(time, dtype=np.float64), samples


def _compare_pair(first: PreparedDecay, second: PreparedDecay) -> list[Comparison]:
    lowest_rate = min(first.record.rate, second.record.rate)
    t1, x1 = _align_record(first, lowest_rate)
    t2, x2 = _align_record(second, lowest_rate)
    rate = first.record.rate
    shift = _delay(t1, x1, t2, x2, rate)
    noise_1, noise_2 = _noise_at_rest(t1, x1), _noise_at_rest(t2, x2)
    early, later = (begin + np.arange(int(WINDOW * rate)) / rate for begin in (EARLY, LATER))
    end = min(t1[-1], t2[-1] - shift)
    if early[-1] > end:
        return []

    def compare(grid: RealArray, c: int) -> tuple[float, float, float]:
        a, b = np.interp(grid, t1, x1[:, c]), np.interp(grid + shift, t2, x2[:, c])
        return _compare_signals(a - a.mean(), b - b.mean(), float(noise_1[c]), float(noise_2[c]))

    comparisons = []
    for c, name in enumerate(first.channel_names):
        at_start = compare(early, c)
        at_end = compare(later, c) if later[-1] <= end else (None, None, None)
        comparisons.append(
            Comparison(
                first=first.record.name,
                second=second.record.name,
                channel=name,
                shift_s=shift,
                correlation_at_start=at_start[0],
                correlation_later=at_end[0],
                possible_at_start=max(at_start[1], 1e-6),
                possible_later=at_end[1],
                residual_at_start=at_start[2],
                residual_later=at_end[2],
            )
        )
    return comparisons


def _compare_signals(a: RealArray, b: RealArray, noise_a: float, noise_b: float) -> tuple[float, float, float]:
    """Correlation of two signals, correlation of equal signals with the same noise, and relative residual."""
    signal = [max(float(np.mean(v**2)) - s**2, 0.0) for v, s in ((a, noise_a), (b, noise_b))]
    share = [p / (p + s**2) if p > 0 else 0.0 for p, s in zip(signal, (noise_a, noise_b), strict=True)]
    correlation = float(a @ b / np.sqrt((a @ a) * (b @ b)))
    residual = float(np.sqrt(np.mean((a - b) ** 2) / np.mean(a**2)))
    return correlation, float(np.sqrt(share[0] * share[1])), residual


def _noise_at_rest(time: RealArray, samples: RealArray) -> RealArray:
    """RMS before the release, (c,); 0 if the record has no rest."""
    rest = samples[time < -1.0]
    return np.asarray(rest.std(axis=0)) if rest.shape[0] > 20 else np.zeros(samples.shape[1])


def _delay(t1: RealArray, x1: RealArray, t2: RealArray, x2: RealArray, rate: float) -> float:
    """Delay of the second record from all channels together, with a resolution below one sample [s]."""
    grid = EARLY + np.arange(int(WINDOW * rate)) / rate
    a = np.column_stack([np.interp(grid, t1, column) for column in x1.T])
    a = a - a.mean(axis=0)

    def correlation(shift: float) -> float:
        b = np.column_stack([np.interp(grid + shift, t2, column) for column in x2.T])
        b = b - b.mean(axis=0)
        return float(np.sum(a * b) / np.sqrt(np.sum(a**2) * np.sum(b**2)))

    shifts = np.arange(-0.3, 0.3, 0.5 / rate)
    values = [correlation(shift) for shift in shifts]
    k = int(np.clip(np.argmax(values), 1, shifts.size - 2))
    below, middle, above = values[k - 1 : k + 2]
    curvature = below - 2 * middle + above
    return float(shifts[k] + (0.5 * (below - above) / curvature * (shifts[1] - shifts[0]) if curvature < 0 else 0.0))


# Conversion between displacement, velocity and acceleration by powers of i w in the frequency domain.
HIGH_PASS = 0.04, 0.08
"""Frequencies below which nothing and above which everything remains [Hz]: far below the modes, above slow drift."""

PADDING = 30.0
"""Zeros behind the samples [s], longer than the response of the high-pass, so that the end does not reach the start."""


def convert_motion(samples: RealArray, rate: float, given: MotionQuantity, wanted: MotionQuantity) -> RealArray:
    """Integrate or differentiate measured motion.

    A high-pass (`HIGH_PASS`) leaves out offset and drift, which an integral amplifies without limit.

    Args:
        samples: Channels that begin at rest, (n, c).
        rate: Sampling rate [Hz].
        given, wanted: Quantity of the samples, and that of the result.

    Returns:
        Motion in SI units, (n, c); the samples themselves if the quantity is the wanted one.
    """
    power = MOTION_ORDER[wanted] - MOTION_ORDER[given]
    if power == 0:
        return samples
    n = scipy.fft.next_fast_len(samples.shape[0] + int(PADDING * rate), real=True)
    frequency = scipy.fft.rfftfreq(n, 1 / rate)
    share = np.clip((frequency - HIGH_PASS[0]) / (HIGH_PASS[1] - HIGH_PASS[0]), 0.0, 1.0)
    factor = np.sin(np.pi / 2 * share) ** 2 * (2j * np.pi * np.maximum(frequency, 1 / n)) ** power
    spectrum = scipy.fft.rfft(samples - samples.mean(axis=0), n, axis=0) * factor[:, None]
    return np.asarray(scipy.fft.irfft(spectrum, n, axis=0)[: samples.shape[0]])
