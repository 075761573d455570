"""Ambient motion of the modes: its strength, the intervals that contain it, and the evidence for it."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.integrate
from numpy.testing import assert_allclose

from helpers.surrogate_drops import FieldRecord, build_line_modes, make_record
from pantocheck.conformance.drops.decay_kernel import FrequencyBand
from pantocheck.conformance.drops.identification_analysis import analyse_identification
from pantocheck.conformance.drops.identify import Identification, identify_modes
from pantocheck.conformance.drops.line_fit import (
    _fit_block,
    _inflation,
    find_ambient_share,
    measure_ambient_motion,
)
from pantocheck.conformance.drops.noise_estimate import LEAST_EXCESS, residual_excess, shows_motion
from pantocheck.conformance.drops.pole_refinement import build_normal_equations
from pantocheck.conformance.drops.process_noise import ProcessNoise, update_components
from pantocheck.conformance.drops.projection import (
    DataBlock,
    build_block,
    pole_columns,
    solve_residues,
    solve_weighted_residues,
    whiten,
)
from verification.tables.field_records import LINES, Disturbance

POLES = np.array([-0.03 + 5.5j, -0.035 + 5.9j, -0.04 + 12.0j])
DT, N, SENSORS = 0.05, 2400, 3


def build_noise(power: float, channels: int = SENSORS) -> ProcessNoise:
    """Equal power of all modes, the first channel moving least, and floors that rise with frequency."""
    shapes = np.array([[0.2, 1.0, -0.6], [1.0, 0.3, 0.8], [-0.4, 0.9, 0.7]], dtype=np.complex128)[:, :channels]
    floor = np.outer([1.0, 1.5], np.arange(1.0, 1.0 + channels))
    unit = shapes * floor[0]
    unit /= np.linalg.norm(unit / floor[0], axis=1, keepdims=True)
    return ProcessNoise(POLES, unit, np.full(3, power), np.full(3, 20.0), np.array([2.0, 20.0]), floor)


def build_driven_block(noise: ProcessNoise, seed: int) -> tuple[np.ndarray, DataBlock]:
    """Block of decays with the residues 400, and a random noise with the covariance of `noise`."""
    random = np.random.default_rng(seed)
    data = build_block(np.zeros((N, SENSORS)) + np.arange(N)[:, None] * 1e-9, DT, 0.3, 3.2)
    factor = np.linalg.inv(np.asarray(noise.whiten(data).whitening))
    k = data.lines.size
    normal = random.standard_normal((k, SENSORS)) + 1j * random.standard_normal((k, SENSORS))
    columns = pole_columns(POLES, data)[:, :3] @ (400 * noise.shapes.real)
    spectrum = columns[:k] + 1j * columns[k:] + np.einsum("kij,kj->ki", factor, normal)
    return POLES, replace(data, spectrum=spectrum)


def test_equal_noise_of_all_lines_gives_the_equations_of_white_noise() -> None:
    """Without ambient power and slope, the whitening divides each channel by its floor: equal up to rounding."""
    poles, data = build_driven_block(build_noise(30.0), 1)
    flat = replace(build_noise(0.0), floor=np.tile([1.0, 2.0, 3.0], (2, 1)))
    expected = build_normal_equations(poles, whiten([data], [np.array([1.0, 2.0, 3.0])]))
    found = build_normal_equations(poles, whiten([data], [flat]))
    assert found.cost == pytest.approx(expected.cost, rel=1e-9)
    assert_allclose(found.matrix, expected.matrix, rtol=1e-6, atol=1e-9 * np.abs(expected.matrix).max())
    fit, deviation = solve_weighted_residues(poles, flat.whiten(data))
    assert_allclose(fit.residues, solve_residues(poles, data).residues, rtol=1e-6, atol=1e-6)
    assert_allclose(deviation[:, 2] / deviation[:, 0], 3.0, rtol=1e-9)


def test_gauss_newton_gradient_is_the_derivative_of_the_cost() -> None:
    """Central difference of the cost over 1e-6 of a decay rate; the steepest entry to 1e-4."""
    poles, data = build_driven_block(build_noise(30.0), 2)
    white = build_noise(30.0).whiten(data)
    moved = poles + np.array([0.002, 0.0, 0.0])
    gradient = build_normal_equations(moved, [white]).gradient[0]
    step = 1e-6
    up, down = (build_normal_equations(moved + np.array([sign * step, 0, 0]), [white]).cost for sign in (-1, 1))
    assert -2 * gradient == pytest.approx((up - down) / (2 * step), rel=1e-4)


def test_power_and_floor_are_found_in_driven_lines() -> None:
    """Mean over 6 records: a power has some 20 degrees of freedom, a floor 100, so that means scatter by 7 and 4 %."""
    truth = build_noise(300.0)
    powers, floors = [], []
    for seed in range(6):
        poles, data = build_driven_block(truth, seed)
        start = replace(truth, power=np.full(3, 20.0), floor=2 * truth.floor)
        found = update_components(start, data, poles, truth.power, 20)
        powers.append(found.power.mean())
        floors.append(found.floor / truth.floor)
    assert np.mean(powers) == pytest.approx(300.0, rel=0.25)
    assert_allclose(np.mean(floors, axis=0), 1.0, rtol=0.1)


@pytest.mark.parametrize("power", [0.01, 1.0, 2.0, 20.0, 1000.0])
def test_share_of_ambient_motion_is_the_sensitivity_of_the_variance(power: float) -> None:
    """Information on a pole over its flanks, by quadrature; central differences of 1e-4 leave 1e-8."""

    def integrate(g: float) -> float:
        return float(scipy.integrate.quad(lambda x: 1 / ((1 + x**2) * (1 + g + x**2)), -np.inf, np.inf)[0])

    step = 1e-4
    slope = np.log(integrate(power * np.exp(step)) / integrate(power * np.exp(-step))) / (2 * step)
    assert find_ambient_share(power) == pytest.approx(-slope, rel=1e-5)


@pytest.mark.parametrize(("power", "quantile"), [(1e-3, 1.9600), (1e6, 2.0639)])
def test_intervals_beside_ambient_motion_are_those_of_student(power: float, quantile: float) -> None:
    """Printed quantiles of 97.5 %: normal if the floor alone counts, else that of 20 and 4 degrees of freedom."""
    noise = build_noise(power)
    poles, data = build_driven_block(noise, 1)
    assert _inflation((_fit_block(poles, data, noise),), poles[1]) == pytest.approx(quantile / 1.9600, rel=1e-4)


def make_field_record(seed: int, disturbance: Disturbance) -> FieldRecord:
    return make_record(build_line_modes(next(iter(LINES))), np.random.default_rng(seed), disturbance, minutes=1.5)


def identify(made: FieldRecord) -> Identification:
    (found,) = identify_modes((made.record,), 2.3)
    return found


def standard_errors(found: Identification, made: FieldRecord) -> np.ndarray:
    """Errors of frequency and damping ratio of the certain modes over their standard deviations."""
    errors = []
    for mode in found.modes:
        j = int(np.argmin(np.abs(made.frequency - mode.frequency_Hz)))
        if mode.certain:
            errors.append((mode.frequency_Hz - made.frequency[j]) / mode.frequency_std_Hz)
            errors.append((mode.damping_ratio - made.ratio[j]) / mode.damping_ratio_std)
    return np.array(errors)


@pytest.fixture(scope="module")
def windy() -> tuple[Identification, FieldRecord]:
    """Record with wind of 3 mm/s2 RMS at the sensors, as strong as their noise, and its modes."""
    made = make_field_record(1, Disturbance(wind=1.0))
    return identify(made), made


def test_intervals_contain_ambient_motion_and_no_spurious_mode_is_found(
    windy: tuple[Identification, FieldRecord],
) -> None:
    """20 errors, whose RMS is 1 +- 0.16; with white noise 5. The page of the field coverage has many records."""
    found, made = windy
    assert any("the line moved by itself" in text for text in found.warnings)
    assert all(np.abs(made.frequency - mode.frequency_Hz).min() < 0.004 for mode in found.modes)
    errors = standard_errors(found, made)
    assert errors.size > 17
    assert 0.6 < np.sqrt(np.mean(errors**2)) < 1.45


def test_ambient_level_stands_beside_the_noise_of_each_group(windy: tuple[Identification, FieldRecord]) -> None:
    """Wind of 3 mm/s2 RMS at the sensors, and 3 mm/s2 of white noise below 50 Hz; half of the motion is below 3 Hz."""
    found, _ = windy
    levels = measure_ambient_motion(found.fit, 0.3, 3.3)
    assert levels is not None
    assert 0.0008 < levels[0] < 0.0035
    assert levels[1] == pytest.approx(0.003 * np.sqrt(3.0 / 50.0), rel=0.2)
    groups = analyse_identification(found).groups
    assert all(group.ambient_rms > group.noise_rms > 0 for group in groups)


def test_poles_of_a_user_without_ambient_motion_are_warned_of(windy: tuple[Identification, FieldRecord]) -> None:
    """The poles above 1.5 Hz are left out: their modes are a misfit of the fit, and no wrong clock."""
    found, made = windy
    start = found.fit.poles[found.fit.poles.imag < 2 * np.pi * 1.5]
    (placed,) = identify_modes((made.record,), 2.3, start)
    assert placed.fit.misfit > 10
    assert placed.clocks == ()
    assert measure_ambient_motion(placed.fit, 0.3, 3.3) is None
    assert any("the intervals do not contain this motion" in text for text in placed.warnings)


def test_poles_of_a_user_keep_their_number_beside_ambient_motion(windy: tuple[Identification, FieldRecord]) -> None:
    """The identified poles, moved by 1 % of their decay rates, return to themselves with the same intervals."""
    found, made = windy
    (placed,) = identify_modes((made.record,), 2.3, found.fit.poles - 0.01 * np.abs(found.fit.poles.real))
    assert len(placed.modes) == len(found.modes)
    assert placed.fit.misfit == pytest.approx(1.0, abs=0.15)
    assert measure_ambient_motion(placed.fit, 0.3, 3.3) is not None
    assert not any("do not contain this motion" in text for text in placed.warnings)
    assert placed.search.steps[-1][0] == "refined beside ambient motion"
    certain = [(a, b) for a, b in zip(placed.modes, found.modes, strict=True) if b.certain]
    for a, b in certain:
        assert a.damping_ratio == pytest.approx(b.damping_ratio, abs=b.damping_ratio_std)
        assert a.damping_ratio_std == pytest.approx(b.damping_ratio_std, rel=0.25)


def test_calm_record_has_no_process_noise() -> None:
    made = make_field_record(1, Disturbance())
    found = identify(made)
    assert measure_ambient_motion(found.fit, 0.3, 3.3) is None
    assert residual_excess(found.fit.poles, [block.data for block in found.fit.blocks]) < LEAST_EXCESS
    assert not any("moved" in text or "white" in text for text in found.warnings)
    assert analyse_identification(found).groups[0].ambient_rms is None


@pytest.mark.parametrize(("wind", "expected"), [(0.0, False), (1.0, True)])
def test_rest_shows_motion(wind: float, expected: bool) -> None:
    record = make_field_record(3, Disturbance(wind=wind)).record
    assert shows_motion(record.signals[:900], record.rate, FrequencyBand.up_to(6.0, record.rate)) is expected
