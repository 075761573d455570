"""Splines against those of scipy, and against cubics, which a spline repeats."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from pantocheck.model.description.cubic_spline import Ends, evaluate_polynomials, fit_polynomials


@pytest.mark.parametrize(("ends", "same"), [("not a knot", "not-a-knot"), ("horizontal", "clamped")])
@pytest.mark.parametrize("size", [4, 5, 200])
def test_spline_is_that_of_scipy(ends: Ends, same: str, size: int) -> None:
    random = np.random.default_rng(size)
    x, y = np.cumsum(random.uniform(0.5, 2.0, size)), random.standard_normal(size)
    places = np.linspace(x[0] - 1, x[-1] + 1, 999)
    other = CubicSpline(x, y, bc_type=same)
    polynomials = fit_polynomials(x, y, ends)
    assert polynomials == pytest.approx(other.c.T, abs=1e-11)
    assert evaluate_polynomials(x, polynomials, places) == pytest.approx(other(places), abs=1e-10)


def test_two_points_with_horizontal_ends() -> None:
    assert fit_polynomials(np.array([0.0, 1.0]), np.array([0.0, 1.0]), "horizontal").tolist() == [[-2.0, 3.0, 0.0, 0.0]]


def test_cubic_is_repeated_between_and_beyond_the_points() -> None:
    x = np.array([0.0, 1.0, 1.5, 4.0, 5.0])
    found = evaluate_polynomials(x, fit_polynomials(x, x**3 - x, "not a knot"), np.array([-1.0, 2.0, 7.0]))
    assert found == pytest.approx([0.0, 6.0, 336.0], rel=1e-12)
