"""Model order: the search ends where the poles do not change any more."""

import numpy as np
import pytest

from pantocheck.conformance.drops.model_order import _are_equal


@pytest.mark.parametrize(("difference", "equal"), [(0.004, True), (0.006, False), (-0.004, True), (-0.006, False)])
@pytest.mark.parametrize("direction", [1.0, 1j])
def test_poles_are_equal_to_one_percent_of_their_decay_rate(difference: float, equal: bool, direction: complex) -> None:
    """A decay rate of 0.5 1/s: up to 0.005 1/s in damping or frequency; every pole counts."""
    poles = np.array([-0.5 + 7.0j, -0.5 + 14.0j])
    other = poles + np.array([0.0, difference * direction])
    assert _are_equal(other, poles) == equal
    assert not _are_equal(poles[:1], poles)
