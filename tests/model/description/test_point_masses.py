"""Point masses and changes of a wire: sag, natural frequencies and a passage against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from helpers.lines import DAMPED, PANTOGRAPH_2002, bare_wire, simple_line
from helpers.step_differences import THREE_MASSES, largest_differences
from pantocheck.model import Passage, PointMass, SectionChange, discretise, simulate_passage
from pantocheck.model.description.catenary import GRAVITY, TensionChange
from pantocheck.model.description.failures import NoInitialState
from pantocheck.model.discretisation.discretised_line import max_wave_speed
from pantocheck.model.modal.modes import compute_modes

LENGTH, TENSION, MASS_PER_LENGTH = 60.0, 20e3, 1.35


@pytest.mark.parametrize("place", [20.0, 30.0, 7.3])
def test_sag_under_a_mass_is_that_of_a_string_less_the_bending_at_the_mass(place: float) -> None:
    """Beam far from its ends: M g (a b / (T L) - l / (2 T)) with the bending length l = sqrt(EI / T) = 0.1 m.

    Elements of 0.05 m resolve l; the boundary layers at the ends change the sag by less than exp(-7.3 / 0.1).
    """
    mass, bending_length = 12.0, np.sqrt(195.0 / TENSION)
    wire = bare_wire(LENGTH)
    loaded = replace(wire, point_masses=(PointMass(place, "contact", mass),))
    sag = []
    for catenary in (wire, loaded):
        line = discretise(catenary, 0.05, (place,))
        sag.append(-line.state.deflection[0, line.mesh.station(place), 0])
    flexibility = place * (LENGTH - place) / (TENSION * LENGTH) - bending_length / (2 * TENSION)
    assert sag[1] - sag[0] == pytest.approx(mass * GRAVITY * flexibility, rel=1e-5)


def test_first_frequency_of_a_string_with_a_mass_in_the_middle() -> None:
    """tan(k L / 2) = 2 m / (M k) for the first mode, omega = k sqrt(T / m); the second mode has a node at the mass.

    The bending length of 0.02 m adds its share of 15 m, 0.07 %, to the stiffness at the mass.
    """
    mass = 12.0
    wire = replace(bare_wire(LENGTH, bending_stiffness=7.8), point_masses=(PointMass(30.0, "contact", mass),))
    first, second = compute_modes(discretise(wire, 0.1), 2).frequency
    k = brentq(lambda k: np.sin(k * 30) * mass * k - 2 * MASS_PER_LENGTH * np.cos(k * 30), 1e-3, np.pi / LENGTH)
    speed = np.sqrt(TENSION / MASS_PER_LENGTH)
    assert first == pytest.approx(k * speed / (2 * np.pi), rel=1e-3)
    assert second == pytest.approx(speed / LENGTH, rel=1e-4)


def test_droppers_beside_a_mass_carry_its_weight() -> None:
    """Section insulator of 15 kg at mid-span: all droppers and arms carry its weight more; rounding."""
    line = simple_line()
    loaded = replace(line, point_masses=(PointMass(27.0, "contact", 15.0),))
    states = [discretise(catenary, 1.0).state for catenary in (line, loaded)]
    added = states[1].dropper_tension - states[0].dropper_tension
    arms = (states[1].arm_force - states[0].arm_force)[:, 1]
    assert added.sum() + arms.sum() == pytest.approx(15.0 * GRAVITY, rel=1e-6)
    assert added[3:5].sum() > 15.0 * GRAVITY  # the droppers at 23.5 m and 30 m; their neighbours are relieved
    impossible = replace(line, point_masses=(PointMass(27.0, "contact", -30.0),))
    with pytest.raises(NoInitialState, match="would have to push"):
        discretise(impossible, 1.0)


def test_passage_over_a_mass_is_that_over_a_clamp_of_the_same_mass() -> None:
    """A mass at a dropper and a heavier clamp of this dropper are the same line: forces to rounding."""
    line, mass, place = simple_line(spans=3), 12.0, 83.5
    masses = replace(line, point_masses=(PointMass(place, "contact", mass),))
    clamps = replace(
        line, droppers=tuple(replace(d, lower_clamp_mass=mass if d.position == place else 0.0) for d in line.droppers)
    )
    passage = Passage((PANTOGRAPH_2002, THREE_MASSES), (60.0, 45.0), 70.0, 0.6, 1e-3)
    plain, on_mass, on_clamp = (simulate_passage(discretise(c, 1.0), passage).force for c in (line, masses, clamps))
    np.testing.assert_allclose(on_mass, on_clamp, rtol=0, atol=1e-6)
    assert np.abs(on_mass - plain).max() > 30.0


def test_step_equals_the_plain_implementation_over_masses_and_changes() -> None:
    """Masses and worn stretches on both wires, with different damping; tolerance as in the tests of the time step."""
    line = simple_line(spans=2, span=40.0, droppers=(5.0, 15.0, 25.0, 35.0), damping=DAMPED)
    contact, messenger = line.wires
    worn = (SectionChange(20.0, 33.0, -0.3, -60.0), SectionChange(33.0, 38.0, 0.8, 500.0))
    line = replace(
        line,
        wires=(
            replace(contact, section_changes=worn, tension_changes=(TensionChange(0.0, 33.0, -2e3),)),
            replace(messenger, section_changes=(SectionChange(10.0, 44.0, 0.5),)),
        ),
        point_masses=(PointMass(21.3, "contact", 12.0), PointMass(17.0, "messenger", 5.0)),
    )
    passage = Passage((PANTOGRAPH_2002, THREE_MASSES), (18.03, 10.03), 80.0, 0.4, 2e-3)  # no head exactly at a station
    difference, _, _, _ = largest_differences(discretise(line, 2.5), passage, 200, drop=1.0)
    assert max(difference.values()) < 1e-9, difference


def test_first_frequency_of_a_string_of_two_densities() -> None:
    """k1 cot(k1 L / 2) + k2 cot(k2 L / 2) = 0 for two halves under one tension; bending of 1 N m2 adds 3e-7."""
    wire = bare_wire(LENGTH, bending_stiffness=1.0)
    change = SectionChange(30.0, LENGTH, mass_per_length=-0.27, bending_stiffness=-0.5)
    changed = replace(wire, wires=(replace(wire.wires[0], section_changes=(change,)),))
    line = discretise(changed, 0.5)
    speeds = np.sqrt(TENSION / np.array([MASS_PER_LENGTH, MASS_PER_LENGTH - 0.27]))

    def characteristic(omega: float) -> float:
        return float(np.sum(omega / speeds / np.tan(omega / speeds * 30.0)))

    omega = brentq(characteristic, 0.5 * np.pi * speeds[0] / LENGTH, 1.5 * np.pi * speeds[0] / LENGTH)
    assert compute_modes(line, 1).frequency[0] == pytest.approx(omega / (2 * np.pi), rel=1e-6)
    # The active window must be wide enough for waves on the lighter half.
    assert max_wave_speed(line) == pytest.approx(1.1 * speeds[1])


def test_weight_of_a_change_is_carried() -> None:
    """Weight of both wires less that of 20 m at 0.3 kg/m: reactions of droppers and arms; rounding."""
    line = simple_line(spans=1)
    contact, messenger = line.wires
    worn = replace(line, wires=(replace(contact, section_changes=(SectionChange(17.0, 37.0, -0.3),)), messenger))
    total = [discretise(catenary, 1.0).state.dropper_tension.sum() for catenary in (line, worn)]
    # The ends carry a small part of the change of the outermost fields.
    assert total[0] - total[1] == pytest.approx(20.0 * 0.3 * GRAVITY, rel=1e-2)
