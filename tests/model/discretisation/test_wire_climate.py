"""Tension of a fixed wire after a change of temperature: limits of the closed form and length of the wire."""

import numpy as np
import pytest

from helpers.lines import bare_wire, simple_line
from pantocheck.model import discretise
from pantocheck.model.description.catenary import GRAVITY
from pantocheck.model.description.failures import NoInitialState
from pantocheck.model.discretisation.wire_climate import excess_lengths, fixed_tension

AXIAL_STIFFNESS = 12e6
EXPANSION = 17e-6


@pytest.mark.parametrize("warmer", [-30.0, 0.0, 20.0])
def test_flat_wire_changes_by_the_thermal_force(warmer: float) -> None:
    """T = T0 - EA alpha dtheta; a contact wire with 30 mm sag in 60 m comes within 2 % of the change."""
    expected = 20e3 - AXIAL_STIFFNESS * EXPANSION * warmer
    assert fixed_tension(20e3, 0.0, AXIAL_STIFFNESS, EXPANSION * warmer) == pytest.approx(expected, rel=1e-12)
    sag = 8 / 3 * (0.03 / 60) ** 2
    with_sag = fixed_tension(20e3, sag, AXIAL_STIFFNESS, EXPANSION * warmer)
    assert with_sag - 20e3 == pytest.approx(expected - 20e3, rel=0.02)


def test_slack_wire_takes_up_the_strain_by_its_sag() -> None:
    """Inextensible wire: e0 (T0 / T)^2 = e0 + strain; EA of 1e12 N leaves 1e-6."""
    excess, strain = 8 / 3 * (2.0 / 60) ** 2, 17e-6 * 40
    expected = 1e4 * np.sqrt(excess / (excess + strain))
    assert fixed_tension(1e4, excess, 1e12, strain) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("warmer", [-40.0, 40.0, 400.0])
def test_length_of_the_wire_without_load_is_kept(warmer: float) -> None:
    """The condition that defines the tension, over a wide range; the tolerance is that of the root."""
    excess, strain = 8 / 3 * (0.6 / 60) ** 2, EXPANSION * warmer
    tension = fixed_tension(16e3, excess, AXIAL_STIFFNESS, strain)
    elastic, geometric = (tension - 16e3) / AXIAL_STIFFNESS, excess * ((16e3 / tension) ** 2 - 1)
    assert elastic + strain == pytest.approx(geometric, abs=1e-11)


def test_flat_wire_without_tension_is_refused() -> None:
    """At 100 K more, 20 kN are lost."""
    with pytest.raises(NoInitialState, match=r"no tension left: 2e\+04 N fall to -400 N"):
        fixed_tension(20e3, 0.0, AXIAL_STIFFNESS, EXPANSION * 100)


def test_excess_length_of_a_hanging_wire_is_that_of_a_parabola() -> None:
    """e = (m g L / T)^2 / 24; bending of the ends changes it by l / L with l = 0.1 m, the elements by less."""
    line = bare_wire(60.0)
    excess = (1.35 * GRAVITY * 60.0 / 20e3) ** 2 / 24
    assert excess_lengths(line, 1.0)["contact"] == pytest.approx(excess, rel=0.01)


def test_excess_length_counts_from_the_chord() -> None:
    """A level contact wire on droppers is nearly straight; its messenger is not.

    Half the elements: 0.2 %. The length of the polygon through the nodes contains terms of fourth order: 0.5 %.
    """
    line = simple_line()
    coarse, fine = excess_lengths(line, 1.0), excess_lengths(line, 0.5)
    assert coarse["contact"] < 1e-6
    assert coarse["messenger"] == pytest.approx(fine["messenger"], rel=2e-3)
    state, row = discretise(line, 0.5), 1
    height = state.state.deflection[row, :, 0]
    polygon = np.hypot(np.diff(state.mesh.position), np.diff(height)).sum() / 120.0 - 1
    assert fine["messenger"] == pytest.approx(polygon, rel=5e-3)
