"""Frequency responses of a line to a mass drop. The release is an upward step force m g at the position of the mass.

A step of height F at t = 0 has the transform F / (i w), so the accelerance of a sensor is

    H(w) = i w A(w) / (m g)      [m/s2/N],        A(w) the transform of its acceleration from the release on.
"""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.units import STANDARD_GRAVITY
from pantocheck.conformance.drops.decay_kernel import filter_gain
from pantocheck.conformance.drops.line_fit import LineFit, RecordFit

POWER_OF_OMEGA = {"acceleration": 0, "velocity": 1, "displacement": 2}
"""Power of i w that converts the transform of a quantity to that of the acceleration."""


@dataclass(frozen=True)
class FrequencyResponse:
    """Accelerance of the sensors of one record [m/s2/N], each (k, c), at k frequencies [Hz].

    The measured response is that from the release to the end of the linear decay. The identified response is that of
    the poles, extrapolated back to the release.
    """

    frequency: RealArray
    measured: ComplexArray
    identified: ComplexArray


def compute_frequency_response(fit: LineFit, record_fit: RecordFit) -> FrequencyResponse | None:
    """Compute the frequency responses of one record of a fit; None if its mass is not known."""
    decay, linear = record_fit.decay, record_fit.decay.linear
    record, columns = decay.record, list(decay.columns)
    if record.drop.mass is None:
        return None
    begin, end = (int(t * record.rate) for t in (decay.release.time, linear.end))
    signals = record.signals[begin:end, columns]
    rest = record.signals[: max(int(decay.release.rest_end * record.rate), 1), columns]
    n = signals.shape[0]
    frequency = np.asarray(np.fft.rfftfreq(n, 1 / record.rate), dtype=np.float64)
    used = (frequency >= fit.band.low) & (frequency <= fit.band.high)
    omega: RealArray = 2 * np.pi * frequency[used]
    to_accelerance = (1j * omega) ** (1 + POWER_OF_OMEGA[record.quantity]) / (record.drop.mass * STANDARD_GRAVITY)
    offset = rest.mean(axis=0) if rest.shape[0] > 10 else signals.mean(axis=0)
    measured = np.fft.rfft(signals - offset, axis=0)[used] / record.rate
    to_release = np.exp(-fit.poles * (linear.first - decay.release.time))
    to_release = to_release / filter_gain(linear.taps, fit.poles, linear.rate)
    inside = np.abs(fit.poles) < 2 * np.pi * fit.band.fitted
    residues = (record_fit.residues * to_release[:, None])[inside]
    poles, duration = fit.poles[inside], n / record.rate
    identified = _transform(poles, omega, duration) @ residues
    identified += _transform(poles.conj(), omega, duration) @ residues.conj()
    return FrequencyResponse(frequency[used], measured * to_accelerance[:, None], identified * to_accelerance[:, None])


def _transform(poles: ComplexArray, omega: RealArray, duration: float) -> ComplexArray:
    """Transform of exp(lambda t) over a duration [s], (k, m) [s]."""
    difference = poles[None, :] - 1j * omega[:, None]
    return np.asarray(np.expm1(difference * duration) / difference)
