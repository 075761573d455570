"""The mass that a time step works with: waves in time, and a method that is stable at any step."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh, eigvalsh
from scipy.sparse import csc_array

from helpers.lines import Array, bare_wire
from pantocheck.model.discretised_line import discretise
from pantocheck.model.fem import beam
from pantocheck.model.fem.assembly import assemble_matrices, stepping_mass


def stepped_frequencies(mass: csc_array, stiffness: csc_array, time_step: float, count: int) -> Array:
    """Lowest frequencies with which average acceleration oscillates, from its exact rule w dt / 2 = atan [rad/s]."""
    squares = eigh(stiffness.toarray(), mass.toarray(), eigvals_only=True, subset_by_index=[0, count - 1])
    return np.asarray(2 / time_step * np.arctan(np.sqrt(squares) * time_step / 2))


def test_waves_on_a_wire_run_in_time_up_to_50_hz() -> None:
    """A pinned wire of 40 m at the default setting of 0.5 m and 1 ms, against the closed form.

    Plain average acceleration is late by (w dt)^2 / 12, 8.5e-3 at 52 Hz. Of that linear shape functions leave
    (k h)^2 / 12, an eighth there, and bending, which is not compensated, EI k^2 / T, a seventeenth: less than a fifth
    in all. Both fade with the square of the frequency: 4e-5 at 20 Hz, in place of 1.3e-3.
    """
    line, time_step, count = discretise(bare_wire(40.0), 0.5), 1e-3, 33
    stiffness, exact = (
        assemble_matrices(line).stiffness,
        2 * np.pi * beam.pinned_frequencies(count, 40.0, 20e3, 195.0, 1.35),
    )
    error = stepped_frequencies(stepping_mass(line, time_step), stiffness, time_step, count) / exact - 1
    plain = stepped_frequencies(assemble_matrices(line).mass, stiffness, time_step, count) / exact - 1
    assert exact[-1] > 2 * np.pi * 50
    np.testing.assert_allclose(plain, -((exact * time_step) ** 2) / 12, rtol=0.05, atol=1e-6)
    assert np.abs(error[exact < 2 * np.pi * 20]).max() < 4e-5
    assert (np.abs(error) < np.abs(plain) / 5).all()


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.lists(st.floats(0.02, 6.0), max_size=9), st.floats(0.1, 3.0), st.floats(1e-5, 0.1))
def test_the_mass_is_positive_at_any_step(gaps: list[float], element: float, time_step: float) -> None:
    """Elements of any length side by side; rounding leaves 1e-14 of the largest.

    Average acceleration is stable at any step as long as no direction has a negative mass.
    """
    line = discretise(bare_wire(60.0), element, tuple(map(float, np.cumsum(gaps))))
    masses = eigvalsh(stepping_mass(line, time_step).toarray())
    assert masses[0] > -1e-14 * masses[-1]
