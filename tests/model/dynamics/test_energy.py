"""Energy of a line in free vibration: constant without damping, never increasing with damping."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csc_array

from helpers.lines import Array, fix_along_track, simple_line
from pantocheck.model.description.catenary import Kind, Rayleigh
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, discretise
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.motion import Motion, build_motion, end_of_step
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.reference_kernel import remove_connectors
from pantocheck.model.dynamics.train import build_empty_train
from pantocheck.model.statics.assembly import (
    assemble_matrices,
    bandwidth_order,
    connector_directions,
    correct_mass,
    free_unknowns,
    point_load,
    stretch_directions,
)
from pantocheck.model.statics.static_solver import StaticSolver

EVERY = 5
"""Number of steps between two evaluations of the energy."""


def free_decay(line: DiscretisedLine, time_step: float, steps: int) -> tuple[Array, Array]:
    """Energy about the initial state [J] and dropper tensions [N] after the release of 60 kg from the contact wire.

    Wires and lumped springs store q'Kq / 2, a held stretch k (a'q)^2 / 2, a dropper at tension N stores N^2 / 2k. The
    work of its preload is potential energy, too: it balances the weights.
    """
    rows, load = remove_connectors(line), point_load(line, 0, 20.0)
    matrices, mass = assemble_matrices(rows), correct_mass(line, time_step)
    place, bars = bandwidth_order(line)[matrices.free], csc_array(connector_directions(line)[matrices.free])
    stretches = csc_array(stretch_directions(line)[matrices.free])
    stiffness, preload = line.connectors.stiffness, line.connectors.preload
    kernel, train = build_kernel_arrays(line, time_step), build_empty_train(1)
    motion = _release(line, kernel, load)
    work = build_workspace(kernel, train)
    energy, tensions = [], np.zeros((steps, stiffness.size))
    advance = bind_arrays(step, kernel, motion, train, work)
    for n in range(steps):
        if n % EVERY == 0:
            w, r = end_of_step(motion, kernel.layout, time_step)
            q, v = (np.stack([w[i], r[i]], axis=-1).ravel()[place] for i in range(2))
            tension = preload + stiffness * (bars.T @ q)
            tension = np.where(line.connectors.unilateral, np.maximum(0.0, tension), tension)
            bars_store = (tension**2 - preload**2) / (2 * stiffness) - preload * (bars.T @ q)
            stretched = line.stretches.stiffness @ (stretches.T @ q) ** 2 / 2
            energy.append(v @ mass @ v / 2 + q @ matrices.stiffness @ q / 2 + bars_store.sum() + stretched)
        assert advance()
        tensions[n] = motion.force[: stiffness.size]
    return np.array(energy), tensions


def _release(line: DiscretisedLine, kernel: KernelArrays, load: Array) -> Motion:
    """State at the release: deflected by 600 N, with the acceleration M^-1 times the removed weight."""
    deflection = StaticSolver(line).deflection(-600.0 * load)
    mass, free = correct_mass(line, kernel.time_step).toarray(), free_unknowns(line)
    acceleration = np.zeros(line.beams.free.size)
    acceleration[bandwidth_order(line)[free]] = np.linalg.solve(mass, 600.0 * load[free])
    fields = np.zeros((3, *line.beams.free.shape))
    fields[0], fields[2] = deflection.displacement, acceleration.reshape(line.beams.free.shape)
    force = np.append(deflection.tension, np.zeros(line.stretches.stiffness.size))
    return build_motion(kernel.layout, kernel.time_step, (fields[..., 0], fields[..., 1]), force)


def damped_line(damping: dict[Kind, Rayleigh]) -> DiscretisedLine:
    """Two short spans; arms with a mass, so that they can be damped."""
    catenary = simple_line(2, 44.0, (4.0, 14.0, 24.0, 32.0, 40.0), damping)
    return discretise(replace(catenary, steady_arms=tuple(replace(a, mass=1.0) for a in catenary.steady_arms)), 1.0)


def test_energy_of_the_undamped_line_is_constant_to_second_order() -> None:
    """Average acceleration conserves the energy of a linear system exactly; only transitions of droppers cause errors.

    Over 3000 steps of 1 ms, with hundreds of transitions, at most 1 %. The error of each transition is of order dt^2:
    half the step must leave a third or less (a quarter on average).
    """
    drifts = []
    for time_step, steps in ((1e-3, 3000), (5e-4, 6000)):
        energy, tension = free_decay(damped_line({}), time_step, steps)
        assert (np.diff((tension == 0.0).astype(int), axis=0) == 1).sum() > 200
        drifts.append(np.abs(energy / energy[0] - 1).max())
    assert drifts[0] < 0.01
    assert drifts[1] < drifts[0] / 3


def test_energy_is_exactly_constant_with_bilateral_droppers() -> None:
    """The system is linear: rounding of 3000 steps, each with 1e-9 N left by the sweeps times millimetres."""
    line = damped_line({})
    bilateral = line.connectors._replace(unilateral=np.zeros_like(line.connectors.unilateral))
    energy, tension = free_decay(replace(line, connectors=bilateral), 1e-3, 3000)
    assert tension.min() < 0
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)


@pytest.mark.parametrize(("time_step", "steps"), [(1e-3, 3000), (50e-3, 1000)])
def test_energy_is_exactly_constant_with_held_stretches(time_step: float, steps: int) -> None:
    """Average acceleration is stable at any step; here also at a hundred times that of a passage, as exactly as above.

    With 1e9 N of axial stiffness the additional tension changes itself by 1.6 times within the long step (0.0002 times
    at 14 MN and 1 ms), so that a force of the last step would make the method diverge.
    """
    catenary = simple_line(2, 44.0, (4.0, 14.0, 24.0, 32.0, 40.0))
    line = discretise(fix_along_track(catenary, 1e9), 1.0)
    bilateral = line.connectors._replace(unilateral=np.zeros_like(line.connectors.unilateral))
    energy, _ = free_decay(replace(line, connectors=bilateral), time_step, steps)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)


@pytest.mark.parametrize("kind", [Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE, Kind.DROPPER, Kind.STEADY_ARM])
def test_damping_never_adds_energy(kind: Kind) -> None:
    """Damping of one component at a time: any gain over an earlier energy is the error of dropper transitions.

    This error changes the undamped energy by 0.1 % at this step. The dissipation of wires and droppers exceeds it at
    any time, that of the single arm (0.15 % in total) nearly.
    """
    energy, tension = free_decay(damped_line({kind: Rayleigh(0.2, 1e-3)}), 5e-4, 2000)
    assert (tension == 0.0).any()
    gained = (energy - np.minimum.accumulate(energy)).max() / energy[0]
    assert gained < 2e-4
    assert energy[-1] < 0.999 * energy[0]
