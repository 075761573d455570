"""Frequency responses of the transient drop: the release is a step force m g, upward, where the mass hung.

A step of height F at t = 0 has the transform F / (i w), so the accelerance of a sensor is

    H(w) = i w A(w) / (m g)      [m/s2/N],        A(w) the transform of its acceleration from the release on.
"""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import ComplexArray, RealArray
from pantocheck.conformance.identification.decay_filters import filter_gain
from pantocheck.conformance.identification.identify import Identification
from pantocheck.conformance.input_files.units import STANDARD_GRAVITY

POWER_OF_OMEGA = {"acceleration": 0, "velocity": 1, "displacement": 2}


@dataclass(frozen=True)
class FrequencyResponse:
    """Accelerance of the sensors of one record.

    Parameters
    ----------
    record : str
        Name.
    channels : tuple[str, ...]
        (c,) names.
    frequency : (k,) ndarray
        [Hz].
    measured : (k, c) complex ndarray
        From the release to the end of the linear stretch [m/s2/N].
    identified : (k, c) complex ndarray
        Of the identified modes, carried back to the release [m/s2/N].
    """

    record: str
    channels: tuple[str, ...]
    frequency: RealArray
    measured: ComplexArray
    identified: ComplexArray


def compute_frequency_response(found: Identification, r: int) -> FrequencyResponse | None:
    """Frequency responses of one record.

    Parameters
    ----------
    found : Identification
        The identification.
    r : int
        Which of its records.

    Returns
    -------
    FrequencyResponse or None
        None if the mass is not known.
    """
    one = found.prepared[r]
    record, stretch = one.record, one.stretch
    if record.drop.mass is None:
        return None
    begin, end = (int(t * record.rate) for t in (one.release.time, stretch.end))
    signals = record.signals[begin:end, list(one.columns)]
    rest = record.signals[: max(int(one.release.rest_end * record.rate), 1), list(one.columns)]
    n = signals.shape[0]
    frequency = np.asarray(np.fft.rfftfreq(n, 1 / record.rate), dtype=np.float64)
    used = (frequency >= found.band.low) & (frequency <= found.band.high)
    omega: RealArray = 2 * np.pi * frequency[used]
    to_accelerance = (1j * omega) ** (1 + POWER_OF_OMEGA[record.quantity]) / (record.drop.mass * STANDARD_GRAVITY)
    offset = rest.mean(axis=0) if rest.shape[0] > 10 else signals.mean(axis=0)
    measured = np.fft.rfft(signals - offset, axis=0)[used] / record.rate
    b, columns = found.block_of[r], found.columns[r]
    back = np.exp(-found.poles * (stretch.first - one.release.time)) / filter_gain(
        stretch.taps, found.poles, stretch.rate
    )
    inside = np.abs(found.poles) < 2 * np.pi * found.band.fitted
    residues = (found.fits[b].residues[:, columns] * back[:, None])[inside]
    poles, duration = found.poles[inside], n / record.rate
    response = _transform(poles, omega, duration) @ residues
    response += _transform(poles.conj(), omega, duration) @ residues.conj()
    return FrequencyResponse(
        record.name,
        one.channel_names,
        frequency[used],
        measured * to_accelerance[:, None],
        response * to_accelerance[:, None],
    )


def _transform(poles: ComplexArray, omega: RealArray, duration: float) -> ComplexArray:
    """Transform of exp(lambda t) over the record, (k, m) [s]."""
    difference = poles[None, :] - 1j * omega[:, None]
    return np.asarray(np.expm1(difference * duration) / difference)
