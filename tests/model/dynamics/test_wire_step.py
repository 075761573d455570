"""Wires in a time step: the splitting into symmetric and antisymmetric parts equals the element matrices."""

import numpy as np
import pytest

from helpers.lines import DAMPED, Array, bare_wire
from pantocheck.model.discretised_line import discretise, with_damping
from pantocheck.model.dynamics import wire_step
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import wire_mass, wire_stiffness


def split_mass(h: float) -> Array:
    """Consistent mass over m h / 420 from the constants of the splitting: columns are unit values of w1, r1, w2, r2."""
    matrix = np.zeros((4, 4))
    for column, (w1, r1, w2, r2) in enumerate(np.eye(4)):
        shear = wire_step.MASS_SHEAR * (w1 - w2) + wire_step.MASS_SHEAR_TILT * h * (r1 + r2)
        tilt = h * (wire_step.MASS_SHEAR_TILT * (w1 - w2) + wire_step.MASS_TILT * h * (r1 + r2))
        drag = wire_step.MASS_DRAG * (w1 + w2) + wire_step.MASS_DRAG_BEND * h * (r1 - r2)
        bend = h * (wire_step.MASS_DRAG_BEND * (w1 + w2) + wire_step.MASS_BEND * h * (r1 - r2))
        matrix[:, column] = drag + shear, tilt + bend, drag - shear, tilt - bend
    return matrix


@pytest.mark.parametrize("h", [0.25, 1.0, 3.0])
def test_constants_of_the_splitting_give_the_consistent_mass(h: float) -> None:
    """The equations of the module against `beam.mass`; small numbers: rounding only."""
    np.testing.assert_allclose(split_mass(h), beam.mass(h, 420 / h), rtol=1e-14)


def test_wire_forces_equal_matrix_products() -> None:
    """Random state of 600 elements, more than two pieces: -K (q + beta v) - alpha M v with the assembled matrices."""
    line = with_damping(discretise(bare_wire(300.0), 0.5), DAMPED)
    beams, stations = line.beams, line.mesh.position.size
    assert stations > 2 * wire_step.PIECE
    w, r = np.random.default_rng(0).normal(size=(2, 3, 1, stations))
    motion = Motion(w, r, np.zeros(0), np.zeros(0), np.zeros(1), np.zeros(0))
    q, v = (np.stack([w[i, 0], r[i, 0]], axis=-1).ravel() for i in range(2))
    alpha, beta = beams.mass_coefficient[0], beams.stiffness_coefficient[0]
    expected = -wire_stiffness(beams, 0) @ (q + beta * v) - alpha * (wire_mass(beams, 0) @ v)
    wires, work = wire_step.build_wire_arrays(beams), wire_step.allocate_wire_workspace()
    wire_step.apply_wire_forces(wires, motion, work, Window(0, stations - 1))
    forces = np.stack([w[2, 0], r[2, 0]], axis=-1).ravel()
    np.testing.assert_allclose(forces, expected, rtol=0, atol=1e-13 * np.abs(expected).max())
