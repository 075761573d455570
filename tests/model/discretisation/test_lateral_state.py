"""Lateral state: closed forms, and the vertical plane as a limit."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import PANTOGRAPH_2002, Array, simple_line
from pantocheck.model import (
    Catenary,
    Clamp,
    DiscretisedLine,
    Dropper,
    Kind,
    Passage,
    Rayleigh,
    SteadyArm,
    TrackCurve,
    Wire,
    discretise,
    simulate_passage,
)
from pantocheck.model.description.catenary import Spring
from pantocheck.model.description.pantograph import preload_springs
from pantocheck.model.discretisation.connectors import RIGID
from pantocheck.model.fem.beams import wire_stiffness
from pantocheck.model.fem.residual_flexibility import station_flexibility
from pantocheck.model.statics.elasticity import static_uplift

SPAN, STAGGER, TENSION = 60.0, 0.2, 20e3
PANTOGRAPH = preload_springs(PANTOGRAPH_2002, np.full(2, 0.06))


def with_stagger(catenary: Catenary, contact: float, spans: int) -> Catenary:
    """Line with a zigzag contact wire and a straight messenger wire; arms of 1 m with the stiffness of their force."""
    plans = {
        Kind.CONTACT_WIRE: tuple((SPAN * n, contact if n % 2 else -contact) for n in range(spans + 1)),
        Kind.MESSENGER_WIRE: tuple((SPAN * n, 0.0) for n in range(spans + 1)),
    }
    return replace(
        catenary,
        wires=tuple(replace(wire, stagger=plans[wire.kind]) for wire in catenary.wires),
        steady_arms=tuple(replace(arm, vertical_stiffness=None, length=1.0) for arm in catenary.steady_arms),
    )


def zigzag(acts: str = "pull", length: float = 1.2, spans: int = 5) -> DiscretisedLine:
    """A bare contact wire between steady arms."""
    wire = Wire("contact", Kind.CONTACT_WIRE, 0.0, spans * SPAN, TENSION, 1.35, 195.0)
    plan = tuple((SPAN * n, STAGGER if n % 2 else -STAGGER) for n in range(spans + 1))
    arms = tuple(SteadyArm(SPAN * n, "contact", length=length, acts=acts) for n in range(1, spans))  # type: ignore[arg-type]
    return discretise(Catenary((replace(wire, stagger=plan),), steady_arms=arms), 0.25)


def passage(speed: float = 70.0, duration: float = 0.6) -> Passage:
    return Passage((PANTOGRAPH,), (70.0,), speed, duration, 1e-3)


def test_zero_stagger_gives_the_forces_of_the_vertical_plane() -> None:
    """Rounding of 600 steps with forces of 1e2 N: 1e-7 N."""
    spans = 4
    plane = simple_line(spans)
    plane = replace(plane, steady_arms=tuple(replace(arm, vertical_stiffness=None) for arm in plane.steady_arms))
    lateral = discretise(with_stagger(plane, 0.0, spans), 0.5)
    assert "y" in lateral.mesh.row_field
    flat = discretise(plane, 0.5)
    assert "y" not in flat.mesh.row_field
    assert lateral.state.dropper_length == pytest.approx(flat.state.dropper_length, rel=1e-13)
    force, expected = (simulate_passage(line, passage()).force for line in (lateral, flat))
    assert np.ptp(expected) > 50
    assert np.abs(force - expected).max() < 1e-7


def test_steady_arm_carries_the_change_of_direction_of_the_wire() -> None:
    """T times the kink, 4 a T / L; bending rounds the corner over sqrt(EI / T) = 0.1 m of 60 m: less than 1 % more."""
    line = zigzag()
    by_hand = 4 * STAGGER * TENSION / SPAN
    inner = line.state.arm_force[1:-1, 0]
    assert np.abs(inner) == pytest.approx(by_hand, rel=0.01)
    # Pulled outwards: a wire at positive stagger towards positive y.
    assert np.sign(inner).tolist() == [-1.0, 1.0]
    # In a curve of radius R the arms carry the radial force T L / R as well.
    curve = TrackCurve(-1.0, 301.0, 1000.0)
    curved = discretise(replace(line.catenary, curves=(curve,)), 0.25).state.arm_force[1:-1, 0]
    assert curved - inner == pytest.approx(-TENSION * SPAN / 1000.0, rel=0.01)


def test_bars_act_along_their_directions_and_are_damped_in_proportion_to_their_stiffness() -> None:
    """Clamps in both fields, springs in the vertical one; C = beta K of droppers and arms if the wires have this beta.

    Bars in series with flexible wires of the same beta keep the ratio.
    """
    line = with_stagger(simple_line(damping=dict.fromkeys(Kind, Rayleigh(0.0, 1e-3))), STAGGER, 2)
    stitch = Wire("stitch", Kind.STITCH_WIRE, 52.0, 68.0, 3e3, 0.3, 0.0)
    line = replace(
        line, wires=(*line.wires, stitch), clamps=tuple(Clamp(x, "messenger", "stitch") for x in (52.0, 68.0)),
        springs=(Spring(90.0, "messenger", "contact", 1e3),),
    )  # fmt: skip
    discretised = discretise(line, 0.5)
    bars, rows = discretised.connectors, [discretised.mesh.row_of["messenger", axis] for axis in "yz"]
    assert bars.coefficient[18:23, rows].tolist() == [[0, 1], [1, 0], [0, 1], [1, 0], [0, 1]]
    damped = [*range(18), -1]  # droppers, and the steady arm across its axis
    assert bars.damping[damped] == pytest.approx(1e-3 * bars.stiffness[damped], rel=1e-9)


@pytest.mark.parametrize(("acts", "sign"), [("pull", 1.0), ("push", -1.0)])
def test_arm_is_a_pendulum_under_its_axial_force(acts: str, sign: float) -> None:
    """Transverse stiffness force over length, negative for a pushing arm; rigid along its length.

    Both are in series with the residual flexibility of the wire: 1e-5 of the transverse stiffness.
    """
    line = zigzag(acts, length=1.2)
    force = np.abs(line.state.arm_force[:, 0])
    stiffness, vertical = line.connectors.stiffness, line.mesh.row_of["contact", "z"]
    across = np.abs(line.connectors.coefficient[:, vertical]) > 0.5
    assert stiffness[across] == pytest.approx(sign * force / 1.2, rel=2e-5)
    residual = station_flexibility(line.beams.flexibility[vertical])[line.connectors.station[~across]]
    assert 1 / stiffness[~across] == pytest.approx(1 / RIGID + residual, rel=1e-12)


def test_pushing_arm_makes_the_wire_softer_at_the_support() -> None:
    """One arm in the middle of a wire: 4 T / L of the wire, plus or minus the force of the arm over its length."""
    lines = [zigzag(acts, spans=2) for acts in ("pull", "push")]
    pull, push = (1 / static_uplift(line, np.array([SPAN]), 1.0)[0] for line in lines)
    force = abs(lines[0].state.arm_force[0, 0])
    # Load and arm are at one point; their residual flexibilities count on their own, 3e-7 m/N of 1 / (1,500 N/m).
    assert pull - push == pytest.approx(2 * force / 1.2, rel=2e-3)
    # Bending rounds the peak under the load over 0.1 m of 60 m: 0.3 % on the wire's share.
    assert (pull + push) / 2 == pytest.approx(4 * TENSION / (2 * SPAN), rel=0.005)


def test_lateral_forces_balance_on_every_station() -> None:
    """Tension of the wires against the inclined droppers: zero, to rounding, where no arm or support acts."""
    spans = 4
    line = discretise(with_stagger(simple_line(spans), STAGGER, spans), 0.5)
    for name, side in (("contact", 1.0), ("messenger", -1.0)):
        row = line.mesh.row_of[name, "y"]
        stiffness = wire_stiffness(line.beams, row)
        left = -(stiffness @ line.state.deflection[row].ravel())[::2]
        for n, dropper in enumerate(line.catenary.droppers):
            left[line.mesh.station(dropper.position)] += (
                side * line.state.dropper_tension[n] * line.state.dropper_direction[n, 0]
            )
        supports = [line.mesh.station(SPAN * n) for n in range(spans + 1)]
        free = np.setdiff1d(np.arange(line.mesh.position.size), supports)
        assert np.abs(left[free]).max() < 1e-8
        if name == "contact":
            for arm, force in zip(line.catenary.steady_arms, line.state.arm_force, strict=True):
                assert left[line.mesh.station(arm.position)] + force[0] == pytest.approx(0.0, abs=1e-8)


def test_inclined_droppers_lie_along_the_line_between_their_wires() -> None:
    spans = 4
    flat = simple_line(spans)
    line, plane = discretise(with_stagger(flat, STAGGER, spans), 0.5), discretise(flat, 0.5)
    rise = plane.state.dropper_length
    between = _between(line)
    assert line.state.dropper_length == pytest.approx(np.hypot(rise, between), rel=1e-12)
    assert line.state.dropper_direction[:, 0] == pytest.approx(between / line.state.dropper_length, abs=1e-12)
    # The vertical component of the tension does not depend on the stagger.
    slanted = plane.state.dropper_tension * line.state.dropper_length / rise
    assert line.state.dropper_tension == pytest.approx(slanted, rel=1e-9)
    assert np.abs(between).max() > 0.1


def _between(line: DiscretisedLine) -> Array:
    y = line.state.deflection[..., 0]
    upper, lower = line.mesh.row_of["messenger", "y"], line.mesh.row_of["contact", "y"]
    station = [line.mesh.station(dropper.position) for dropper in line.catenary.droppers]
    return np.asarray(y[upper, station] - y[lower, station])


def test_mirrored_stagger_gives_the_same_forces() -> None:
    """The vertical motion does not depend on the side of the stagger, to rounding."""
    spans = 4
    lines = [discretise(with_stagger(simple_line(spans), side * STAGGER, spans), 0.5) for side in (1.0, -1.0)]
    left, right = (simulate_passage(line, passage(duration=0.3)).force for line in lines)
    assert np.abs(left - right).max() < 1e-7


def test_two_contact_wires_equal_one_of_double_tension_mass_and_stiffness() -> None:
    """Two contact wires share the contact force equally, so that they act as one."""
    single = simple_line(3, dropper_stiffness=2e5)
    contact, messenger = single.wires
    doubled = replace(
        contact, tension=2 * contact.tension, mass_per_length=2.70, bending_stiffness=2 * contact.bending_stiffness
    )
    heavy = replace(single, wires=(doubled, messenger))
    names = ("left", "right")
    droppers = tuple(Dropper(d.position, d.upper, name, stiffness=1e5) for d in single.droppers for name in names)
    arms = tuple(replace(arm, wire=name, vertical_stiffness=150.0) for arm in single.steady_arms for name in names)
    parallel = replace(
        single,
        wires=(*(replace(contact, name=name) for name in names), messenger),
        droppers=droppers,
        steady_arms=arms,
    )
    # Each wire has its own penalty contact: two of half the stiffness equal one.
    half = replace(PANTOGRAPH, contact_stiffness=PANTOGRAPH.contact_stiffness / 2)
    single_contact = passage(duration=0.6)
    two_contacts = replace(single_contact, pantographs=(half,))
    force = simulate_passage(discretise(parallel, 0.5), two_contacts).force
    expected = simulate_passage(discretise(heavy, 0.5), single_contact).force
    assert np.ptp(expected) > 50
    assert np.abs(force - expected).max() < 1e-6
