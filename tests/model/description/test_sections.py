"""Sections of a line: positions, names and heights in their place; joined sections keep their own equilibrium."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import DAMPED, overlapping_line, simple_line
from pantocheck.model import Clamp, Kind, TensionChange, Wire, discretise
from pantocheck.model.description.catenary import PointMass, SectionChange
from pantocheck.model.description.curves import TrackCurve
from pantocheck.model.description.irregularity import Irregularity
from pantocheck.model.description.sections import join_sections, place_section


def test_section_is_shifted_renamed_and_raised() -> None:
    """Rise of x / 100: every prescribed height gains that of its position along the line; a stitch wire has none."""
    line = simple_line()
    contact, messenger = line.wires
    relieved = replace(messenger, tension_changes=(TensionChange(52.0, 68.0, -3e3),), stagger=((0.0, 0.1),))
    contact = replace(
        contact, start=10.0, end_heights=(0.1, 0.3), irregularity=Irregularity((10.0, 20.0), (0.0, 1e-3)),
        section_changes=(SectionChange(5.0, 9.0, 1.1),),
    )  # fmt: skip
    stitch = Wire("stitch", Kind.STITCH_WIRE, 52.0, 68.0, 3e3, 0.3, 0.0)
    line = replace(
        line, wires=(contact, relieved, stitch), clamps=(Clamp(52.0, "messenger", "stitch"),),
        point_masses=(PointMass(30.0, "contact", 12.0),), curves=(TrackCurve(20.0, 80.0, 900.0),),
        droppers=(replace(line.droppers[0], contact_wire_height=-0.05), *line.droppers[1:]),
    )  # fmt: skip
    placed = place_section(line, "second", 200.0, lambda x: x / 100)
    assert [(w.name, w.start, w.end) for w in placed.wires] == [
        ("second contact", 210.0, 320.0), ("second messenger", 200.0, 320.0), ("second stitch", 252.0, 268.0)
    ]  # fmt: skip
    assert [w.end_heights for w in placed.wires] == [(2.2, 3.5), (3.2, 4.4), None]
    assert placed.wires[1].tension_changes == (TensionChange(252.0, 268.0, -3e3),)
    assert placed.wires[1].stagger == ((200.0, 0.1),)
    assert placed.wires[0].irregularity == Irregularity((210.0, 220.0), (0.0, 1e-3))
    assert placed.wires[0].section_changes == (SectionChange(205.0, 209.0, 1.1),)
    assert placed.point_masses == (PointMass(230.0, "second contact", 12.0),)
    assert placed.curves == (TrackCurve(220.0, 280.0, 900.0),)
    assert join_sections([line, placed]).curves == line.curves + placed.curves
    assert join_sections([line, placed]).point_masses == line.point_masses + placed.point_masses
    assert placed.clamps == (Clamp(252.0, "second messenger", "second stitch"),)
    first, arm, support = placed.droppers[0], placed.steady_arms[0], placed.messenger_supports[1]
    assert (first.position, first.upper, first.lower) == (205.0, "second messenger", "second contact")
    assert first.contact_wire_height == pytest.approx(2.0)
    assert (arm.position, arm.wire, arm.height) == (260.0, "second contact", 2.6)
    assert (support.position, support.wire, support.height) == (260.0, "second messenger", pytest.approx(3.8))


def test_free_heights_stay_free() -> None:
    """A dropper without a prescribed height has none in its place, either."""
    line = simple_line()
    free = replace(line, droppers=tuple(replace(d, contact_wire_height=None) for d in line.droppers))
    assert {d.contact_wire_height for d in place_section(free, "a", 0.0, lambda x: 1.0).droppers} == {None}


def test_joined_sections_have_the_state_of_each_alone() -> None:
    """Three sections of three spans: tensions of droppers and heights as of each section alone, to rounding.

    The sections divide the line into different elements where they overlap, but droppers stand at the same places of
    every section, so that the elements are the same here.
    """
    joined = discretise(overlapping_line(3, 3), 1.0)
    alone = discretise(simple_line(3), 1.0)
    droppers = len(alone.catenary.droppers)
    assert len(joined.catenary.droppers) == 3 * droppers
    # The first section is level up to its overlap, from 120 m on; the bending of the raise decays within 30 m.
    first = [n for n, dropper in enumerate(alone.catenary.droppers) if dropper.position < 90.0]
    np.testing.assert_allclose(joined.state.dropper_tension[first], alone.state.dropper_tension[first], rtol=1e-9)
    lengths = joined.state.dropper_length.reshape(3, droppers)
    # The last section is the mirror image of the first one.
    np.testing.assert_allclose(lengths[2], lengths[0][::-1], rtol=0, atol=1e-9)


def test_sections_of_one_line_have_one_damping_and_different_names() -> None:
    line = simple_line()
    with pytest.raises(ValueError, match="differ in their damping"):
        join_sections([line, replace(overlapping_line(2), damping=DAMPED)])
    with pytest.raises(ValueError, match="same name"):
        join_sections([line, line])
