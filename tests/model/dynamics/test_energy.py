"""Energy of a line left to itself: kept without damping, never gained with it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csc_array

from helpers.lines import Array, simple_line, without_connectors
from pantocheck.model.catenary import Kind, Rayleigh
from pantocheck.model.discretised_line import DiscretisedLine, discretise
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.motion import Motion, motion_at_rest
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.train import empty_train
from pantocheck.model.fem.assembly import (
    assemble_matrices,
    bandwidth_order,
    connector_directions,
    free_unknowns,
    point_load,
    stepping_mass,
)
from pantocheck.model.statics.static_solver import StaticSolver

EVERY = 5
"""The energy is taken at every so many steps."""


def free_decay(line: DiscretisedLine, time_step: float, steps: int) -> tuple[Array, Array]:
    """Energy about the initial state [J] and dropper tensions [N] after a weight of 60 kg falls off the contact wire.

    The wires, lumped springs and taut droppers store q'Kq / 2; a dropper at tension N stores N^2 / 2k, and what its
    preload does is potential energy, too: it was in balance with the weights.
    """
    rows, taken = without_connectors(line), point_load(line, 0, 20.0)
    matrices, mass = assemble_matrices(rows), stepping_mass(line, time_step)
    place, bars = bandwidth_order(line)[matrices.free], csc_array(connector_directions(line)[matrices.free])
    stiffness, preload = line.connectors.stiffness, line.connectors.preload
    motion = motion_at_rest(StaticSolver(line).deflection(-600.0 * taken))
    _accelerate(line, time_step, motion, taken)
    stepping, train = build_kernel_arrays(line, time_step), empty_train(1)
    work = build_workspace(stepping, train)
    energy, tensions = [], np.zeros((steps, stiffness.size))
    for n in range(steps):
        if n % EVERY == 0:
            q, v = (np.stack([motion.w[i], motion.r[i]], axis=-1).ravel()[place] for i in range(2))
            tension = preload + stiffness * (bars.T @ q)
            tension = np.where(line.connectors.unilateral, np.maximum(0.0, tension), tension)
            bars_store = (tension**2 - preload**2) / (2 * stiffness) - preload * (bars.T @ q)
            energy.append(v @ mass @ v / 2 + q @ matrices.stiffness @ q / 2 + bars_store.sum())
        assert step(stepping, motion, train, work)
        tensions[n] = motion.tension
    return np.array(energy), tensions


def _accelerate(line: DiscretisedLine, time_step: float, motion: Motion, taken: Array) -> None:
    """Give the line the acceleration with which it starts when the weight is gone: A(0) = M^-1 of the weight."""
    mass, free = stepping_mass(line, time_step).toarray(), free_unknowns(line)
    acceleration = np.zeros(line.beams.free.size)
    acceleration[bandwidth_order(line)[free]] = np.linalg.solve(mass, 600.0 * taken[free])
    shaped = acceleration.reshape(line.beams.free.shape)
    motion.w[2], motion.r[2] = shaped[..., 0], shaped[..., 1]


def line_of(damping: dict[Kind, Rayleigh]) -> DiscretisedLine:
    """Two short spans with dampable arms."""
    catenary = simple_line(2, 44.0, (4.0, 14.0, 24.0, 32.0, 40.0), damping)
    return discretise(replace(catenary, steady_arms=tuple(replace(a, mass=1.0) for a in catenary.steady_arms)), 1.0)


def test_energy_of_the_undamped_line_is_kept_to_the_second_order() -> None:
    """Average acceleration keeps a linear system's energy exactly; only the moments of slackening and tightening err.

    Over 3000 steps of 1 ms, in which droppers go slack hundreds of times, 1 % at the most; and the error of each moment
    is of order dt^2, so half the step must leave a third or less (a quarter, but for the luck of the moments).
    """
    drifts = []
    for time_step, steps in ((1e-3, 3000), (5e-4, 6000)):
        energy, tension = free_decay(line_of({}), time_step, steps)
        assert (np.diff((tension == 0.0).astype(int), axis=0) == 1).sum() > 200
        drifts.append(np.abs(energy / energy[0] - 1).max())
    assert drifts[0] < 0.01
    assert drifts[1] < drifts[0] / 3


def test_energy_is_exact_while_droppers_pull_and_push() -> None:
    """Linear, hence exact: 3000 steps of rounding, each 1e-9 N of turns left over times millimetres moved."""
    line = line_of({})
    bilateral = line.connectors._replace(unilateral=np.zeros_like(line.connectors.unilateral))
    energy, tension = free_decay(replace(line, connectors=bilateral), 1e-3, 3000)
    assert tension.min() < 0
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)


@pytest.mark.parametrize("kind", [Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE, Kind.DROPPER, Kind.STEADY_ARM])
def test_damping_never_adds_energy(kind: Kind) -> None:
    """Damping of one component at a time: what is gained over any earlier energy is the error of slackening alone.

    That error moves the undamped energy by 0.1 % at this step; what the wires and droppers damp exceeds it at every
    moment, what the one arm damps (0.15 % in all) does not quite.
    """
    energy, tension = free_decay(line_of({kind: Rayleigh(0.2, 1e-3)}), 5e-4, 2000)
    assert (tension == 0.0).any()
    gained = (energy - np.minimum.accumulate(energy)).max() / energy[0]
    assert gained < 2e-4
    assert energy[-1] < 0.999 * energy[0]
