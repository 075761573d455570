"""When the mass was released."""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.input_error import InputError

TRIGGER_TOLERANCE = 0.6  # the release lies within half a second of the planned one [s]
ONSET = 8.0  # times the noise at rest
LEAST_REST = 1.0  # a stretch of rest to know the noise from [s]


@dataclass(frozen=True)
class Release:
    """The release as the sensors saw it.

    Parameters
    ----------
    time : float
        When the first sensor moved [s].
    rest_end : float
        End of the rest before it [s]; 0 if the record has none.
    warnings : tuple[str, ...]
        What is doubtful.
    """

    time: float
    rest_end: float
    warnings: tuple[str, ...] = ()


def find_release(signals: RealArray, rate: float, nominal: float | None, name: str) -> Release:
    """The first sustained movement of any channel.

    Parameters
    ----------
    signals : ndarray
        (n, c).
    rate : float
        Samples per second [Hz].
    nominal : float or None
        Planned release [s]; None if not known.
    name : str
        Of the record, for messages.

    Raises
    ------
    InputError
        Nothing moves.
    """
    n = signals.shape[0]
    if nominal is not None and nominal - TRIGGER_TOLERANCE < LEAST_REST:
        return Release(nominal, 0.0, (f"{name}: no rest before the release; the planned release is taken",))
    rest_end = int((nominal - TRIGGER_TOLERANCE) * rate) if nominal is not None else _quiet_start(signals, rate, name)
    if n - rest_end < rate:
        raise InputError(
            name,
            f"ends {n / rate:.2f} s after its beginning, the release is planned at {nominal or rest_end / rate:.2f} s",
            "Record the whole decay, or correct the trigger time.",
        )
    rest = signals[:rest_end]
    moved = signals - np.median(rest, axis=0)
    noise = 1.4826 * np.median(np.abs(moved[:rest_end]), axis=0)
    quiet = np.maximum(noise, 1e-9 * np.abs(moved).max(axis=0))
    beyond = np.any(np.abs(moved[rest_end:]) > ONSET * quiet, axis=1)
    sustained = np.convolve(beyond, np.ones(5), mode="valid") >= 3
    if not sustained.any():
        raise InputError(
            name, "nothing moves after the trigger", "Check the trigger time, the channels and their units."
        )
    time = (rest_end + int(np.argmax(sustained)) + int(np.argmax(beyond[np.argmax(sustained) :]))) / rate
    late = nominal is not None and time > nominal + 1.0
    warnings = (
        (f"{name}: the first movement is {time - (nominal or 0):.1f} s after the planned release",) if late else ()
    )
    if n / rate - time < 1.0:
        raise InputError(name, f"ends {n / rate - time:.2f} s after the release", "Record the whole decay.")
    return Release(time, max(0.0, min(rest_end / rate, time - 0.1)), warnings)


def _quiet_start(signals: RealArray, rate: float, name: str) -> int:
    """Samples of rest at the beginning, where no trigger time is known: until half-second windows first leap."""
    width = max(int(0.5 * rate), 4)
    spread = signals[: signals.shape[0] // width * width].reshape(-1, width, signals.shape[1]).std(axis=1)
    floor = np.maximum(spread.min(axis=0, initial=np.inf), np.finfo(float).tiny)
    leap = np.any(spread > 4 * np.maximum(floor, 1e-6 * spread.max(axis=0, initial=0.0)), axis=1)
    if not leap.any() or int(np.argmax(leap)) * width < LEAST_REST * rate:
        raise InputError(
            name,
            "states no trigger time and has no rest before the release to see it by",
            "Give trigger_nominal_s in the sidecar.",
        )
    return int(np.argmax(leap)) * width - width // 2
