"""Deflection under a constant force that moves along a tensioned beam, against its modes."""

import pytest

from pantocheck.model.fem import beam
from verification.guide.comparisons import relative_rms
from verification.guide.topics.bare_wires import WIRE_BENDING, WIRE_MASS, WIRE_TENSION
from verification.guide.topics.closed_forms import moving_load_deflection
from verification.guide.topics.moving_load import simulate_moving_load


@pytest.mark.parametrize(("share", "tolerance"), [(0.3, 2.5e-4), (0.7, 4e-4), (0.9, 9e-4)])
def test_deflection_under_a_moving_load_agrees_with_modes(share: float, tolerance: float) -> None:
    """Default mesh and time step; root mean square of the error over that of the deflection, plus a quarter.

    The speed is a share of the wave speed. The error is that of waves shorter than four elements.
    """
    speed = share * beam.wave_speed(WIRE_TENSION, WIRE_MASS)
    times, deflection = simulate_moving_load(speed)
    exact = 100.0 * moving_load_deflection(times, speed, (100.0, WIRE_TENSION, WIRE_MASS, WIRE_BENDING))
    assert relative_rms(deflection, exact) < tolerance
