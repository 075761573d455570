"""What a point force bends an element between its stations."""

import numpy as np
import pytest
from scipy.linalg import solve

from pantocheck.model.fem import beam
from pantocheck.model.fem.residual_flexibility import condensed_bubbles, local_flexibility


def finely(h: float, tension: float, bending_stiffness: float, s: float, elements: int = 64) -> float:
    """Deflection per force of the same element held at both ends, cut into many."""
    piece = h / elements
    stiffness = np.zeros((2 * elements + 2,) * 2)
    for e in range(elements):
        at = slice(2 * e, 2 * e + 4)
        stiffness[at, at] += beam.stiffness(piece, tension, bending_stiffness)
    load = np.zeros(2 * elements + 2)
    load[2 * round(s * elements)] = 1.0
    free = slice(2, -2)
    return float(solve(stiffness[free, free], load[free])[2 * round(s * elements) - 2])


@pytest.mark.parametrize("s", [0.25, 0.5, 0.625, 0.875])
def test_without_tension_it_is_nearly_that_of_a_clamped_beam(s: float) -> None:
    """s^3 (1 - s)^3 h^3 / 3 EI; three smooth functions leave out part of the bend under the force, up to a quarter
    where the force is near an end and the deflection small.
    """
    exact = (s * (1 - s)) ** 3 * 0.5**3 / (3 * 195.0)
    found = local_flexibility(condensed_bubbles(0.5, 0.0, 195.0), s)
    assert 0.75 * exact < found <= exact * (1 + 1e-9)


@pytest.mark.parametrize("s", [0.25, 0.5, 0.75])
def test_with_tension_it_is_nearly_that_of_a_fine_mesh(s: float) -> None:
    """Ritz comes from below; 12 % short would be a hundredth of the contact's whole flexibility."""
    exact = finely(0.5, 22e3, 195.0, s)
    found = local_flexibility(condensed_bubbles(0.5, 22e3, 195.0), s)
    assert 0.88 * exact < found <= exact * (1 + 1e-9)


def test_a_string_and_a_station_have_none() -> None:
    """Zero by definition at the ends of an element."""
    bubble = condensed_bubbles(0.5, 22e3, 195.0)
    assert local_flexibility(bubble, 0.0) == 0.0
    assert local_flexibility(bubble, 1.0) == 0.0
    assert not condensed_bubbles(0.5, 22e3, 0.0).any()
