"""Initial state: balance of forces of each wire, symmetry, published dropper lengths."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import Array, simple_line
from pantocheck.model import Catenary, Clamp, Dropper, Kind, MessengerSupport, PointMass, SteadyArm, Wire
from pantocheck.model.description.catenary import GRAVITY
from pantocheck.model.description.failures import NoInitialState
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, discretise
from pantocheck.model.fem.beams import weight, wire_stiffness
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order, connector_directions

LENGTHS_2018 = np.array([1.017, 0.896, 0.810, 0.758, 0.741, 0.758, 0.810, 0.896, 1.017])
"""Printed dropper lengths of the EN 50318:2018 simple line (published_values.toml, en50318_2018.ac_simple) [m]."""


PLACES_2018 = np.array([4.5, 10.25, 16.0, 21.75, 27.5, 33.25, 39.0, 44.75, 50.5])
PRINTED_HEIGHTS = -np.array([0.0, 0.024, 0.041, 0.052, 0.055, 0.052, 0.041, 0.024, 0.0])
PARABOLA = -0.055 * (1 - ((PLACES_2018 - 27.5) / 23.0) ** 2)
"""Pre-sag of 1/1000 of the span; the printed heights are its rounded values [m]."""


def simple_line_2018(spans: int, heights: Array, bending: float) -> Catenary:
    """The EN 50318:2018 simple line as published, with multiplied bending stiffnesses; the arms carry no share."""
    span, end = 55.0, 55.0 * spans
    droppers = tuple(
        Dropper(
            number * span + x,
            "messenger",
            "contact",
            axial_stiffness=200e3,
            mass=0.117 * length,
            upper_clamp_mass=0.195,
            lower_clamp_mass=0.165,
            contact_wire_height=float(height),
        )
        for number in range(spans)
        for x, height, length in zip(PLACES_2018, heights, LENGTHS_2018, strict=True)
    )
    return Catenary(
        wires=(
            Wire("contact", Kind.CONTACT_WIRE, 0.0, end, 22e3, 1.35, 195.0 * bending),
            Wire("messenger", Kind.MESSENGER_WIRE, 0.0, end, 16e3, 1.08, 131.7 * bending),
        ),
        droppers=droppers,
        steady_arms=tuple(SteadyArm(span * n, "contact", vertical_stiffness=0.0) for n in range(1, spans)),
        messenger_supports=tuple(MessengerSupport(span * n, "messenger", 1.2, 500e3, 1000.0) for n in range(spans + 1)),
    )


def end_pull(line: DiscretisedLine, name: str) -> float:
    """Vertical force of anchors and messenger supports on a wire, from its slopes [N].

    It follows from the shape alone: T times the jump of the slope minus the shear of bending.
    """
    row = line.mesh.row_of[name, "z"]
    stiffness = wire_stiffness(line.beams, row)
    residual = (stiffness @ line.state.deflection[row].ravel() - weight(line.beams, row, GRAVITY))[::2]
    supported = [line.mesh.station(x) for x in (line.catenary.wire(name).start, line.catenary.wire(name).end)]
    if line.catenary.wire(name).kind is Kind.MESSENGER_WIRE:
        supported += [line.mesh.station(s.position) for s in line.catenary.messenger_supports]
    return float(residual[np.unique(supported)].sum())


@pytest.mark.parametrize("carries_share", [True, False])
def test_initial_state_balances_the_forces_on_each_wire(carries_share: bool) -> None:
    """Weight of wire, clamps and half droppers against droppers, arms, anchors and supports: to rounding, 1e-9."""
    catenary = simple_line(spans=3, carries_share=carries_share)
    heavy = tuple(replace(d, mass=0.3, upper_clamp_mass=0.2, lower_clamp_mass=0.1) for d in catenary.droppers)
    line = discretise(replace(catenary, droppers=heavy, point_masses=(PointMass(27.0, "contact", 12.0),)), 0.5)
    tension, arms = line.state.dropper_tension.sum(), line.state.arm_force[:, 1].sum()
    contact_weight = GRAVITY * (180 * 1.35 + len(heavy) * (0.15 + 0.1) + 12.0)
    messenger_weight = GRAVITY * (180 * 1.07 + len(heavy) * (0.15 + 0.2))
    assert GRAVITY * line.beams.lumped_mass[0].sum() == pytest.approx(contact_weight - GRAVITY * 180 * 1.35, rel=1e-9)
    assert tension + arms + end_pull(line, "contact") == pytest.approx(contact_weight, rel=1e-9)
    assert end_pull(line, "messenger") == pytest.approx(messenger_weight + tension, rel=1e-9)


def test_initial_state_is_in_equilibrium_at_every_unknown() -> None:
    """Whole line in global order: wires, dropper tensions and arm forces, to 1e-9 of the weights (2.4 kN)."""
    line = discretise(simple_line(spans=3), 0.5)
    place = bandwidth_order(line)
    wires = np.concatenate([wire_stiffness(line.beams, row) @ line.state.deflection[row].ravel() for row in range(2)])
    pulled = np.concatenate([weight(line.beams, row, GRAVITY) for row in range(2)])
    for arm, force in zip(line.catenary.steady_arms, line.state.arm_force[:, 1], strict=True):
        pulled[2 * line.mesh.station(arm.position)] += force
    residual = (pulled - wires)[place] - connector_directions(line) @ line.connectors.preload
    supported = {2 * (line.mesh.rows * line.mesh.station(s.position) + 1) for s in line.catenary.messenger_supports}
    free = [unknown for unknown in assemble_matrices(line).free if unknown not in supported]
    np.testing.assert_allclose(residual[free], 0.0, atol=2.4e-6)


def test_initial_state_of_a_regular_span_is_symmetrical() -> None:
    """The middle span of three: equal tensions and lengths from both ends, to rounding."""
    line = discretise(simple_line(spans=3), 0.5)
    for values in (line.state.dropper_tension[9:18], line.state.dropper_length[9:18]):
        np.testing.assert_allclose(values, values[::-1], rtol=1e-9)


def test_tensions_of_a_level_string_are_the_weights_of_its_fields() -> None:
    """Without bending, a dropper of a level wire carries half the wire on either side of it: closed form.

    Elements with continuous slope round the kink at a dropper over their length, an error of order h: extrapolation
    from h = 0.2 and 0.1 m leaves 0.02 % of 0.2 %.
    """
    catenary = simple_line(spans=2)
    strings = tuple(replace(wire, bending_stiffness=0.0) for wire in catenary.wires)
    coarse, fine = (discretise(replace(catenary, wires=strings), h).state for h in (0.2, 0.1))
    supported = np.sort([*(d.position for d in catenary.droppers), 0.0, 60.0, 120.0])
    share = {x: (b - a) / 2 * 1.35 * GRAVITY for a, x, b in zip(supported, supported[1:], supported[2:], strict=False)}
    tension = 2 * fine.dropper_tension - coarse.dropper_tension
    np.testing.assert_allclose(tension, [share[d.position] for d in catenary.droppers], rtol=2e-4)
    assert 2 * fine.arm_force[0, 1] - coarse.arm_force[0, 1] == pytest.approx(share[60.0], rel=2e-4)


def test_wire_is_level_at_an_arm_that_carries_its_share_and_sags_at_one_that_does_not() -> None:
    """An arm without a share leaves 10 m of wire between the droppers: m g l^2 / 8T = 8.3 mm, minus bending."""
    at_arm = []
    for carries_share in (True, False):
        line = discretise(simple_line(spans=3, carries_share=carries_share), 0.5)
        at_arm.append(line.state.deflection[0, line.mesh.station(60.0), 0])
        assert (line.state.arm_force[:, 1] > 0).all() == carries_share
    assert at_arm[0] == 0.0
    assert -1.35 * GRAVITY * 10.0**2 / (8 * 20e3) < at_arm[1] < -6e-3


def test_dropper_that_would_have_to_push_is_refused() -> None:
    """The tension is linear in the height of one dropper: one with 0.5 N is accepted, one with -0.5 N is not."""
    line = simple_line()

    def tension(height: float) -> float:
        droppers = (replace(d, contact_wire_height=height) if d.position == 30.0 else d for d in line.droppers)
        return float(discretise(replace(line, droppers=tuple(droppers)), 1.0).state.dropper_tension[4])

    per_metre = (tension(1e-3) - tension(0.0)) / 1e-3
    light = (0.5 - tension(0.0)) / per_metre
    assert tension(light) == pytest.approx(0.5, rel=1e-6)
    with pytest.raises(NoInitialState, match=r"x = 30 m would have to push with 0\.5 N"):
        tension(light - 1 / per_metre)


def test_wires_that_cross_are_refused() -> None:
    """An encumbrance of 0.2 m is less than the messenger's sag; a dropper at a support may not have the length zero."""
    line = simple_line()
    low = tuple(replace(support, height=0.2) for support in line.messenger_supports)
    short = Dropper(60.0, "messenger", "contact", stiffness=1e5, contact_wire_height=1.2)
    for crossed in (
        replace(line, messenger_supports=low),
        replace(simple_line(carries_share=False), droppers=(short,)),
    ):
        with pytest.raises(NoInitialState, match="wires cross"):
            discretise(crossed, 1.0)


def test_messenger_without_supports_ends_at_the_datum() -> None:
    line = discretise(replace(simple_line(droppers=()), messenger_supports=()), 1.0)
    assert line.state.deflection[1, [0, -1], 0].tolist() == [0.0, 0.0]


def test_dropper_is_as_stiff_as_stated() -> None:
    """EA over its length, or the stated stiffness; without either it only carries its preload."""
    dropper = Dropper(10.0, "messenger", "contact", axial_stiffness=200e3)
    assert dropper.taut_stiffness(0.5) == 400e3
    assert replace(dropper, stiffness=1e5).taut_stiffness(0.5) == 1e5
    assert replace(dropper, axial_stiffness=None).taut_stiffness(0.5) == 0.0


def string_statics(heights: Array) -> Array:
    """Dropper lengths of one of many equal spans, by the statics of loaded strings [m]."""
    x, span = PLACES_2018, 55.0
    around = np.concatenate([[x[-1] - span], x, [x[0] + span]])
    slope = np.diff(np.concatenate([heights[-1:], heights, heights[:1]])) / np.diff(around)
    tension = 1.35 * GRAVITY * (around[2:] - around[:-2]) / 2 - 22e3 * np.diff(slope)
    load = tension + GRAVITY * (0.165 + 0.195 + 0.117 * LENGTHS_2018)
    low, high = np.minimum.outer(x, x), np.maximum.outer(x, x)
    messenger = 1.2 - 1.08 * GRAVITY * x * (span - x) / (2 * 16e3) - (low * (span - high) / span / 16e3) @ load
    return np.asarray(messenger - heights)


def lengths_of_middle_span(heights: Array, bending: float, element_length: float) -> Array:
    """Dropper lengths of the middle span of three [m]."""
    return discretise(simple_line_2018(3, heights, bending), element_length).state.dropper_length[9:18]


@pytest.mark.parametrize("heights", [PRINTED_HEIGHTS, PARABOLA], ids=["printed", "parabola"])
def test_dropper_lengths_without_bending_are_those_of_strings(heights: Array) -> None:
    """Extrapolated from h = 0.1 and 0.05 m (kinks: error of order h), to 0.02 mm; at h = 0.05 m the error is 0.3 mm."""
    coarse, fine = (lengths_of_middle_span(heights, 0.0, h) for h in (0.1, 0.05))
    np.testing.assert_allclose(2 * fine - coarse, string_statics(heights), rtol=0, atol=2e-5)


def test_published_dropper_lengths_follow_from_string_statics() -> None:
    """All nine of the 2018 simple line to the printed millimetre; arms without a share, parabolic pre-sag.

    The printed heights are this parabola rounded to the millimetre, which changes the dropper forces by 4 N and the
    lengths by 0.7 mm: used as printed, they give every length within 1.2 mm.
    """
    np.testing.assert_allclose(string_statics(PARABOLA), LENGTHS_2018, rtol=0, atol=0.6e-3)
    np.testing.assert_allclose(string_statics(PRINTED_HEIGHTS), LENGTHS_2018, rtol=0, atol=1.2e-3)


def test_bending_makes_every_published_dropper_four_millimetres_longer() -> None:
    """Bending rounds the messenger wire at its supports: it hangs higher by its slope there times sqrt(EI / T).

    The slope is half the load of a span over T, 0.042; sqrt(131.7 / 16000) = 91 mm: 3.8 mm along the whole span. The
    rest is due to the contact wire's bending, which shifts 1.2 N from each second dropper to the first, 5.75 m nearer
    to the support: 1.2 * 5.75 / 16e3 = 0.4 mm. Against the printed lengths that is 5 mm at most.
    """
    stiff = lengths_of_middle_span(PARABOLA, 1.0, 0.125)
    shift = stiff - string_statics(PARABOLA)
    load = GRAVITY * (55 * (1.35 + 1.08) + 9 * (0.165 + 0.195) + 0.117 * LENGTHS_2018.sum())
    expected = load / 2 / 16e3 * np.sqrt(131.7 / 16e3)
    np.testing.assert_allclose(shift, expected, rtol=0, atol=0.6e-3)
    assert np.ptp(shift) < 0.1e-3


def test_clamps_join_wires_at_one_height_and_balance_them() -> None:
    """A stitch wire on the messenger: clamps hold both at one height and carry its weight."""
    catenary = simple_line(spans=2)
    stitch = Wire("stitch", Kind.STITCH_WIRE, 52.0, 68.0, 3500.0, 0.31, 0.0)
    clamps = tuple(Clamp(x, "messenger", "stitch", 0.38) for x in (52.0, 68.0))
    line = discretise(replace(catenary, wires=(*catenary.wires, stitch), clamps=clamps), 0.5)
    row = line.mesh.row_of["stitch", "z"]
    messenger = line.mesh.row_of["messenger", "z"]
    for clamp in clamps:
        station = line.mesh.station(clamp.position)
        assert line.state.deflection[row, station, 0] == line.state.deflection[messenger, station, 0]
    middle = line.mesh.station(60.0)
    sag = line.state.deflection[row, line.mesh.station(52.0), 0] - line.state.deflection[row, middle, 0]
    assert sag == pytest.approx(0.31 * GRAVITY * 16.0**2 / (8 * 3500.0), rel=1e-9)
    assert np.abs(line.state.clamp_force[:, 1]).sum() == pytest.approx(0.31 * GRAVITY * 16.0, rel=1e-9)
