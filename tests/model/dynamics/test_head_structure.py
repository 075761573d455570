"""Heads with two strips, roll, bending, friction and stops against full matrices."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import DAMPED, PANTOGRAPH_2002, bare_wire, overlapping_line, simple_line
from helpers.step_differences import THREE_MASSES, largest_differences
from helpers.structured_heads import TWO_STRIPS, structured, zigzag_line
from pantocheck.model import Irregularity, Passage, build_chain, simulate_passage
from pantocheck.model.description.head_structure import (
    MountedStrip,
    Rotation,
    mount_strips,
)
from pantocheck.model.description.pantograph import equilibrium
from pantocheck.model.discretisation.discretised_line import discretise


@pytest.mark.parametrize("law", [{}, {"contact_damping": 60.0}, {"contact_stiffness": np.inf}])
def test_step_equals_full_matrices(law: dict[str, float]) -> None:
    """Two pantographs with two strips each lose contact, slide, stick and hit stops; rigid arms as elsewhere: 1e-8."""
    pantographs = (replace(structured(PANTOGRAPH_2002), **law), replace(structured(THREE_MASSES), **law))
    passage = Passage(pantographs, (24.0, 12.0), 80.0, 0.6, 2e-3)
    line = zigzag_line()
    difference, tension, contact, joint = largest_differences(line, passage, 300, drop=1.0)
    assert (tension[:, line.connectors.unilateral] == 0.0).any()
    lost = contact == 0.0
    assert contact.shape[1] == 4
    assert (np.diff(lost.astype(int), axis=0) != 0).any(axis=0).sum() >= 3
    friction, stops = joint[:, [0, 3]], joint[:, [1, 2, 4, 5]]
    assert ((np.abs(friction) < 12.0).any(axis=0) & (np.abs(friction) == 12.0).any(axis=0)).all()
    assert (stops[:, :2] > 0).any()
    assert max(difference.values()) < 1e-8, difference


def test_strips_share_the_static_force_by_their_lever_arms() -> None:
    """A head that pitches freely: F_1 x_1 = F_2 x_2, whatever the springs of the strips."""
    model = mount_strips(PANTOGRAPH_2002, TWO_STRIPS, Rotation(0.8, 0.0, 0.0))
    np.testing.assert_allclose(model.strip_shares, np.array([0.28, 0.3]) / 0.58, rtol=1e-9)
    _, forces = equilibrium(model, 0.05)
    assert forces.sum() == pytest.approx(equilibrium(PANTOGRAPH_2002, 0.05)[1][0], rel=1e-2)


@pytest.mark.parametrize("structure", ["one strip", "two strips"])
@pytest.mark.parametrize("frequency", [3.0, 12.0, 35.0])
def test_head_on_a_corrugated_rigid_wire_has_the_force_of_its_receptance(structure: str, frequency: float) -> None:
    """Amplitudes and phases from (H (K + i w C - w^2 M)^-1 H^T + 1/k) F = -height: 0.5 % at 0.25 ms up to 35 Hz.

    The wire has 1e9 N and 1 t/m. Each strip meets the corrugation by its distance earlier.
    """
    base = build_chain(np.array([15.0, 3.0]), np.array([4000.0, 9000.0]), np.array([600.0, 80.0]), 120.0, 0, 50e3)
    strips = (MountedStrip(0.3, 2.0, 2e4, 60.0), MountedStrip(-0.2, 2.5, 3e4, 40.0))
    model = base if structure == "one strip" else mount_strips(base, strips, Rotation(0.2, 400.0, 20.0))
    speed, length, step = 20.0, 80.0, 2.5e-4
    wave, amplitude = speed / frequency, 2e-4
    position = np.linspace(0.0, length, 4001)
    shape = Irregularity(tuple(position.tolist()), tuple((amplitude * np.cos(2 * np.pi * position / wave)).tolist()))
    wire = bare_wire(length, tension=1e9, mass_per_length=1e3)
    wire = replace(wire, wires=(replace(wire.wires[0], irregularity=shape),))
    history = simulate_passage(discretise(wire, 2.0), Passage((model,), (10.0,), speed, 3.0, step))
    late = history.time > 2.0
    omega = 2 * np.pi * frequency
    angle = omega * history.time[late]
    drift = np.vander(angle - angle.mean(), 4)  # the wire sags
    terms = np.column_stack([np.cos(angle), np.sin(angle), drift])
    cosine, sine, *_ = np.linalg.lstsq(terms, history.strip_force[:, late].T)[0]
    found = cosine - 1j * sine
    dynamic = model.stiffness + 1j * omega * model.damping - omega**2 * model.mass
    flexibility = model.strip_shapes @ np.linalg.solve(dynamic, model.strip_shapes.T) + np.eye(len(found)) / 50e3
    ahead = np.array([10.0 + strip.offset for strip in model.strips])
    expected = -np.linalg.solve(flexibility, amplitude * np.exp(2j * np.pi * ahead / wave))
    assert np.abs(found - expected).max() < 5e-3 * np.abs(expected).max()


def test_strips_leave_a_wire_one_after_the_other() -> None:
    """At the end of a wire in an overlap the rear strip presses on; the force of the front one is gone at once."""
    section = simple_line(spans=3, span=40.0, droppers=(5.0, 15.0, 25.0, 35.0), damping=DAMPED)
    line = discretise(overlapping_line(rise=0.002, section=section, spans=3), 5.0)
    model = mount_strips(PANTOGRAPH_2002, TWO_STRIPS, Rotation(0.8, 40.0, 3.0))
    difference, _, contact, _ = largest_differences(line, Passage((model,), (114.0,), 80.0, 0.1, 2e-3), 50, drop=-1.5)
    front, rear = contact[:, [0, 2]].T  # on the first wire
    leaves = int(np.flatnonzero(front)[-1])
    assert min(front[leaves], rear[leaves + 1]) > 100.0
    assert max(difference.values()) < 1e-9, difference
