"""Wires in a time step: the splitting into symmetric and antisymmetric parts equals the element matrices."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import DAMPED, Array, bare_wire, simple_line
from pantocheck.model.discretisation.discretised_line import discretise, with_damping
from pantocheck.model.dynamics import wire_step
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.extents import find_extents, merge_extents
from pantocheck.model.dynamics.motion import Layout, build_motion
from pantocheck.model.dynamics.vectors import round_up
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import assemble_row, element_stiffness, wire_stiffness


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
    """Random state of 600 elements: -K (q + beta v) - alpha M v in the predicted state, with the assembled matrices.

    The predictors are q + dt v + dt^2 a and v + dt a.
    """
    line, dt = with_damping(discretise(bare_wire(300.0), 0.5), DAMPED), 1e-3
    beams, stations = line.beams, line.mesh.position.size
    layout = Layout(stations, round_up(stations) + 16)
    state = np.random.default_rng(0).normal(size=(2, 3, 1, stations))
    motion = build_motion(layout, 0.0, (state[0], state[1]), np.zeros(0))
    q, v, a = state.transpose(1, 3, 0, 2).reshape(3, -1)
    q, v = q + dt * v + dt**2 * a, v + dt * a
    alpha, beta = beams.mass_coefficient[0], beams.stiffness_coefficient[0]
    mass = assemble_row(beam.mass(beams.length, beams.mass_per_length[0]))
    expected = -wire_stiffness(beams, 0) @ (q + beta * v) - alpha * (mass @ v)
    wires = wire_step.build_wire_arrays(beams, merge_extents(find_extents(beams), 8), layout)
    wire_step.predict_wires(dt, wires, motion, Window(0, round_up(stations) - 1))
    computed = np.stack([motion.w, motion.r], axis=-1)[:, 0, :stations].reshape(3, -1)
    for values, exact in zip(computed, (q, v, expected), strict=True):
        np.testing.assert_allclose(values, exact, rtol=0, atol=1e-13 * np.abs(exact).max())


@pytest.mark.parametrize(("first", "last"), [(0, 63), (64, 127), (320, 359)])
def test_window_is_held_by_its_neighbours(first: int, last: int) -> None:
    """Inside a window the forces are those of the whole line with the neighbours at rest; outside nothing changes."""
    line, dt = with_damping(discretise(bare_wire(180.0), 0.5), DAMPED), 1e-3
    stations = line.mesh.position.size
    layout = Layout(stations, round_up(stations) + 16)
    state = np.random.default_rng(1).normal(size=(2, 3, 1, stations))
    state[:, 1:, :, :first] = state[:, 1:, :, last + 1 :] = 0.0
    wires = wire_step.build_wire_arrays(line.beams, merge_extents(find_extents(line.beams), 8), layout)
    whole, inside = (build_motion(layout, 0.0, (state[0], state[1]), np.zeros(0)) for _ in range(2))
    before = inside.w.copy()
    wire_step.predict_wires(dt, wires, whole, Window(0, round_up(stations) - 1))
    wire_step.predict_wires(dt, wires, inside, Window(first, last))
    np.testing.assert_array_equal(inside.w[..., first : last + 1], whole.w[..., first : last + 1])
    np.testing.assert_array_equal(
        np.delete(inside.w, np.r_[first : last + 1], 2), np.delete(before, np.r_[first : last + 1], 2)
    )


def test_equal_rows_of_elements_are_stored_once() -> None:
    """Two fields of a contact wire and of a messenger wire: two rows; the entries of every row are its own."""
    line = simple_line(damping=DAMPED)
    contact, messenger = line.wires
    stagger = ((0.0, 0.2), (60.0, -0.2), (120.0, 0.2))
    line = replace(line, wires=(replace(contact, stagger=stagger), replace(messenger, stagger=stagger)))
    beams = discretise(line, 2.0).beams
    elements = beams.length.size
    layout = Layout(elements + 1, round_up(elements + 1) + 16)
    wires = wire_step.build_wire_arrays(beams, merge_extents(find_extents(beams), 8), layout)
    assert wires.elements.shape[0] == 2
    assert wires.element_row.size == 4
    for row, number in enumerate(wires.element_row):
        k11, k12, alike, apart, damped_mass, length = wires.elements[number, :, :elements]
        matrices = element_stiffness(beams, row)
        np.testing.assert_array_equal(k11, matrices[:, 0, 0])
        np.testing.assert_array_equal(k12, matrices[:, 0, 1])
        np.testing.assert_allclose(alike + apart, matrices[:, 1, 1], rtol=1e-14)
        np.testing.assert_allclose(alike - apart, matrices[:, 1, 3], rtol=1e-14)
        mass = beams.mass_coefficient[row] * beams.mass_per_length[row] * beams.length / 420
        np.testing.assert_allclose(damped_mass, mass, rtol=1e-14)
        np.testing.assert_array_equal(length, beams.length)
