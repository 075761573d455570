"""Equations of the page on theory, written out plainly and compared with the code."""

import re
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from pantocheck.conformance.drops.decay_kernel import decay_kernel
from pantocheck.conformance.grading.case_evaluation import observed_order
from pantocheck.conformance.quantities.bands import band_rms
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.model.fem import beam
from pantocheck.model.fem.residual_flexibility import combine_in_series, exact_stiffness
from pantocheck.model.statics.wave_factors import doppler_factor

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")


SECTIONS = {
    "Line": "tests/model/fem/test_beam.py",
    "Initial state": "tests/model/discretisation/test_initial_state.py",
    "Connectors": "tests/model/fem/test_held_stretches.py",
    "Residual flexibility": "tests/model/fem/test_residual_flexibility.py",
    "Damping": "tests/model/modal/test_modal_damping.py",
    "Pantograph and contact": "tests/model/description/test_pantograph.py",
    "Time integration": "tests/model/dynamics/test_newmark.py",
    "Active window": "tests/model/dynamics/test_active_window.py",
    "Quantities and filters": "tests/conformance/quantities/test_filters.py",
    "Uncertainty": "tests/conformance/grading/test_discretisation.py",
    "Identification of modes from a mass drop": "tests/conformance/drops/test_output_error.py",
    "Fit of a damping model": "tests/conformance/drops/test_damping_model.py",
}
"""Sections of the page, and the test of the equations of each beside those of this file."""


def test_sections_are_complete_and_end_in_files_that_exist() -> None:
    assert re.findall(r"^## (.+)$", PAGE, re.MULTILINE) == list(SECTIONS)
    assert [test for test in SECTIONS.values() if not (ROOT / test).is_file()] == []
    for section in PAGE.split("\n## ")[1:]:
        files = re.findall(r"`([\w/]+\.py)`", section.split("*Files:*")[1])
        assert files, section.split("\n")[0]
        assert [file for file in files if not (ROOT / file).is_file()] == []


def test_element_matrices_are_the_integrals_of_the_shape_functions() -> None:
    """Hermite polynomials integrated exactly; the products have degree six."""
    h, tension, bending, mass = 0.7, 20e3, 195.0, 1.35
    x = Polynomial([0, 1 / h])
    shapes = [1 - 3 * x**2 + 2 * x**3, h * (x - 2 * x**2 + x**3), 3 * x**2 - 2 * x**3, h * (x**3 - x**2)]

    def integrate(order: int) -> np.ndarray:
        parts = [shape.deriv(order) if order else shape for shape in shapes]
        return np.array([[(first * second).integ()(h) for second in parts] for first in parts])

    stiffness = bending * integrate(2) + tension * integrate(1)
    np.testing.assert_allclose(np.squeeze(beam.stiffness(h, tension, bending)), stiffness, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(np.squeeze(beam.mass(h, mass)), mass * integrate(0), rtol=1e-12, atol=1e-15)


def test_average_acceleration_with_corrected_mass_is_the_method_of_fox_and_goodwin() -> None:
    """One unknown, force-free: average acceleration with M - dt^2/6 K against the recurrence of the page."""
    mass, stiffness, dt = 2.0, 300.0, 0.05
    corrected = mass - dt**2 / 6 * stiffness
    q, v = 1.0, 0.0
    a = -stiffness * q / corrected
    path = [q]
    for _ in range(50):
        predicted, speed = q + dt * v + dt**2 / 4 * a, v + dt / 2 * a
        a = -stiffness * predicted / (corrected + dt**2 / 4 * stiffness)
        q, v = predicted + dt**2 / 4 * a, speed + dt / 2 * a
        path.append(q)
    last, now, following = np.array(path[:-2]), np.array(path[1:-1]), np.array(path[2:])
    residual = mass * (following - 2 * now + last) / dt**2 + stiffness * (following + 10 * now + last) / 12
    assert np.abs(residual).max() < 1e-10 * stiffness  # rounding


def test_period_errors_of_both_methods() -> None:
    """Frequencies of the recurrences: late by theta^2 / 12, and early by theta^4 / 480, to leading order."""
    for theta in (0.1, 0.2):
        average = 2 * np.arctan(theta / 2) / theta
        assert (1 - average) / theta**2 == pytest.approx(1 / 12, rel=0.01)
        corrected = np.arccos((1 - 5 * theta**2 / 12) / (1 + theta**2 / 12)) / theta
        assert (corrected - 1) / theta**4 == pytest.approx(1 / 480, rel=0.02)


def test_gain_of_the_filter_and_doppler_factor() -> None:
    rate, frequency = 200.0, np.array([5.0, 20.0, 30.0])
    cutoff = Filter().single_run(rate)[1]
    ratio = np.tan(np.pi * frequency / rate) / np.tan(np.pi * cutoff / rate)
    np.testing.assert_allclose(Filter().gain(frequency, rate), 1 / (1 + ratio**6), rtol=1e-9)
    assert Filter().gain(np.array([20.0]), rate)[0] == pytest.approx(10 ** (-3.0103 / 20), rel=1e-5)
    assert doppler_factor(60.0, 120.0) == pytest.approx((120 - 60) / (120 + 60))


def test_bands_partition_the_variance() -> None:
    rng = np.random.default_rng(1)
    rate, n = 500.0, 4000
    lines = np.fft.rfft(rng.normal(size=n))
    lines[np.fft.rfftfreq(n, 1 / rate) > 50] = 0
    force = 120 + np.fft.irfft(lines, n)
    squares = [band_rms(force, rate, low, high) ** 2 for low, high in ((0, 5), (5, 20), (20, 50))]
    assert sum(squares) == pytest.approx(force.var(), rel=1e-12)


def test_spring_in_series_with_the_residual_flexibility() -> None:
    """First order in frequency: at 0.1 Hz the second order is below 1e-6."""
    k, c, flexibility, beta = 1e5, 200.0, 3e-6, 1e-4
    series = combine_in_series(*(np.array([value]) for value in (k, c, flexibility, flexibility * beta)))
    omega = 2 * np.pi * 0.1
    exact = 1 / (1 / (k + 1j * omega * c) + flexibility / (1 + 1j * omega * beta))
    assert series[0][0] == pytest.approx(exact.real, rel=1e-5)
    assert series[1][0] == pytest.approx(exact.imag / omega, rel=1e-4)


def test_transform_of_a_decay() -> None:
    """The formula of the page against the fast Fourier transform of the samples."""
    dt, n = 0.01, 512
    pole = -0.4 + 2j * np.pi * 1.37
    samples = 2 * np.real((0.7 - 0.2j) * np.exp(pole * dt * np.arange(n)))
    omega = 2 * np.pi * np.arange(n // 2 + 1) / (n * dt)

    def part(amplitude: complex, root: complex) -> np.ndarray:
        return amplitude * (1 - np.exp(root * n * dt)) / (1 - np.exp((root - 1j * omega) * dt))

    np.testing.assert_allclose(decay_kernel(np.array([pole]), omega, dt, n).ravel(), part(1, pole), rtol=1e-12)
    expected = part(0.7 - 0.2j, pole) + part(0.7 + 0.2j, np.conj(pole))
    np.testing.assert_allclose(np.fft.rfft(samples), expected, rtol=1e-9, atol=1e-9)


def test_exact_deflection_under_end_forces() -> None:
    """Forces of shear and tension, and moments, at the ends of w = a + b x + c cosh(kx) + d sinh(kx)."""
    h, tension, bending = 1.3, 20e3, 195.0
    k = np.sqrt(tension / bending)

    def derivatives(x: float) -> np.ndarray:
        c, s = np.cosh(k * x), np.sinh(k * x)
        return np.array([[1, x, c, s], [0, 1, k * s, k * c], [0, 0, k**2 * c, k**2 * s], [0, 0, k**3 * s, k**3 * c]])

    start, end = derivatives(0), derivatives(h)
    forces = np.vstack(
        [
            bending * start[3] - tension * start[1],
            -bending * start[2],
            tension * end[1] - bending * end[3],
            bending * end[2],
        ]
    )
    expected = forces @ np.linalg.inv(np.vstack([start[:2], end[:2]]))
    stiffness = exact_stiffness(np.array(h), np.array(tension), np.array(bending))
    # The inverse loses six digits, because cosh(kh) is 2e5.
    np.testing.assert_allclose(stiffness, expected, rtol=1e-8, atol=1e-8 * tension)


def test_extrapolation_of_three_meshes() -> None:
    """Values f + C h^p at h = 2, 1 and 1/2: the order is p, and e is the error of the middle one."""
    value, constant, order = 26.6, 0.3, 1.7
    coarse, middle, fine = (value + constant * h**order for h in (2, 1, 0.5))
    found = observed_order(coarse, middle, fine)
    assert found == pytest.approx(order, rel=1e-9)
    assert (middle - fine) * 2**order / (2**order - 1) == pytest.approx(constant, rel=1e-9)
