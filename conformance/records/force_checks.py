"""Checks of a measured force: outliers, and a low-pass filter that is not stated in the sidecar."""

from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.filters import is_observable
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals

FILTERED_RATIO = 0.08
"""RMS at 30-50 Hz over RMS at 5-20 Hz, below which a force counts as low-pass filtered, whatever the sidecar states.

In the reference simulator the ratio is 0.26 to 0.40 (EN 50318:2002 at 250 and 300 km/h, AC simple at 320 km/h). After a
filter of order 4 or 6 at 20 Hz it is 0.02 to 0.08. If the ratio of an unfiltered force is lower, only its quantities
above 20 Hz are skipped."""


NEIGHBOURS = 7
"""Number of samples in the running median."""

DEVIATIONS = 12.0
"""Robust standard deviations from the running median beyond which a sample is an outlier."""

SMALLEST_DISTANCE_N = 50.0
"""Smallest distance of an outlier from the running median [N]."""


def find_outliers(force: RealArray) -> NDArray[np.intp]:
    """Find samples far from their neighbours; they are reported but not removed, because a peak may be real.

    Args:
        force: Contact force without missing values, (n,) [N].

    Returns:
        Indices of the outliers, (k,).
    """
    if force.size < NEIGHBOURS:
        return np.empty(0, dtype=np.intp)
    windows = sliding_window_view(np.pad(force, NEIGHBOURS // 2), NEIGHBOURS)
    distance = np.abs(force - np.sort(windows, axis=1)[:, NEIGHBOURS // 2])
    # 1.4826: standard deviation of a normal variable over the median of its absolute value.
    deviation = 1.4826 * float(np.median(distance))
    inner = distance[NEIGHBOURS // 2 : -(NEIGHBOURS // 2)]  # without the zeros beyond the ends
    return np.flatnonzero(inner > max(DEVIATIONS * deviation, SMALLEST_DISTANCE_N)) + NEIGHBOURS // 2


def detect_filtered(signals: PantographSignals, name: str) -> tuple[PantographSignals, list[str]]:
    """Detect a filter of the measuring chain that the sidecar does not state.

    Args:
        signals: Signals of one pantograph, which cover the analysis section.
        name: Name of the pantograph in messages.

    Returns:
        signals: Signals with the filter that was applied.
        warnings: One warning if a filter was detected.
    """
    channel = signals.force
    if channel.filter_applied_Hz is not None or not is_observable(50, channel.rate):
        return signals, []
    upper, inner = (_leakage_free_rms(signals, low, high) for low, high in ((30, 50), (5, 20)))
    # Without content at 5-20 Hz there is no reference.
    if inner <= 1e-3 * float(signals.delivered.std()) or upper > FILTERED_RATIO * inner:
        return signals, []
    cutoff = channel.low_pass.cutoff_Hz
    warning = (
        f"the force of {name} has almost no content at 30-50 Hz ({upper:.2g} N, but {inner:.3g} N at 5-20 Hz): it "
        f"counts as low-pass filtered at {cutoff:g} Hz by the measuring chain; higher frequencies are not evaluated"
    )
    return replace(signals, force=replace(channel, filter_applied_Hz=cutoff)), [warning]


def _leakage_free_rms(signals: PantographSignals, low: float, high: float) -> float:
    """RMS in a band [N] through Hann windows of two seconds, so that the ends of a section do not appear as content.

    The windows overlap by half, and their powers are averaged (Welch's method).
    """
    rate, force = signals.force.rate, signals.delivered
    size = min(force.size, round(2 * rate))
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(size) / size)
    parts = sliding_window_view(force, size)[:: size - size // 2]
    lines = np.fft.rfft((parts - parts.mean(axis=1, keepdims=True)) * window, axis=1)
    frequency = np.fft.rfftfreq(size, 1 / rate)
    inside = (frequency >= low) & (frequency <= high)
    return float(np.sqrt(2 * np.mean(np.abs(lines[:, inside]) ** 2, axis=0).sum() / (size * np.sum(window**2))))


# Clipping: flat tops of a signal from a saturated amplifier.
SAME_EXTREMES = 4
"""Number of consecutive samples with exactly the extreme value that make a flat top."""


def find_clipping(signal: RealArray) -> list[tuple[int, int]]:
    """Find the flat tops of a saturated amplifier, as intervals [start, end) of samples.

    A converter repeats its extreme values also in a signal of noise alone; those lie near the median and do not count.
    """
    middle, reach = np.median(signal), 0.2 * np.ptp(signal)
    return [top for top in _find_flat_tops(signal) if abs(signal[top[0]] - middle) > reach]


def _find_flat_tops(signal: RealArray) -> list[tuple[int, int]]:
    """Intervals [start, end) of samples with exactly the maximum or minimum of the signal."""
    tops = []
    for extreme in {float(signal.max()), float(signal.min())}:
        edges = np.flatnonzero(np.diff(np.concatenate([[False], signal == extreme, [False]]).astype(np.int8)))
        tops += [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a >= SAME_EXTREMES]
    return sorted(tops)
