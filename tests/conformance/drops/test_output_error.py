"""Refinement by output error: gradient, resolution and uncertainty."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.drops.model_order import _are_equal, select_poles
from pantocheck.conformance.drops.pole_refinement import build_normal_equations, refine_poles
from pantocheck.conformance.drops.projection import build_block, estimate_noise, solve_residues, whiten
from pantocheck.conformance.drops.sensor_clocks import build_equations
from pantocheck.conformance.drops.start_poles import find_start_poles

DT = 0.05


def complex_poles(*pairs: tuple[float, float]) -> ComplexArray:
    frequency, damping = np.array(pairs).T
    return np.asarray(2 * np.pi * frequency * (-damping + 1j * np.sqrt(1 - damping**2)))


def build_decays(
    random: np.random.Generator, poles: ComplexArray, duration: float, channels: int, noise: float
) -> RealArray:
    n = int(duration / DT)
    residues = random.standard_normal((poles.size, channels)) + 1j * random.standard_normal((poles.size, channels))
    clean = 2 * (np.exp(np.outer(np.arange(n) * DT, poles)) @ residues).real
    return np.asarray(clean + noise * random.standard_normal((n, channels)))


def test_gradient_is_that_of_the_cost() -> None:
    """Kaufman's gradient is half the central difference of the cost: the residual is orthogonal to the model."""
    random = np.random.default_rng(1)
    true = complex_poles((0.9, 0.005), (0.95, 0.004), (1.7, 0.003))
    data = [build_block(build_decays(random, true, 60, 2, 0.01), DT, 0.3, 6.0)]
    disturbed = true * (1 + 1e-4)
    gradient = build_normal_equations(disturbed, data).gradient
    step = 1e-6
    for j in range(disturbed.size):
        for part, direction in ((j, -1.0), (disturbed.size + j, 1j)):
            moved = np.zeros(disturbed.size, dtype=complex)
            moved[j] = step * direction
            difference = (
                build_normal_equations(disturbed + moved, data).cost
                - build_normal_equations(disturbed - moved, data).cost
            )
            assert -difference / (4 * step) == pytest.approx(
                gradient[part], rel=1e-3, abs=1e-3 * np.abs(gradient).max()
            )
    # A slow clock lowers all poles of its sensor by one share; the share of the decay is 5e-5 of this gradient.
    block: Any = SimpleNamespace(data=data[0], noise=np.ones(2), process=None)
    channels = (SimpleNamespace(sensor=1),) * 2
    record = SimpleNamespace(decay=SimpleNamespace(channels=channels), columns=slice(0, 2), block=block)
    fit: Any = SimpleNamespace(poles=disturbed, records=(record,))
    slow, fast = (build_normal_equations(disturbed * share, data).cost for share in (1 - step, 1 + step))
    assert build_equations(fit, block, [1]).gradient[-1] == pytest.approx((fast - slow) / (4 * step), rel=1e-6)


def test_start_poles_of_a_clean_decay_are_exact_and_found_once() -> None:
    """Without noise a subspace method is limited by its 60 dB filter alone: a thousandth of the damping."""
    true = complex_poles((0.9, 0.005), (1.3, 0.003), (2.2, 0.002))
    random = np.random.default_rng(2)
    start = find_start_poles([build_decays(random, true, 120, 2, 1e-7)], 1 / DT, 0.3, 4.3)
    for pole in true:
        nearest = start[np.argmin(np.abs(start - pole))]
        assert abs(nearest - pole) < 1e-3 * abs(pole.real)
    # Bands meet at 1.3, 2.3 and 3.3 Hz.
    # Poles 0.05 Hz below and above an edge are also in the flank of the other band. In a clean decay both bands would
    # give the pole to a tenth of its damping.
    true = complex_poles((1.25, 0.003), (2.25, 0.002), (2.35, 0.002), (3.35, 0.003))
    start = find_start_poles([build_decays(np.random.default_rng(2), true, 120, 2, 1e-7)], 1 / DT, 0.3, 4.3)
    found = [int(np.sum(np.abs(start - pole) < 0.1 * abs(pole.real))) for pole in true]
    assert found == [1, 1, 1, 1]


@pytest.mark.parametrize("distance", [0.003, 0.006])
def test_poles_of_a_close_pair_are_separated(distance: float) -> None:
    """Pair 3 and 6 mHz apart at 0.1 % in four minutes: both poles within five standard deviations of the truth."""
    random = np.random.default_rng(3)
    true = complex_poles((2.5, 0.001), (2.5 + distance, 0.001), (3.1, 0.002))
    data = [build_block(build_decays(random, true, 240, 4, 0.02), DT, 0.3, 6.0)]
    selection = select_poles(complex_poles((2.5015, 0.0015), (3.1, 0.002)), data)
    assert selection.poles.size == 3
    refined = refine_poles(selection.poles, whiten(data, selection.noise))
    std = np.sqrt(np.diag(refined.covariance))
    assert np.all(np.abs(refined.poles.real - true.real) < 5 * std[:3])
    assert np.all(np.abs(refined.poles.imag - true.imag) < 5 * std[3:])


def test_noise_alone_adds_no_pole() -> None:
    """One false pole in a thousand records is allowed; twenty records must show none."""
    for seed in range(20):
        random = np.random.default_rng(seed)
        true = complex_poles((1.5, 0.004))
        data = [build_block(build_decays(random, true, 60, 2, 0.05), DT, 0.3, 6.0)]
        assert select_poles(true, data).poles.size == 1


def test_standard_deviations_are_those_of_repeated_noise() -> None:
    """Standardised errors of 60 records, 3 modes, 2 parameters each: unit variance within four standard errors."""
    true = complex_poles((0.9, 0.005), (0.92, 0.004), (1.7, 0.003))
    standardised = []
    for seed in range(60):
        random = np.random.default_rng(seed)
        fixed = np.random.default_rng(99)
        residues = fixed.standard_normal((3, 2)) + 1j * fixed.standard_normal((3, 2))
        n = int(100 / DT)
        clean = 2 * (np.exp(np.outer(np.arange(n) * DT, true)) @ residues).real
        data = [build_block(clean + 0.05 * random.standard_normal(clean.shape), DT, 0.3, 6.0)]
        noise = [estimate_noise(solve_residues(true, data[0]), 3, data[0])]
        refined = refine_poles(true, whiten(data, noise))
        error = np.concatenate([-(refined.poles - true).real, (refined.poles - true).imag])
        standardised.append(error / np.sqrt(np.diag(refined.covariance)))
    variance = np.var(standardised)
    assert variance == pytest.approx(1.0, abs=4 * np.sqrt(2 / 360))


# Model order: the search ends where the poles do not change any more.
@pytest.mark.parametrize(("difference", "equal"), [(0.004, True), (0.006, False), (-0.004, True), (-0.006, False)])
@pytest.mark.parametrize("direction", [1.0, 1j])
def test_poles_are_equal_to_one_percent_of_their_decay_rate(difference: float, equal: bool, direction: complex) -> None:
    """A decay rate of 0.5 1/s: up to 0.005 1/s in damping or frequency; every pole counts."""
    poles = np.array([-0.5 + 7.0j, -0.5 + 14.0j])
    other = poles + np.array([0.0, difference * direction])
    assert _are_equal(other, poles) == equal
    assert not _are_equal(poles[:1], poles)
