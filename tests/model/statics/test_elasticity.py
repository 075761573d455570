"""Elasticity of a line: a force at the pantograph head is shared by the contact wires."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from pantocheck.model import Catenary, Kind, Wire, discretise
from pantocheck.model.statics.elasticity import non_uniformity, static_uplift

SPAN, FORCE = 60.0, 200.0


@pytest.mark.parametrize("tensions", [(10e3,), (10e3, 10e3), (10e3, 20e3), (20e3, 10e3), (8e3, 12e3, 24e3)])
def test_uplift_is_the_mean_of_contact_wires_with_equal_shares(tensions: tuple[float, ...]) -> None:
    """Pinned wires without droppers: a share P of the force lifts a string by P x (L - x) / (T L).

    Bending rounds the peak by sqrt(EI / T) / 2, at most 0.08 m against x (L - x) / L of at least 11 m: 0.7 %.
    """
    names = [f"contact {number}" for number in range(len(tensions))]
    wires = (Wire(name, Kind.CONTACT_WIRE, 0.0, SPAN, t, 1.35, 195.0) for name, t in zip(names, tensions, strict=True))
    line = discretise(Catenary(tuple(wires)), 1.0)
    position = np.array([15.0, 30.0, 40.0])
    flexibility = position * (SPAN - position) / SPAN * np.mean([1 / tension for tension in tensions])
    assert_allclose(static_uplift(line, position, FORCE), FORCE / len(tensions) * flexibility, rtol=0.01)


def test_non_uniformity_by_hand() -> None:
    assert non_uniformity(np.array([0.4, 0.2, 0.6])) == pytest.approx(0.5)
    assert non_uniformity(np.array([0.3, 0.3])) == 0
