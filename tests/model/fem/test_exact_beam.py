"""Exact static stiffness of a tensioned beam."""

import numpy as np
import pytest

from pantocheck.model.fem import beam
from pantocheck.model.fem.residual_flexibility import exact_stiffness

TENSION, BENDING_STIFFNESS = 22e3, 195.0


@pytest.mark.parametrize("h", [0.03, 0.5, 5.0])
def test_exact_stiffness_equals_a_divided_element(h: float) -> None:
    """200 elements condensed to their ends; 1e-5: their error at 5 m, where each spans a quarter of a decay length."""
    count = 200
    stiffness = np.zeros((2 * count + 2,) * 2)
    for e in range(count):
        stiffness[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += beam.stiffness(h / count, TENSION, BENDING_STIFFNESS)
    ends, inner = np.array([0, 1, -2, -1]), slice(2, -2)
    coupling = stiffness[inner][:, ends]
    condensed = stiffness[np.ix_(ends, ends)] - coupling.T @ np.linalg.solve(stiffness[inner, inner], coupling)
    exact = exact_stiffness(*(np.array(value) for value in (h, TENSION, BENDING_STIFFNESS)))
    scale = np.sqrt(np.outer(np.diag(exact), np.diag(exact)))
    assert exact / scale == pytest.approx(condensed / scale, abs=1e-5)


def test_exact_stiffness_of_a_long_element_is_that_of_a_shorter_string() -> None:
    """T / (L - 2 / k): each clamped end shortens the string by a decay length 1 / k; no function overflows."""
    h = np.array([200.0, 5000.0])
    decay = np.sqrt(BENDING_STIFFNESS / TENSION)
    exact = exact_stiffness(h, np.full(2, TENSION), np.full(2, BENDING_STIFFNESS))
    assert exact[:, 0, 0] == pytest.approx(TENSION / (h - 2 * decay), rel=1e-9)
