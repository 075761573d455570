"""Energy of a passage across an overlap: the forces of the contact wires are shared out, none is lost or made."""

import numpy as np
import pytest

from helpers.lines import overlapping_line, simple_line
from pantocheck.model import Passage, build_chain, make_droppers_bilateral
from pantocheck.model.discretisation.discretised_line import discretise
from verification.guide.topics.passage_balance import measure_balances

HEAD = build_chain(np.array([15.0, 7.2]), np.array([50.0, 4200.0]), np.zeros(2), 120.0, 0, 50e3)
"""Pantograph of EN 50318:2002 without dampers."""


@pytest.mark.parametrize("pantographs", [1, 2])
def test_energy_and_momentum_change_by_work_and_impulse_over_the_change_of_wires(pantographs: int) -> None:
    """Two sections of three spans of 44 m, overlap of one span, without damping: to 1e-7 of work and impulse.

    The sweeps leave 1e-9 N at each of 40 connectors, which move by millimetres in each of 1200 steps: 1e-8 of it.
    """
    section = simple_line(3, 44.0, (4.0, 14.0, 24.0, 32.0, 40.0))
    line = make_droppers_bilateral(discretise(overlapping_line(2, 3, section=section), 1.0))
    balance = measure_balances(line, Passage((HEAD,) * pantographs, (90.0, 60.0)[:pantographs], 50.0, 1.2, 1e-3))
    assert balance.touched == (True, True)
    assert balance.work > 10.0
    assert balance.energy < 1e-7
    assert balance.momentum < 1e-7
