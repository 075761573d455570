"""Pantographs: natural frequencies, apparent mass, modes against chain."""

import numpy as np
import pytest
from scipy.linalg import eigh

from pantocheck.model.description.pantograph import (
    Pantograph,
    apparent_mass,
    build_chain,
    frequencies,
    from_modes,
    preload_springs,
)

MASSES, STIFFNESS, DAMPING = (np.array(v) for v in ([6.0, 9.0, 7.5], [160.0, 15500.0, 7000.0], [100.0, 0.1, 45.0]))


def pantograph(damping: float = 1.0) -> Pantograph:
    """The EN 50318:2018 chain, with its damping multiplied."""
    return build_chain(MASSES, STIFFNESS, damping * DAMPING, 169.0, 0, 50e3)


def test_frequencies_of_the_undamped_chain_are_the_published_ones() -> None:
    """Base fixed, head free: 0.4227, 5.687, 10.980 Hz, to half a unit of the fourth digit."""
    assert frequencies(pantograph()) == pytest.approx([0.4227, 5.687, 10.980], rel=1.2e-4)


def test_frequencies_are_the_roots_of_the_characteristic_polynomial() -> None:
    """Polynomial for masses a, b, c on springs p, q, r, without the assembly of the package."""
    (a, b, c), (p, q, r) = MASSES, STIFFNESS
    lower, middle, upper = np.poly1d([-a, p + q]), np.poly1d([-b, q + r]), np.poly1d([-c, r])
    roots = np.sort((lower * middle * upper - r**2 * lower - q**2 * upper).roots)
    np.testing.assert_allclose(frequencies(pantograph()), np.sqrt(roots) / (2 * np.pi), rtol=1e-10)


def test_apparent_mass_far_above_the_resonances_is_the_head() -> None:
    """The next term is -(r + iwc)/w^2 = 45i/w: 7e-5 kg at 100 kHz."""
    assert apparent_mass(pantograph(), np.array([1e5]))[0] == pytest.approx(7.5, abs=1e-4)


def test_apparent_mass_far_below_the_resonances_is_the_static_stiffness() -> None:
    """Springs in series, -k / w^2; at 1e-4 Hz inertia and dampers are below (w / w1)^2 and w c / k = 4e-4 of it."""
    omega = 2 * np.pi * 1e-4
    series = 1 / (1 / STIFFNESS).sum()
    assert apparent_mass(pantograph(), np.array([1e-4]))[0] == pytest.approx(-series / omega**2, rel=1e-3)


def test_apparent_mass_vanishes_at_the_frequencies() -> None:
    """Without damping the response of the head is unbounded at a natural frequency."""
    undamped = pantograph(damping=0.0)
    assert np.abs(apparent_mass(undamped, frequencies(undamped))).max() < 1e-6


def test_from_modes_gives_the_apparent_mass_of_the_chain() -> None:
    """One system as a chain and by its modes, with stiffness-proportional damping: equal apparent mass and rest."""
    beta = 1e-3
    by_chain = preload_springs(build_chain(MASSES, STIFFNESS, beta * STIFFNESS, 169.0, 0, 50e3), np.full(3, 0.055))
    w2, shapes = eigh(by_chain.stiffness, by_chain.mass)
    omega = np.sqrt(w2)
    by_modes = from_modes(
        omega / (2 * np.pi), beta * omega / 2, shapes.T @ by_chain.head, shapes.T @ by_chain.force, 169.0, 50e3
    )
    f = np.geomspace(0.1, 100.0, 50)
    np.testing.assert_allclose(apparent_mass(by_modes, f), apparent_mass(by_chain, f), rtol=1e-9)
    np.testing.assert_allclose(frequencies(by_modes), frequencies(by_chain), rtol=1e-9)
    rest = [float(p.head @ np.linalg.solve(p.stiffness, p.force)) for p in (by_modes, by_chain)]
    assert rest[0] == pytest.approx(rest[1], rel=1e-9)


def test_preload_springs_leaves_the_chain_at_rest_at_the_unstretched_height() -> None:
    """Without uplift force no force moves the chain from that height."""
    at_rest = preload_springs(build_chain(MASSES, STIFFNESS, DAMPING, 0.0, 0, 50e3), np.full(len(MASSES), 0.055))
    np.testing.assert_allclose(np.linalg.solve(at_rest.stiffness, at_rest.force), 0.055, rtol=1e-9)


def test_uplift_force_acts_on_the_chosen_mass() -> None:
    """On the head it stretches every spring, on the lowest mass only the first."""
    low, high = (build_chain(MASSES, STIFFNESS, DAMPING, 100.0, mass, 50e3) for mass in (0, 2))
    np.testing.assert_allclose(np.linalg.solve(low.stiffness, low.force), 100.0 / STIFFNESS[0], rtol=1e-9)
    np.testing.assert_allclose(np.linalg.solve(high.stiffness, high.force), np.cumsum(100.0 / STIFFNESS), rtol=1e-9)
