"""Bending stiffness of a worn wire against closed forms and a numerical integral."""

import numpy as np
import pytest

from pantocheck.model.description.worn_wire import worn_stiffness_share


def test_half_a_round_bar_has_the_stiffness_of_a_half_circle() -> None:
    """Second moment of a half circle about its centroid: r4 (pi/8 - 8 / (9 pi)), a textbook value."""
    expected = (np.pi / 8 - 8 / (9 * np.pi)) / (np.pi / 4)
    assert worn_stiffness_share(0.5) == pytest.approx(expected, rel=1e-12)
    assert worn_stiffness_share(0.0) == 1.0


@pytest.mark.parametrize("wear_share", [0.05, 0.2, 0.35])
def test_worn_stiffness_is_the_integral_over_the_worn_section(wear_share: float) -> None:
    """Strips of the circle above the worn flat; a million strips integrate to 1e-6."""
    z = np.linspace(-1.0, 1.0, 2_000_001)
    width = 2 * np.sqrt(np.maximum(1 - z**2, 0.0))
    area = np.cumsum(width) * (z[1] - z[0])
    kept = area >= wear_share * np.pi
    centroid = np.average(z[kept], weights=width[kept])
    second_moment = np.sum(width[kept] * (z[kept] - centroid) ** 2) * (z[1] - z[0])
    assert worn_stiffness_share(wear_share) == pytest.approx(second_moment / (np.pi / 4), rel=1e-5)
