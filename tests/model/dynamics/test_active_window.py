"""What stands still because no wave has come to it yet."""

from dataclasses import replace

import numpy as np

from helpers.lines import DAMPED, simple_line
from pantocheck.model import Passage, chain, simulate_passage
from pantocheck.model.discretised_line import discretise

PANTOGRAPH = chain(np.array([15.0, 7.2]), np.array([50.0, 4200.0]), np.array([90.0, 10.0]), 120.0, 0, 50e3)


def test_waves_run_ahead_and_back_within_the_moving_part() -> None:
    """From mid-line, a reach that never bites: forces, and motion at every support on both sides, to rounding."""
    line = discretise(simple_line(spans=10, damping=DAMPED), 0.5)
    supports = tuple(("contact", x) for x in np.arange(60.0, 600.0, 60.0))
    passage = Passage((PANTOGRAPH, PANTOGRAPH), (290.0, 250.0), 70.0, 1.5, 1e-3, supports)
    whole, spreading = simulate_passage(line, passage), simulate_passage(line, replace(passage, reach=1e6))
    np.testing.assert_allclose(spreading.force, whole.force, rtol=0, atol=1e-9)
    np.testing.assert_allclose(spreading.motion[..., 0], whole.motion[..., 0], rtol=0, atol=1e-12)
    moved = np.ptp(whole.motion[:, :, 0], axis=1) > 1e-3
    assert 4 < moved.sum() < 9  # the waves have come to some of them
