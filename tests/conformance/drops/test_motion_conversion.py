"""Conversion of decays whose derivatives are known in closed form."""

import numpy as np
import pytest

from pantocheck.conformance.core.units import MotionQuantity
from pantocheck.conformance.drops.repeatability import convert_motion

RATE, POLE = 50.0, 2 * np.pi * 0.9 * (-0.04 + 1j)
T = np.arange(int(80 * RATE)) / RATE - 6.0
AFTER = np.maximum(T, 0.0)
QUANTITIES: tuple[MotionQuantity, ...] = ("displacement", "velocity", "acceleration")
POLYNOMIALS = (AFTER**3, 3 * AFTER**2 + POLE * AFTER**3, 6 * AFTER + 6 * POLE * AFTER**2 + POLE**2 * AFTER**3)
MOTION = {q: (p * np.exp(POLE * AFTER)).imag[:, None] for q, p in zip(QUANTITIES, POLYNOMIALS, strict=True)}
"""t^3 exp(p t) after the release and its derivatives, which have no step at the release."""


@pytest.mark.parametrize("given", QUANTITIES)
@pytest.mark.parametrize("wanted", QUANTITIES)
def test_decay_becomes_its_derivative_or_integral(given: MotionQuantity, wanted: MotionQuantity) -> None:
    """Within 1 % of the largest value, because the high-pass removes the little content below 0.08 Hz."""
    # An offset of the sensor changes nothing else: it fades in the high-pass at the ends of the record.
    offset = 0.0 if given == wanted else 0.1
    result = convert_motion(MOTION[given] + offset, RATE, given, wanted)
    shown = (T > -2.0) & (T < 60.0)
    assert np.abs(result - MOTION[wanted])[shown].max() < 0.01 * np.abs(MOTION[wanted]).max()


def test_slow_drift_is_left_out() -> None:
    """A drift with a period of 50 s, whose integral would have an amplitude of 8 m/s, and that of a mode 0.18 m/s."""
    drift = np.sin(2 * np.pi * 0.02 * T)[:, None]
    result = convert_motion(drift, RATE, "acceleration", "velocity")
    assert np.abs(result[(T > 10) & (T < 60)]).max() < 0.4
