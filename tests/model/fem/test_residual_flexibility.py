"""Residual flexibility of a wire under a point force."""

import numpy as np
import pytest
from numpy.typing import NDArray

from pantocheck.model.fem import beam
from pantocheck.model.fem.residual_flexibility import (
    combine_in_series,
    element_flexibility,
    exact_stiffness,
    residual_flexibility,
    station_flexibility,
)

TENSION, BENDING_STIFFNESS = 22e3, 195.0
Array = NDArray[np.float64]


def hinged_flexibility(h: float, elements: int, at: Array, tension: float, bending_stiffness: float) -> Array:
    """Deflection per force at shares `at` of the length of the wire, with hinged ends and equal elements."""
    stiffness = np.zeros((2 * elements + 2,) * 2)
    for e in range(elements):
        stiffness[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += beam.stiffness(h, tension, bending_stiffness)
    free = np.delete(np.arange(2 * elements + 2), [0, 2 * elements])
    values = []
    for x in at * elements:
        e = min(int(x), elements - 1)
        load = np.zeros(2 * elements + 2)
        load[2 * e : 2 * e + 4] = beam.shape(x - e, h)
        values.append(load[free] @ np.linalg.solve(stiffness[np.ix_(free, free)], load[free]))
    return np.array(values)


def equal_elements(h: float, count: int, tension: float, bending_stiffness: float) -> tuple[Array, Array, Array]:
    return np.full(count, h), np.full(count, tension), np.full(count, bending_stiffness)


@pytest.mark.parametrize("bending_stiffness", [BENDING_STIFFNESS, 20.0, 2000.0])
@pytest.mark.parametrize("h", [1.0, 0.5, 0.25])
def test_coarse_mesh_with_residual_flexibility_equals_a_fine_mesh(h: float, bending_stiffness: float) -> None:
    """Along two elements; the fine mesh has a sixteenth of the length, and its own error falls with h^3 or faster."""
    count, s = 20, np.linspace(0, 1, 9)
    at = (np.concatenate([9 + s, 10 + s])) / count
    coarse = hinged_flexibility(h, count, at, TENSION, bending_stiffness)
    fine = hinged_flexibility(h / 16, 16 * count, at, TENSION, bending_stiffness)
    elements = element_flexibility(*equal_elements(h, count, TENSION, bending_stiffness))
    residual = np.array([residual_flexibility(elements[e], x) for e in (9, 10) for x in s])
    assert residual == pytest.approx(fine - coarse, abs=0.01 * (fine - coarse).max())


@pytest.mark.parametrize("s", [0.0, 0.3, 0.5, 1.0])
def test_string_with_residual_flexibility_is_exact(s: float) -> None:
    """x (L - x) / (T L) for a string of length L; without bending stiffness a mesh never reaches the kink."""
    h, count = 0.5, 20
    elements = element_flexibility(*equal_elements(h, count, TENSION, 0.0))
    length, x = h * count, h * (9 + s)
    coarse = hinged_flexibility(h, count, np.array([x / length]), TENSION, 0.0)[0]
    exact = x * (length - x) / (TENSION * length)
    assert coarse + residual_flexibility(elements[9], s) == pytest.approx(exact, rel=1e-6)


def test_exact_stiffness_of_a_short_beam_keeps_its_digits() -> None:
    """12 EI / h^3 + 6 T / 5 h at z = k h = 1e-3, where the closed form divides differences of z^4 / 12."""
    stiffness = exact_stiffness(np.array([1.0]), np.array([1.0]), np.array([1e6]))
    assert stiffness[0, 0, 0] == pytest.approx(12e6 + 1.2, rel=1e-12)


def test_residual_flexibility_is_continuous_on_an_uneven_mesh() -> None:
    """The patches of two neighbouring elements differ at their far ends only, three elements away.

    Near its end a wire is continued by its last element, which changes the result by 0.2 %.
    """
    h = np.random.default_rng(3).uniform(0.3, 0.6, 30)
    elements = element_flexibility(h, np.full(30, TENSION), np.full(30, BENDING_STIFFNESS))
    at_end, at_start = elements[:-1].sum(axis=1), elements[1:, 0]
    assert at_end == pytest.approx(at_start, rel=2e-3)
    assert at_end[3:-3] == pytest.approx(at_start[3:-3], rel=1e-6)
    stations = station_flexibility(elements)
    assert stations[1:-1] == pytest.approx((at_end + at_start) / 2, rel=1e-12)
    assert (stations > 0).all()


def test_row_without_a_wire_has_no_residual_flexibility() -> None:
    """A stitch wire on elements 10 to 19: zero elsewhere; its last stations are those of the wire."""
    h, tension, bending_stiffness = equal_elements(0.5, 30, TENSION, BENDING_STIFFNESS)
    tension[:10] = tension[20:] = 0.0
    elements = element_flexibility(h, tension, bending_stiffness)
    stations = station_flexibility(elements)
    assert not elements[:10].any()
    assert not elements[20:].any()
    assert not stations[:10].any()
    assert not stations[21:].any()
    assert stations[10:21] == pytest.approx(stations[15], rel=1e-3)


def test_parts_in_series() -> None:
    """1 / (1 / k + R); a negative transverse stiffness stays negative, a missing one stays missing."""
    stiffness, flexibility, none = np.array([2e5, 1e8, -300.0, 0.0]), np.full(4, 5e-7), np.zeros(4)
    series, damping = combine_in_series(stiffness, none, flexibility, none)
    assert series[:3] == pytest.approx(1 / (1 / stiffness[:3] + 5e-7), rel=1e-12)
    assert series[3] == 0.0
    assert not damping.any()


def test_damping_in_series_is_the_loss_of_both_parts() -> None:
    """Complex stiffness at 1 rad/s: the next order in frequency is the square of the loss factors, below 1e-6."""
    stiffness, flexibility = np.array([2e5, 5e4]), np.array([6e-7, 4e-7])
    damping, beta = np.array([200.0, 10.0]), np.array([1e-4, 3e-4])
    exact = 1 / (1 / (stiffness + 1j * damping) + flexibility / (1 + 1j * beta))
    series = combine_in_series(stiffness, damping, flexibility, flexibility * beta)
    assert series[0] == pytest.approx(exact.real, rel=1e-6)
    assert series[1] == pytest.approx(exact.imag, rel=1e-6)


def test_one_coefficient_for_all_parts_is_kept() -> None:
    """c = beta k before and after."""
    stiffness, flexibility, beta = np.array([2e5, 1e8]), np.array([6e-7, 3e-7]), 1e-4
    series = combine_in_series(stiffness, beta * stiffness, flexibility, beta * flexibility)
    assert series[1] == pytest.approx(beta * series[0], rel=1e-12)
