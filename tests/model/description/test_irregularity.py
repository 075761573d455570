"""Irregularity of a contact wire: spectrum of realised heights, spline, and response of a pantograph."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import periodogram

from helpers.lines import DAMPED, PANTOGRAPH_2002, bare_wire, simple_line, twin_line
from helpers.step_differences import THREE_MASSES, largest_differences
from pantocheck.model import Irregularity, Passage, SpectralDensity, discretise, realise_irregularity, simulate_passage
from pantocheck.model.description.catenary import Catenary
from pantocheck.model.description.irregularity_spline import irregularity_height
from pantocheck.model.description.pantograph import Pantograph
from pantocheck.model.statics.elasticity import height_under_forces

SPECTRUM = SpectralDensity((0.02, 0.1, 0.5), (4e-5, 1e-5, 1e-7))
"""Density that falls over two and a half decades [1/m, m3]; chosen for these tests."""


def with_irregularity(catenary: Catenary, *irregularities: Irregularity) -> Catenary:
    """Same line with an irregularity of each of its contact wires."""
    contact = [
        replace(wire, irregularity=irregularity)
        for wire, irregularity in zip(catenary.contact_wires, irregularities, strict=True)
    ]
    return replace(catenary, wires=(*contact, *(wire for wire in catenary.wires if wire not in catenary.contact_wires)))


def test_spectrum_of_realised_heights_is_the_requested_one() -> None:
    """A sum of cosines on the grid of the line holds the density at every frequency; rounding only."""
    length = 500.0
    irregularity = realise_irregularity(SPECTRUM, length, seed=7)
    heights, points = np.array(irregularity.height[:-1]), len(irregularity.height) - 1
    assert points == 16 * 0.5 * length  # of the shortest wavelength of 2 m
    frequency, density = periodogram(heights, points / length, detrend=False)
    inside = (frequency > 0.0201) & (frequency < 0.4999)
    requested = np.exp(np.interp(np.log(frequency[inside]), np.log(SPECTRUM.frequency), np.log(SPECTRUM.density)))
    np.testing.assert_allclose(density[inside], requested, rtol=1e-9)
    assert density[(frequency < 0.0199) | (frequency > 0.5001)].max() < 1e-20
    # The variance is the integral of the density; the grid of 1 / 500 m resolves it to 6 % (its lowest ordinate).
    fine = np.geomspace(0.02, 0.5, 10_000)
    integral = np.trapezoid(np.exp(np.interp(np.log(fine), np.log(SPECTRUM.frequency), np.log(SPECTRUM.density))), fine)
    assert heights.var() == pytest.approx(integral, rel=0.06)


def test_seed_decides_the_heights() -> None:
    """PCG64 gives the same raw values in every version of numpy: the first height is stated here."""
    first, again, other = (realise_irregularity(SPECTRUM, 200.0, seed) for seed in (1, 1, 2))
    assert first == again
    assert np.abs(np.array(first.height) - np.array(other.height)).max() > 1e-3
    assert first.height[0] == pytest.approx(-0.0009448342495094232, rel=1e-9)


def test_spline_through_points_of_a_wave_is_that_wave() -> None:
    """With 16 points per wavelength a cubic spline errs by 5/384 (2 pi / 16)^4 = 0.03 % of the amplitude; no kink."""
    position = np.arange(0.0, 40.5, 0.5)
    irregularity = Irregularity(tuple(position), tuple(0.01 * np.cos(2 * np.pi * position / 8)))
    x = np.linspace(-1.0, 41.0, 4001)
    height = irregularity_height(irregularity, x)
    np.testing.assert_allclose(height, 0.01 * np.cos(2 * np.pi * np.clip(x, 0, 40) / 8), atol=3.2e-6)
    slope = np.gradient(height, x)
    assert np.abs(np.diff(slope)).max() < 1.1 * 0.01 * (2 * np.pi / 8) ** 2 * (x[1] - x[0])


@pytest.mark.parametrize("pantograph", [PANTOGRAPH_2002, THREE_MASSES], ids=["2002", "three masses"])
def test_force_on_a_rigid_wavy_wire_is_the_closed_form_response(pantograph: Pantograph) -> None:
    """With a wave r of the wire, F = -r / (1/k + 1/D), with the dynamic stiffness D of the pantograph at its head.

    The wire is rigid (1e12 N). Steps of 0.5 ms change periods of 0.2 s by (omega dt)^2 / 12 = 2e-5, and the spline
    errs by 3e-4: 1e-3 in all. The first 5 s, in which the start decays, are left out.
    """
    speed, wavelength, amplitude = 50.0, 10.0, 5e-3
    omega = 2 * np.pi * speed / wavelength
    x = np.arange(0.0, 601.0, wavelength / 16)
    wavy = Irregularity(tuple(x), tuple(amplitude * np.cos(2 * np.pi * x / wavelength)))
    line = discretise(with_irregularity(bare_wire(600.0, 1e12), wavy), 10.0)
    history = simulate_passage(line, Passage((pantograph,), (20.0,), speed, 11.0, 5e-4))
    kept = history.time > 5.0
    wave = np.exp(2j * np.pi * history.position[0, kept] / wavelength)
    response = 2 * np.mean(history.force[0, kept] * wave.conj())
    dynamic = pantograph.stiffness + 1j * omega * pantograph.damping - omega**2 * pantograph.mass
    head_flexibility = pantograph.head @ np.linalg.solve(dynamic, pantograph.head)
    expected = -amplitude / (1 / pantograph.contact_stiffness + head_flexibility)
    assert abs(expected) > 5.0
    assert abs(response - expected) < 1e-3 * abs(expected)


def test_step_equals_the_plain_implementation_on_irregular_wires() -> None:
    """Two contact wires with different irregularities under two pantographs; tolerance as without them."""
    bump = Irregularity((26.0, 30.0, 31.5, 37.0), (0.0, 0.004, -0.003, 0.002))
    catenary = with_irregularity(twin_line(), realise_irregularity(SPECTRUM, 80.0, seed=3), bump)
    passage = Passage((PANTOGRAPH_2002, THREE_MASSES), (24.0, 12.0), 80.0, 0.4, 2e-3)
    difference, _, _, _ = largest_differences(discretise(catenary, 5.0), passage, 200, drop=1.0)
    assert max(difference.values()) < 1e-9, difference


def test_zero_irregularity_changes_no_bit() -> None:
    """A wire without an irregularity and one with zero heights give the same forces, bit by bit."""
    catenary = simple_line(spans=2, damping=DAMPED)
    flat = with_irregularity(catenary, Irregularity((0.0, 50.0, 70.0), (0.0, 0.0, 0.0)))
    passage = Passage((PANTOGRAPH_2002,), (30.0,), 60.0, 0.5, 1e-3)
    plain, zero = (simulate_passage(discretise(line, 2.0), passage) for line in (catenary, flat))
    assert np.array_equal(plain.force, zero.force)


def test_height_at_the_start_includes_the_irregularity() -> None:
    """A constant irregularity lifts the head at the start and the stated height alike; the force is unchanged."""
    catenary = simple_line(spans=2, damping=DAMPED)
    lifted = with_irregularity(catenary, Irregularity((0.0, 120.0), (0.005, 0.005)))
    passage = Passage((PANTOGRAPH_2002,), (30.0,), 60.0, 0.1, 1e-3)
    heights = [
        height_under_forces(discretise(c, 2.0), np.array([30.0]), np.array([120.0]))[0] for c in (catenary, lifted)
    ]
    assert heights[1] - heights[0] == pytest.approx(0.005, abs=1e-15)
    plain, high = (simulate_passage(discretise(c, 2.0), passage) for c in (catenary, lifted))
    # The spring to the base of this pantograph is weak: 50 N/m on 5 mm.
    assert np.abs(high.force[0, :20] - plain.force[0, :20]).max() < 0.3
