"""Residual flexibility of an element under a point force."""

import numpy as np
import pytest
from scipy.linalg import solve

from pantocheck.model.fem import beam
from pantocheck.model.fem.residual_flexibility import condensed_bubbles, local_flexibility


def fine_mesh_flexibility(h: float, tension: float, bending_stiffness: float, s: float, elements: int = 64) -> float:
    """Deflection per force of an element with clamped ends, divided into many elements."""
    piece = h / elements
    stiffness = np.zeros((2 * elements + 2,) * 2)
    for e in range(elements):
        unknowns = slice(2 * e, 2 * e + 4)
        stiffness[unknowns, unknowns] += beam.stiffness(piece, tension, bending_stiffness)
    load = np.zeros(2 * elements + 2)
    load[2 * round(s * elements)] = 1.0
    free = slice(2, -2)
    return float(solve(stiffness[free, free], load[free])[2 * round(s * elements) - 2])


@pytest.mark.parametrize("s", [0.25, 0.5, 0.625, 0.875])
def test_residual_flexibility_without_tension_approaches_a_clamped_beam(s: float) -> None:
    """s^3 (1 - s)^3 h^3 / 3 EI; three smooth functions miss a part of it, up to a quarter
    for a force near an end, where the deflection is small.
    """
    exact = (s * (1 - s)) ** 3 * 0.5**3 / (3 * 195.0)
    flexibility = local_flexibility(condensed_bubbles(0.5, 0.0, 195.0), s)
    assert 0.75 * exact < flexibility <= exact * (1 + 1e-9)


@pytest.mark.parametrize("s", [0.25, 0.5, 0.75])
def test_residual_flexibility_with_tension_approaches_a_fine_mesh(s: float) -> None:
    """Ritz's method converges from below; 12 % is a hundredth of the total flexibility of the contact."""
    exact = fine_mesh_flexibility(0.5, 22e3, 195.0, s)
    flexibility = local_flexibility(condensed_bubbles(0.5, 22e3, 195.0), s)
    assert 0.88 * exact < flexibility <= exact * (1 + 1e-9)


def test_residual_flexibility_vanishes_for_strings_and_at_stations() -> None:
    """Zero by definition at the ends of an element."""
    bubble = condensed_bubbles(0.5, 22e3, 195.0)
    assert local_flexibility(bubble, 0.0) == 0.0
    assert local_flexibility(bubble, 1.0) == 0.0
    assert not condensed_bubbles(0.5, 22e3, 0.0).any()
