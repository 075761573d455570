"""Prescribed heights of arms and anchors: closed form of a heavy wire over an arm, and a line on a ramp."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import DAMPED, Array, bare_wire, simple_line
from pantocheck.model import Catenary, Kind, SteadyArm, Wire
from pantocheck.model.description.catenary import GRAVITY
from pantocheck.model.discretisation.discretised_line import discretise
from pantocheck.model.discretisation.string_statics import compute_string_state
from pantocheck.model.statics.elasticity import height_under_forces, static_uplift

TENSION, BENDING, WEIGHT = 20e3, 195.0, 1.35 * GRAVITY
DECAY = np.sqrt(TENSION / BENDING)
"""Decay of a bending boundary layer [1/m]."""


def field_terms(x: Array, length: float) -> Array:
    """Solutions of EI w'''' = T w'' + q in a field and their first two derivatives, (3, n, 5).

    The columns are q x^2 / 2T, 1, x, and the boundary layers at the left and the right end.
    """
    left, right, one, zero = np.exp(-DECAY * x), np.exp(DECAY * (x - length)), np.ones_like(x), np.zeros_like(x)
    polynomials = [
        np.stack([WEIGHT / TENSION * x**2 / 2, one, x]),
        np.stack([WEIGHT / TENSION * x, zero, one]),
        np.stack([WEIGHT / TENSION * one, zero, zero]),
    ]
    return np.array([[*p, (-DECAY) ** n * left, DECAY**n * right] for n, p in enumerate(polynomials)]).swapaxes(1, 2)


def exact_shape(lengths: tuple[float, float], heights: tuple[float, float, float], x: tuple[Array, Array]) -> Array:
    """Height of a heavy wire, pinned at both ends and held at an arm between them, at positions of both fields.

    The constants of both fields follow from the heights at their ends, no moment at the anchors, and equal slope and
    moment at the arm.
    """
    (a, b), (c, d) = (field_terms(np.array([0.0, length]), length).swapaxes(0, 1) for length in lengths)
    none = np.zeros_like(a)
    ends = [(a[0], none[0]), (b[0], none[0]), (none[0], c[0]), (none[0], d[0])]
    rows = np.array([*ends, (a[2], none[0]), (none[0], d[2]), (b[1], -c[1]), (b[2], -c[2])])
    values = np.array([heights[0], heights[1], heights[1], heights[2], 0.0, 0.0, 0.0, 0.0])
    constants = np.linalg.solve(rows[:, :, 1:].reshape(8, 8), values - rows[:, :, 0].sum(axis=1)).reshape(2, 4)
    fields = zip(x, lengths, constants, strict=True)
    return np.concatenate([field_terms(s, length)[0] @ np.append(1.0, four) for s, length, four in fields])


def test_wire_over_an_arm_hangs_between_prescribed_heights() -> None:
    """Anchors at 0.3 m and 0.5 m, arm at -0.2 m, fields of 20 m and 30 m: closed form with bending layers.

    The layers are 1 / k = 0.1 m long, and elements of 0.05 m leave 3e-6 m. The arm carries the force F of a string, and
    that of the layer of height F / (2 k T), which steepens both fields; the next term is 2e-5 of it.
    """
    wire = replace(bare_wire(50.0).wires[0], end_heights=(0.3, 0.5))
    arm = SteadyArm(20.0, "contact", vertical_stiffness=0.0, carries_share=True, height=-0.2)
    line = discretise(Catenary((wire,), steady_arms=(arm,)), 0.05)
    x = line.mesh.position
    exact = exact_shape((20.0, 30.0), (0.3, -0.2, 0.5), (x[x <= 20.0], x[x > 20.0] - 20.0))
    np.testing.assert_allclose(line.state.deflection[0, :, 0], exact, rtol=0, atol=3e-6)
    string = WEIGHT * 25.0 - TENSION * (0.5 / 20.0 + 0.7 / 30.0)
    layer = string / (2 * DECAY) * (1 / 20.0 + 1 / 30.0)
    assert line.state.arm_force[0, 1] == pytest.approx(string + layer, rel=1e-4)


def lift(catenary: Catenary, height: float, slope: float) -> Catenary:
    """Raise all heights of a simple line along a straight ramp."""

    def raise_ends(wire: Wire) -> Wire:
        level = height if wire.kind is Kind.CONTACT_WIRE else height + 1.2
        return replace(wire, end_heights=(level + slope * wire.start, level + slope * wire.end))

    return replace(
        catenary,
        wires=tuple(map(raise_ends, catenary.wires)),
        droppers=tuple(replace(d, contact_wire_height=height + slope * d.position) for d in catenary.droppers),
        steady_arms=tuple(replace(arm, height=height + slope * arm.position) for arm in catenary.steady_arms),
        messenger_supports=tuple(
            replace(s, height=s.height + height + slope * s.position) for s in catenary.messenger_supports
        ),
    )


def test_line_on_a_ramp_is_the_level_line_plus_the_ramp() -> None:
    """A ramp does not strain a tensioned beam of small slope: forces, lengths and uplifts do not change.

    To 1e-7, because dropper forces of 80 N are differences of nodal forces of 1e9 N.
    """
    level = simple_line(3, damping=DAMPED)
    level = replace(level, messenger_supports=level.messenger_supports[1:-1])
    flat, ramp = lines = [discretise(catenary, 0.5) for catenary in (level, lift(level, 5.3, 0.01))]
    rise = np.broadcast_to(5.3 + 0.01 * flat.mesh.position, flat.state.deflection.shape[:2])
    np.testing.assert_allclose((ramp.state.deflection - flat.state.deflection)[:, :, 0], rise, rtol=1e-9)
    np.testing.assert_allclose(ramp.state.dropper_tension, flat.state.dropper_tension, rtol=1e-7)
    np.testing.assert_allclose(ramp.state.dropper_length, flat.state.dropper_length, rtol=1e-7)
    np.testing.assert_allclose(ramp.state.arm_force, flat.state.arm_force, rtol=1e-7)
    strings = [compute_string_state(line.catenary).dropper_length for line in lines]
    np.testing.assert_allclose(strings[1], strings[0], rtol=1e-7)
    places, forces = np.array([75.0, 90.0]), np.array([100.0, 150.0])
    uplift = [static_uplift(line, places, 150.0) for line in lines]
    np.testing.assert_allclose(uplift[1], uplift[0], rtol=1e-7)
    heights = [height_under_forces(line, places, forces) for line in lines]
    np.testing.assert_allclose(heights[1] - heights[0], 5.3 + 0.01 * places, rtol=1e-7)
