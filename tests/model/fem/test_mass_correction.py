"""Mass correction: frequencies of waves, and stability at any time step."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh, eigvalsh
from scipy.sparse import csc_array

from helpers.lines import Array, bare_wire
from pantocheck.model.discretisation.discretised_line import discretise
from pantocheck.model.fem import beam
from pantocheck.model.fem.mass_correction import mass_correction
from pantocheck.model.statics.assembly import assemble_matrices, correct_mass
from verification.formulations.pinned_wire import pinned_frequencies


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
