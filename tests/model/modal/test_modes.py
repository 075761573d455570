"""Modes and the energy shares of the kinds of component."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import DAMPED, bare_wire, complex_roots, simple_line
from pantocheck.model import Kind, Rayleigh, discretise
from pantocheck.model.discretisation.discretised_line import with_damping
from pantocheck.model.modal.modes import component_energies, compute_modes, compute_modes_below, damping_ratios
from pantocheck.model.statics.assembly import assemble_matrices, free_unknowns
from verification.formulations.pinned_wire import pinned_frequencies


def test_compute_modes_of_a_bare_wire_are_the_closed_form() -> None:
    """Elements of 1 m on a wave of 12 m and more: the measured error is 2e-7."""
    modes = compute_modes(discretise(bare_wire(60.0), 1.0), 10)
    np.testing.assert_allclose(modes.frequency, pinned_frequencies(10, 60.0, 20e3, 195.0, 1.35), rtol=1e-6)


def test_sign_of_antisymmetric_shapes_does_not_depend_on_rounding() -> None:
    """Halves of a shape of even number are equal and opposite: the first of them is positive in every mode."""
    line = discretise(bare_wire(60.0), 1.0)
    shapes = compute_modes(line, 12).shape[1::2, 0, :, 0]
    half = shapes[:, : shapes.shape[1] // 2]
    assert np.abs(shapes + shapes[:, ::-1]).max() < 1e-6 * np.abs(shapes).max()
    first = (np.abs(half) > (1 - 1e-6) * np.abs(shapes).max(axis=1, keepdims=True)).argmax(axis=1)
    assert np.all(half[np.arange(len(half)), first] > 0)


def test_all_modes_below_a_frequency_are_found() -> None:
    """A wire of 60 m has a mode every 1 Hz: 40 of them need more than one trial. The limit itself is excluded."""
    line = discretise(bare_wire(60.0), 1.0)
    exact = pinned_frequencies(60, 60.0, 20e3, 195.0, 1.35)
    for limit in (0.5, 10.0, 40.0):
        modes = compute_modes_below(line, limit)
        assert modes.frequency == pytest.approx(exact[exact < limit], rel=1e-3)
        assert len(modes.shape) == len(modes.frequency)
    assert compute_modes_below(line, compute_modes(line, 16).frequency[2]).frequency.size == 2
    unknowns = free_unknowns(line).size
    assert compute_modes_below(line, 1e9).frequency.size == unknowns - 2  # the most that the eigenvalue solver gives


def test_component_energies_of_mass_normalised_modes_add_up() -> None:
    """Sums of 7 kinds of component against 1 and omega squared: rounding, magnified by the condition of K.

    The dampers of the supports have no share in either.
    """
    line = simple_line(damping=DAMPED)
    supports = tuple(replace(support, damping=1e3) for support in line.messenger_supports)
    line = discretise(replace(line, messenger_supports=supports), 1.0)
    modes = compute_modes(line, 12)
    energies = component_energies(line, modes)
    np.testing.assert_allclose(energies.mass.sum(axis=1), 1.0, rtol=1e-10)
    np.testing.assert_allclose(energies.stiffness.sum(axis=1), (2 * np.pi * modes.frequency) ** 2, rtol=1e-8)
    assert energies.mass.min() > -1e-12
    assert energies.stiffness.min() > -1e-6


def test_damping_ratios_follow_from_component_energies() -> None:
    """zeta = sum (a k + b m) / 2 omega, the two sides computed by different sums: rounding."""
    line = discretise(simple_line(damping=DAMPED), 1.0)
    modes = compute_modes(line, 12)
    energies = component_energies(line, modes)
    expected = np.zeros(12)
    for k, kind in enumerate(energies.kinds):
        rayleigh = DAMPED.get(kind, Rayleigh())
        expected += rayleigh.stiffness_coefficient * energies.stiffness[:, k]
        expected += rayleigh.mass_coefficient * energies.mass[:, k]
    np.testing.assert_allclose(damping_ratios(line, modes), expected / (4 * np.pi * modes.frequency), rtol=1e-9)


@pytest.mark.parametrize("coefficients", [Rayleigh(0.05, 0.0), Rayleigh(0.0, 1e-4)])
def test_damping_ratios_of_uniform_rayleigh_damping_equal_complex_eigenvalues(coefficients: Rayleigh) -> None:
    """Proportional damping: ratio of mode j is exactly its energy sum; dense eigenvalues carry about ten digits."""
    line = with_damping(discretise(simple_line(spans=1), 2.0), dict.fromkeys(Kind, coefficients))
    modes = compute_modes(line, 6)
    matrices = assemble_matrices(line)
    roots = complex_roots(*(m.toarray() for m in (matrices.mass, matrices.damping, matrices.stiffness)), count=6)
    np.testing.assert_allclose(np.abs(roots) / (2 * np.pi), modes.frequency, rtol=1e-6)
    np.testing.assert_allclose(-roots.real / np.abs(roots), damping_ratios(line, modes), rtol=1e-6)
