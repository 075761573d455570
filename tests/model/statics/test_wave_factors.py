"""Wave factors: limits with known values."""

import pytest

from pantocheck.model import Kind, Wire
from pantocheck.model.statics.wave_factors import (
    amplification_coefficient,
    doppler_factor,
    impedance,
    reflection_coefficient,
)

CONTACT = Wire("contact", Kind.CONTACT_WIRE, 0.0, 60.0, 22e3, 1.35, 195.0)
MESSENGER = Wire("messenger", Kind.MESSENGER_WIRE, 0.0, 60.0, 16e3, 1.08, 131.7)


def test_impedance_of_two_wires_is_the_sum_by_hand() -> None:
    assert impedance([CONTACT]) == pytest.approx(172.3369, rel=1e-6)  # sqrt(22000 x 1.35)
    assert impedance([CONTACT, CONTACT]) == pytest.approx(2 * impedance([CONTACT]))


def test_reflection_is_half_for_equal_wires_and_one_for_an_infinite_messenger() -> None:
    assert reflection_coefficient([CONTACT], [CONTACT]) == pytest.approx(0.5)
    heavy = Wire("messenger", Kind.MESSENGER_WIRE, 0.0, 60.0, 1e30, 1.0, 0.0)
    assert reflection_coefficient([CONTACT], [heavy]) == pytest.approx(1.0)
    assert reflection_coefficient([CONTACT], [MESSENGER]) == pytest.approx(131.4534 / (131.4534 + 172.3369), rel=1e-6)


def test_doppler_factor_is_one_at_rest_and_zero_at_the_wave_speed() -> None:
    assert doppler_factor(0.0, 127.0) == 1.0
    assert doppler_factor(127.0, 127.0) == 0.0
    assert doppler_factor(127.0 / 2, 127.0) == pytest.approx(1 / 3)
    assert amplification_coefficient(0.4, 0.2) == pytest.approx(2.0)
