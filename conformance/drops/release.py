"""Release of the mass: the first sustained movement of a sensor."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError

TRIGGER_TOLERANCE = 0.6
"""Time before the planned release, until which the record counts as rest [s]."""

ONSET = 8.0
"""Smallest motion over noise at rest that counts as release [-]."""

MIN_REST = 1.0
"""Shortest rest before the release for an estimate of the noise [s]."""


@dataclass(frozen=True)
class Release:
    """Measured release."""

    time: float
    """First motion of a sensor, in the time of the record [s]."""
    rest_end: float
    """End of the rest before the release [s]; 0 if the record has no rest."""
    warnings: tuple[str, ...] = ()
    """Caveats on the release."""
    onsets: tuple[float | None, ...] = ()
    """First lasting motion of each channel, in the time of the record [s]; None: it does not stand out."""


def find_release(signals: RealArray, rate: float, nominal: float | None, name: str) -> Release:
    """Find the release: the first lasting motion of a channel.

    Args:
        signals: Channels, (n, c).
        rate: Sampling rate [Hz].
        nominal: Planned release, in the time of the record [s]; None if unknown.
        name: Name of the record, for messages.

    Raises:
        InputError: No channel moves, the record ends too early, or it has neither a planned release nor a rest at its
            start.
    """
    n = signals.shape[0]
    if nominal is not None and nominal - TRIGGER_TOLERANCE < MIN_REST:
        return Release(nominal, 0.0, (f"{name}: no rest before the release; the planned time of release is used",))
    rest_end = int((nominal - TRIGGER_TOLERANCE) * rate) if nominal is not None else _quiet_start(signals, rate, name)
    if n - rest_end < rate:
        raise InputError(
            name,
            f"ends after {n / rate:.2f} s, but the release is planned at {nominal or rest_end / rate:.2f} s",
            "Record the whole decay, or correct trigger_nominal_s in the sidecar.",
        )
    rest = signals[:rest_end]
    displaced = signals - np.median(rest, axis=0)
    noise = 1.4826 * np.median(np.abs(displaced[:rest_end]), axis=0)
    noise_floor = np.maximum(noise, 1e-9 * np.abs(displaced).max(axis=0))
    beyond = np.abs(displaced[rest_end:]) > ONSET * noise_floor
    time = _find_onset(beyond.any(axis=1), rest_end, rate)
    if time is None:
        raise InputError(
            name, "no channel moves after the planned release", "Check trigger_nominal_s, the channels and their units."
        )
    late = nominal is not None and time > nominal + 1.0
    warnings = (f"{name}: the first motion is {time - (nominal or 0):.1f} s after the planned release",) if late else ()
    if n / rate - time < 1.0:
        raise InputError(name, f"ends {n / rate - time:.2f} s after the release", "Record the whole decay.")
    onsets = tuple(_find_onset(channel, rest_end, rate) for channel in beyond.T)
    return Release(time, max(0.0, min(rest_end / rate, time - 0.1)), warnings, onsets)


def _find_onset(beyond: NDArray[np.bool_], rest_end: int, rate: float) -> float | None:
    """First of five samples of a channel if three of them exceed its noise, in the time of the record [s]."""
    sustained = np.flatnonzero(np.convolve(beyond, np.ones(5), mode="valid") >= 3)
    if not sustained.size:
        return None
    return float((rest_end + sustained[0] + np.argmax(beyond[sustained[0] :])) / rate)


def _quiet_start(signals: RealArray, rate: float, name: str) -> int:
    """Number of samples of rest at the start, until the standard deviation of half-second windows jumps."""
    width = max(int(0.5 * rate), 4)
    spread = signals[: signals.shape[0] // width * width].reshape(-1, width, signals.shape[1]).std(axis=1)
    floor = np.maximum(spread.min(axis=0, initial=np.inf), np.finfo(float).tiny)
    jump = np.any(spread > 4 * np.maximum(floor, 1e-6 * spread.max(axis=0, initial=0.0)), axis=1)
    if not jump.any() or int(np.argmax(jump)) * width < MIN_REST * rate:
        raise InputError(
            name, "has neither a planned release nor a rest at its start", "Give trigger_nominal_s in the sidecar."
        )
    return int(np.argmax(jump)) * width - width // 2
