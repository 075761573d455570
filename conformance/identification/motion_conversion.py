"""Conversion between displacement, velocity and acceleration by powers of i w in the frequency domain."""

import numpy as np
import scipy.fft

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.frequency_response import POWER_OF_OMEGA
from pantocheck.conformance.input_files.units import MotionQuantity

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
    power = POWER_OF_OMEGA[given] - POWER_OF_OMEGA[wanted]
    if power == 0:
        return samples
    n = scipy.fft.next_fast_len(samples.shape[0] + int(PADDING * rate), real=True)
    frequency = scipy.fft.rfftfreq(n, 1 / rate)
    share = np.clip((frequency - HIGH_PASS[0]) / (HIGH_PASS[1] - HIGH_PASS[0]), 0.0, 1.0)
    factor = np.sin(np.pi / 2 * share) ** 2 * (2j * np.pi * np.maximum(frequency, 1 / n)) ** power
    spectrum = scipy.fft.rfft(samples - samples.mean(axis=0), n, axis=0) * factor[:, None]
    return np.asarray(scipy.fft.irfft(spectrum, n, axis=0)[: samples.shape[0]])
