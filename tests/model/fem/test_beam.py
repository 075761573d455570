"""Single tensioned wire against closed forms: frequencies, sag, and the correction of its mass."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh, eigvalsh
from scipy.sparse import csc_array

from helpers.lines import Array, bare_wire
from pantocheck.model.description.catenary import GRAVITY
from pantocheck.model.discretisation.discretised_line import discretise
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import weight
from pantocheck.model.fem.mass_correction import mass_correction
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order, correct_mass
from pantocheck.model.statics.static_solver import StaticSolver
from verification.formulations.pinned_wire import pinned_frequencies
from verification.guide.topics.closed_forms import wire_sag

SPAN, TENSION, MASS, BENDING = 60.0, 20e3, 1.35, 195.0


def frequencies(elements: int, n: int, tension: float = TENSION, bending_stiffness: float = BENDING) -> Array:
    """Natural frequencies of a pinned wire from the assembled matrices [Hz]."""
    line = discretise(bare_wire(SPAN, tension, MASS, bending_stiffness), SPAN / elements)
    matrices = assemble_matrices(line)
    w2 = eigh(matrices.stiffness.toarray(), matrices.mass.toarray(), eigvals_only=True, subset_by_index=[0, n - 1])
    return np.asarray(np.sqrt(w2) / (2 * np.pi))


def test_first_twenty_frequencies_of_a_pinned_wire() -> None:
    """With h = 0.5 m, mode 20 has 12 elements per wave: the error of cubic elements is then below 1e-6."""
    exact = pinned_frequencies(20, SPAN, TENSION, BENDING, MASS)
    np.testing.assert_allclose(frequencies(120, 20), exact, rtol=1e-6)


@pytest.mark.parametrize("mode", [5, 10, 20])
def test_frequencies_converge_with_order_four_to_six(mode: int) -> None:
    """Cubic elements converge with h^4 where bending rules and h^6 where tension rules; a contact wire lies between."""
    exact = pinned_frequencies(20, SPAN, TENSION, BENDING, MASS)[mode - 1]
    coarse, fine = (abs(frequencies(n, 20)[mode - 1] / exact - 1) for n in (40, 80))
    assert 4 < np.log2(coarse / fine) < 6


@pytest.mark.parametrize(("tension", "bending_stiffness", "order_"), [(0.0, 2e4, 4), (20e3, 0.0, 6)])
def test_orders_of_the_pure_beam_and_the_pure_string(tension: float, bending_stiffness: float, order_: int) -> None:
    """Limits of that range, each within a tenth: the next term of the error is two orders of h smaller."""
    exact = pinned_frequencies(10, SPAN, tension, bending_stiffness, MASS)[9]
    coarse, fine = (abs(frequencies(n, 10, tension, bending_stiffness)[9] / exact - 1) for n in (80, 160))
    assert np.log2(coarse / fine) == pytest.approx(order_, abs=0.1)


@pytest.mark.parametrize("bending_stiffness", [195.0, 2e4])
def test_sag_under_own_weight(bending_stiffness: float) -> None:
    """Elements of 0.25 m resolve the end layers (0.1 m and 1 m); the error is h^4 of their part of the sag."""
    line = discretise(bare_wire(20.0, TENSION, MASS, bending_stiffness), 0.25)
    exact = wire_sag(line.mesh.position, 20.0, TENSION, MASS, bending_stiffness)
    np.testing.assert_allclose(line.state.deflection[0, :, 0], exact, rtol=0, atol=2e-5 * np.abs(exact).max())


def test_sag_of_a_string_is_exact_at_the_nodes() -> None:
    """Without bending the parabola m g x (L - x) / 2T is contained in the shape functions: only rounding remains."""
    line = discretise(bare_wire(SPAN, TENSION, MASS, 0.0), 1.0)
    assert line.state.deflection[0, 30, 0] == pytest.approx(-MASS * GRAVITY * SPAN**2 / (8 * TENSION), rel=1e-11)
    x = line.mesh.position
    parabola = -MASS * GRAVITY * x * (SPAN - x) / (2 * TENSION)
    np.testing.assert_allclose(line.state.deflection[0, :, 0], parabola, rtol=0, atol=1e-12)


def test_static_solver_repeats_the_sag_of_the_initial_state() -> None:
    """The static solver in global order, loaded by the weight, equals the row-wise solution of the initial state."""
    line = discretise(bare_wire(SPAN), 0.5)
    deflection = StaticSolver(line).deflection(weight(line.beams, 0, GRAVITY)[bandwidth_order(line)])
    np.testing.assert_allclose(deflection.displacement, line.state.deflection, rtol=0, atol=1e-12)


# Mass correction: frequencies of waves, and stability at any time step.
def stepped_frequencies(mass: csc_array, stiffness: csc_array, time_step: float, count: int) -> Array:
    """Lowest frequencies of average acceleration, from its exact relation w dt / 2 = atan(w_exact dt / 2) [rad/s]."""
    squares = eigh(stiffness.toarray(), mass.toarray(), eigvals_only=True, subset_by_index=[0, count - 1])
    return np.asarray(2 / time_step * np.arctan(np.sqrt(squares) * time_step / 2))


def test_mass_correction_removes_the_frequency_error_of_waves_up_to_50_hz() -> None:
    """A pinned wire of 40 m at the default setting of 0.5 m and 1 ms, against the closed form.

    Plain average acceleration lags by (w dt)^2 / 12, 8.5e-3 at 52 Hz. Linear shape functions leave the share
    (k h)^2 / 12 of it, an eighth there, and uncorrected bending EI k^2 / T, a seventeenth: together less than a fifth.
    Both decrease with the square of the frequency: 4e-5 at 20 Hz instead of 1.3e-3.
    """
    line, time_step, count = discretise(bare_wire(40.0), 0.5), 1e-3, 33
    stiffness, exact = (
        assemble_matrices(line).stiffness,
        2 * np.pi * pinned_frequencies(count, 40.0, 20e3, 195.0, 1.35),
    )
    error = stepped_frequencies(correct_mass(line, time_step), stiffness, time_step, count) / exact - 1
    plain = stepped_frequencies(assemble_matrices(line).mass, stiffness, time_step, count) / exact - 1
    assert exact[-1] > 2 * np.pi * 50
    np.testing.assert_allclose(plain, -((exact * time_step) ** 2) / 12, rtol=0.05, atol=1e-6)
    assert np.abs(error[exact < 2 * np.pi * 20]).max() < 4e-5
    assert (np.abs(error) < np.abs(plain) / 5).all()


def test_correction_of_short_elements_is_the_largest_without_negative_mass() -> None:
    """The smallest eigenvalue of the corrected mass of an element is zero at 1 s, where every element is too short."""
    beams = discretise(bare_wire(10.0), 1.0).beams
    corrected = beam.mass(beams.length, beams.mass_per_length[0]) - mass_correction(beams, 0, 1.0)
    assert [eigvalsh(element)[0] for element in corrected] == pytest.approx([0.0] * 10, abs=1e-15)


@settings(max_examples=40)
@given(st.lists(st.floats(0.02, 2.0), max_size=9), st.floats(0.1, 3.0), st.floats(1e-5, 0.1))
def test_corrected_mass_is_positive_definite_at_any_time_step(
    gaps: list[float], element: float, time_step: float
) -> None:
    """Elements of any length side by side; rounding leaves 1e-14 of the largest.

    Average acceleration is stable at any time step if the mass is positive definite.
    """
    line = discretise(bare_wire(20.0), element, tuple(map(float, np.cumsum(gaps))))
    masses = eigvalsh(correct_mass(line, time_step).toarray())
    assert masses[0] > -1e-14 * masses[-1]
