"""Simulator against independent formulations that share only the line with it."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.central_differences import contact_force
from helpers.lines import PANTOGRAPH_2002, Array, simple_line
from pantocheck.model import Kind, Passage, Rayleigh, discretise, simulate_passage
from pantocheck.model.description.pantograph import preload_springs
from pantocheck.model.modal.modes import compute_modes
from verification.guide.peers.scikit_fem_modes import COMPARED_MODES, FREQUENCY_TOLERANCE, solve_with_scikit_fem

PANTOGRAPH = preload_springs(PANTOGRAPH_2002, np.full(2, 0.06))
RATE = 500.0
BANDS = ((0.0, 5.0), (5.0, 20.0), (20.0, 50.0))


def band_rms(force: Array) -> list[float]:
    """Root mean square in each band [N]."""
    power = 2 * np.abs(np.fft.rfft(force - force.mean()) / force.size) ** 2
    frequency = np.fft.rfftfreq(force.size, 1 / RATE)
    return [float(np.sqrt(power[(frequency > low) & (frequency <= high)].sum())) for low, high in BANDS]


def test_passage_and_explicit_integration_agree_in_every_band() -> None:
    """Central differences at 0.2 ms, with a second-order error far below 1 %; the kernel at 0.25 ms."""
    damping = {kind: Rayleigh(0.0125, 1e-4) for kind in Kind}
    line = discretise(simple_line(3, damping=damping), 0.5)
    explicit = Passage((PANTOGRAPH,), (60.0,), 250 / 3.6, 1.1, 2e-4)
    explicit_force = contact_force(line, explicit)[:: round(1 / (RATE * 2e-4))]
    kernel_force = simulate_passage(line, replace(explicit, time_step=2.5e-4)).force[0][:: round(1 / (RATE * 2.5e-4))]
    settled = slice(round(0.1 * RATE), None)
    assert band_rms(kernel_force[settled]) == pytest.approx(band_rms(explicit_force[settled]), rel=0.01)
    assert np.abs(kernel_force[settled]).max() == pytest.approx(np.abs(explicit_force[settled]).max(), rel=0.01)


def test_modes_agree_with_fine_elements_of_scikit_fem_on_a_whole_line() -> None:
    """scikit-fem assembles the same two beams with an eighth of the element length; springs are added by hand.

    With the residual flexibility the elements of 0.5 m agree within 2.3e-5, and without it within 3.7e-3. Both occur at
    9.2 Hz, where the wires vibrate against each other through the droppers.
    """
    pytest.importorskip("skfem", reason="scikit-fem comes with the extra 'peers'")
    catenary = simple_line(3)
    line = discretise(catenary, 0.5)
    expected = solve_with_scikit_fem(catenary, line)
    assert compute_modes(line, COMPARED_MODES).frequency == pytest.approx(expected, rel=FREQUENCY_TOLERANCE)
