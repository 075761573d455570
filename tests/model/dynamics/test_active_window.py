"""Active window: stations ahead of the wave fronts are held at rest."""

from dataclasses import replace

import numpy as np

from helpers.lines import DAMPED, PANTOGRAPH_2002, simple_line
from pantocheck.model import Passage, simulate_passage
from pantocheck.model.discretised_line import discretise


def test_growing_active_window_changes_forces_and_motion_by_rounding_only() -> None:
    """Start at mid-line, reach longer than the line: forces, and motion at every support on both sides, to rounding."""
    line = discretise(simple_line(spans=10, damping=DAMPED), 0.5)
    supports = tuple(("contact", x) for x in np.arange(60.0, 600.0, 60.0))
    passage = Passage((PANTOGRAPH_2002, PANTOGRAPH_2002), (290.0, 250.0), 70.0, 1.5, 1e-3, supports)
    whole, growing = simulate_passage(line, passage), simulate_passage(line, replace(passage, reach=1e6))
    np.testing.assert_allclose(growing.force, whole.force, rtol=0, atol=1e-9)
    np.testing.assert_allclose(growing.motion[..., 0], whole.motion[..., 0], rtol=0, atol=1e-12)
    moved = np.ptp(whole.motion[:, :, 0], axis=1) > 1e-3
    assert 4 < moved.sum() < 9  # the waves have reached some supports, not all
