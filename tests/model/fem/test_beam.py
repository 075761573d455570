"""Single tensioned wire against closed forms: frequencies and sag."""

import numpy as np
import pytest
from scipy.linalg import eigh

from helpers.lines import Array, bare_wire
from pantocheck.model.description.catenary import GRAVITY
from pantocheck.model.discretisation.discretised_line import discretise
from pantocheck.model.fem.beams import weight
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order
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
