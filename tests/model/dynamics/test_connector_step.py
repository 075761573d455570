"""Connectors in a time step: tensions after the sweeps fit the law of the droppers and the motion."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.effective_inverse import inverse_of_assembled
from helpers.lines import DAMPED, Array, overlapping_line, simple_line
from pantocheck.model import Catenary
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, discretise
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.connector_step import (
    accelerate_connectors,
    connector_ends,
    load_connectors,
    predict_connectors,
)
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, Workspace, build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.motion import Motion, build_motion
from pantocheck.model.dynamics.panels import solve_wires
from pantocheck.model.dynamics.scalar_forces import FORCE_TOLERANCE, sweep_forces
from pantocheck.model.dynamics.train import build_empty_train

TIME_STEP = 1e-3


def swept_state() -> tuple[DiscretisedLine, KernelArrays, Motion, Workspace, int]:
    """Two spans, the contact wire lifted by 5 mm between x = 20 m and x = 40 m, after sweeps over the connectors."""
    line = discretise(simple_line(damping=DAMPED), 1.0)
    kernel = build_kernel_arrays(line, TIME_STEP)
    rows, stations = line.beams.free.shape[:2]
    w, r = np.zeros((3, rows, stations)), np.zeros((3, rows, stations))
    lifted = (line.mesh.position > 20.0) & (line.mesh.position < 40.0)
    w[0, line.contact_rows[0], lifted] = 5e-3
    motion = build_motion(kernel.layout, TIME_STEP, (w, r), line.connectors.preload)
    window, work = Window(0, kernel.layout.width - 1), build_workspace(kernel, build_empty_train(1))
    predict_connectors(kernel.connectors, kernel.forces, motion, work.scalar, window)
    accelerate_connectors(kernel.connectors, motion, work.node, work.scalar, window)
    sweeps, number = 1, line.connectors.station.size
    while sweep_forces(kernel.forces, work.scalar, motion.force, 0, number) > FORCE_TOLERANCE:
        sweeps += 1
    load_connectors(kernel.connectors, motion, work.scalar, window)
    solve_wires(kernel.panels, kernel.wires.extents, window, motion.w, motion.r, work.panels)
    return line, kernel, motion, work, sweeps


def elongation(line: DiscretisedLine, plane: Array) -> Array:
    """Elongation of every connector from the deflections of all rows."""
    return np.einsum("nb,nb->n", line.connectors.coefficient, plane.T[line.connectors.station])


def test_sweeps_settle_within_a_few() -> None:
    """Droppers 6 m apart hardly influence each other within a step of 1 ms."""
    assert swept_state()[-1] <= 4


def test_tensions_follow_the_law_of_unilateral_droppers() -> None:
    """N = max(0, N0 + k d + c d') with the elongation at the end of the step, to the tolerance of the sweeps."""
    line, _, motion, _, _ = swept_state()
    connectors, acceleration = line.connectors, elongation(line, motion.w[2])
    displacement = elongation(line, motion.w[0]) + TIME_STEP**2 / 4 * acceleration
    rate = TIME_STEP / 2 * acceleration
    law = np.maximum(0.0, connectors.preload + connectors.stiffness * displacement + connectors.damping * rate)
    np.testing.assert_allclose(motion.force, law, rtol=0, atol=1e-7)
    assert (motion.force == 0.0).any()
    assert (motion.force > 0.0).any()


def test_sweeps_know_the_accelerations_of_the_solved_line() -> None:
    """Local columns and compliances against the solution with all tensions as loads; cut columns: 1e-12."""
    line, _, motion, work, _ = swept_state()
    solved = elongation(line, motion.w[2])
    np.testing.assert_allclose(work.scalar.acceleration, solved, rtol=0, atol=1e-9 * np.abs(motion.w[2]).max())


def zigzag() -> Catenary:
    """Line with inclined droppers and arms, whose ends share nodes."""
    line = simple_line(3, 40.0, (5.0, 15.0, 25.0, 35.0), DAMPED)
    contact, messenger = line.wires
    stagger = ((0.0, 0.2), (40.0, -0.2), (80.0, 0.2), (120.0, -0.2))
    wires = replace(contact, stagger=stagger), replace(messenger, stagger=tuple((x, 0.0) for x, _ in stagger))
    arms = tuple(replace(arm, vertical_stiffness=None, length=1.2) for arm in line.steady_arms)
    return replace(line, wires=wires, steady_arms=arms)


@pytest.mark.parametrize("catenary", [simple_line(damping=DAMPED), zigzag(), overlapping_line(3, 3)])
def test_compliances_are_those_of_the_assembled_inverse(catenary: Catenary) -> None:
    """G A^-1 G' with full matrices; the local columns are cut at 1e-12 of their peaks."""
    line = discretise(catenary, 2.0)
    forces, connectors = build_kernel_arrays(line, TIME_STEP).forces, line.connectors
    directions = np.zeros((connectors.station.size, *line.beams.free.shape))
    for n, station in enumerate(connectors.station):
        directions[n, :, station, 0] = connectors.coefficient[n]
    flat = directions.reshape(len(directions), -1)
    expected = flat @ inverse_of_assembled(line, TIME_STEP).reshape(flat.shape[1], -1) @ flat.T
    computed = np.zeros_like(expected)
    for n in range(len(flat)):
        pairs = slice(forces.first[n], forces.first[n + 1])
        computed[n, forces.other[pairs]] = forces.compliance[pairs]
    np.testing.assert_allclose(computed, expected, rtol=0, atol=1e-11 * np.abs(expected).max())
    pairs_of = np.repeat(np.arange(len(flat)), np.diff(forces.first)), forces.other
    assert len(set(zip(*pairs_of, strict=True))) == forces.other.size  # every pair once
    gain = TIME_STEP**2 / 4 * connectors.stiffness + TIME_STEP / 2 * connectors.damping
    np.testing.assert_allclose(forces.self_compliance, gain * np.diag(expected), rtol=1e-10)


def test_ends_are_listed_connector_by_connector() -> None:
    """A dropper of a vertical line has two ends at one station."""
    line = discretise(simple_line(), 1.0)
    ends = connector_ends(line.connectors)
    assert [station for _, station in ends[:4]] == np.repeat(line.connectors.station[:2], 2).tolist()
    assert {row for row, _ in ends} == {0, 1}
