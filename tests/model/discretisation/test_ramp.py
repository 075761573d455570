"""Ramp of the contact force at the start of a passage."""

from dataclasses import replace

import numpy as np

from helpers.lines import PANTOGRAPH_2002, bare_wire
from pantocheck.model import Passage, simulate_passage
from pantocheck.model.discretisation.discretised_line import discretise

DURATION, RAMP = 12.0, 8.0
STANDING = Passage((PANTOGRAPH_2002, PANTOGRAPH_2002), (20.0, 45.0), 0.0, DURATION, 2e-3)


def test_slow_ramp_follows_its_half_cosine() -> None:
    """Two standing pantographs. The wire answers within half a second (its first mode has 1 Hz), so that a ramp of 8 s
    is nearly static: its forces lie within 3 N of the half-cosine."""
    line = discretise(bare_wire(60.0), 2.0)
    history = simulate_passage(line, replace(STANDING, ramp=RAMP))
    share = (1 - np.cos(np.pi * history.time / RAMP)) / 2
    expected = np.where(history.time < RAMP, share, 1.0) * history.force[:, -1:]
    np.testing.assert_allclose(history.force, expected, rtol=0, atol=3.0)
    # At the end, the base spring of 50 N/m adds its force: its height is that of the head plus F over 4200 N/m.
    frame = history.height[:, -1] + history.force[:, -1] / 4200.0
    np.testing.assert_allclose(history.force[:, -1], 120.0 - 50.0 * frame, rtol=0, atol=0.1)


def test_ramp_begins_in_equilibrium_without_contact_force() -> None:
    """Every head is held down, so that nothing moves but by the release: 130 N (pi t / T)^2 / 4, 0.2 N after 0.2 s."""
    line = discretise(bare_wire(60.0), 2.0)
    history = simulate_passage(line, replace(STANDING, ramp=RAMP, duration=0.2))
    assert np.all(np.abs(history.force) < 0.3)
    assert np.all(np.ptp(history.height, axis=1) < 1e-4)


def test_passage_without_a_ramp_starts_with_the_static_force() -> None:
    line = discretise(bare_wire(60.0), 2.0)
    history = simulate_passage(line, replace(STANDING, duration=0.1))
    np.testing.assert_allclose(history.force[:, 0], 120.0, atol=1.0)
