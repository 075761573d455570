"""Mass drop: closed form of a linear line, and slack droppers."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import bare_wire, simple_line
from pantocheck.model import Kind, Rayleigh, discretise
from pantocheck.model.description.catenary import GRAVITY
from pantocheck.model.dynamics.drop_values import MassDropSetup
from pantocheck.model.dynamics.mass_drop import simulate_mass_drop
from pantocheck.model.modal.modes import compute_modes, damping_ratios

DAMPING = dict.fromkeys(Kind, Rayleigh(0.1, 1e-4))
LINE = simple_line(spans=2, damping=DAMPING)


def test_mass_drop_of_a_light_mass_is_a_sum_of_decaying_modes() -> None:
    """The first 140 modes, phi (phi' f) / omega^2 cos omega t, while every dropper is taut.

    Higher modes and the period error (omega dt)^2 / 12 are below 1 % of the largest displacement.
    """
    test = MassDropSetup(2.0, "contact", 33.0, 0.0, 0.05, 3.0, 1e-3, (("contact", 21.0), ("messenger", 45.0)))
    decay = simulate_mass_drop(LINE, 1.0, test)
    assert decay.last_slack is None
    assert decay.time[[0, -1]] == pytest.approx([-0.049, 3.0])  # 50 steps with the mass, the last one at zero
    assert decay.motion.shape == (2, 3050, 3)  # displacement, velocity, acceleration
    line = discretise(LINE, 1.0, (33.0, 21.0, 45.0))
    modes = compute_modes(line, 140)
    zeta, omega = damping_ratios(line, modes), 2 * np.pi * modes.frequency
    station = line.mesh.station
    participation = modes.shape[:, 0, station(33.0), 0] * -2.0 * GRAVITY / omega**2
    after = decay.time > 0
    # The load still acts at time zero, so the free decay starts half a step later.
    t = decay.time[after] - 0.5e-3
    damped = omega * np.sqrt(1 - zeta**2)
    swing = np.exp(-np.outer(t, zeta * omega)) * (
        np.cos(np.outer(t, damped)) + zeta / np.sqrt(1 - zeta**2) * np.sin(np.outer(t, damped))
    )
    for sensor, row, x in ((0, 0, 21.0), (1, 1, 45.0)):
        expected = swing @ (participation * modes.shape[:, row, station(x), 0])
        difference = decay.motion[sensor, after, 0] - expected
        assert np.abs(difference).max() < 0.01 * np.abs(expected).max()


def test_mass_drop_is_at_rest_before_the_release_and_weaker_after_a_slow_release() -> None:
    """At rest to the tolerance of the forces, 1e-9 N; a release over 0.2 s excites fewer waves than a step force."""
    at_once, slowly = (
        simulate_mass_drop(
            LINE, 1.0, MassDropSetup(30.0, "contact", 33.0, duration, 0.2, 1.0, 1e-3, (("contact", 21.0),))
        )
        for duration in (0.0, 0.2)
    )
    before = at_once.time <= 0
    assert np.ptp(at_once.motion[0, before, 0]) < 1e-9
    fast, slow = (np.abs(decay.motion[0, :, 2]).max() for decay in (at_once, slowly))
    assert slow < 0.5 * fast


def test_weight_decreases_linearly_during_the_release() -> None:
    """A slow release: the wire, with a period of 1 s, follows the weight; its swing about it is below 4 %."""
    line = bare_wire(60.0)
    decay = simulate_mass_drop(
        line, 2.0, MassDropSetup(2.0, "contact", 30.0, 8.0, 0.1, 9.0, 5e-3, (("contact", 30.0),))
    )
    share = decay.motion[0, :, 0] / decay.motion[0, 0, 0]
    np.testing.assert_allclose(share, np.interp(decay.time, [0.0, 8.0], [1.0, 0.0]), rtol=0, atol=0.04)


def test_mass_drop_of_a_heavy_mass_on_the_messenger_wire_slackens_droppers() -> None:
    """A mass of 100 kg pulls the messenger wire down to the contact wire; a single dropper is noticed too."""
    for line in (LINE, replace(LINE, droppers=LINE.droppers[4:5])):
        drop = MassDropSetup(100.0, "messenger", 30.0, 0.0, 0.02, 1.0, 1e-3, (("contact", 30.0),))
        decay = simulate_mass_drop(line, 1.0, drop)
        assert decay.slack_at_start > 0
        assert decay.last_slack is not None
        assert decay.last_slack > 0.1
