"""Convergence of the time integration with the time step."""

from itertools import pairwise

import numpy as np
from scipy.linalg import eigh

from helpers.lines import Array, bare_wire, simple_line
from pantocheck.model import Passage, build_chain
from pantocheck.model.discretisation.discretised_line import discretise
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.motion import build_motion, end_of_step
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.dynamics.train import build_empty_train
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order


def test_free_vibration_converges_with_second_order() -> None:
    """A line with taut droppers in its modes 3, 7 and 12, against their exact cosines.

    Order 2 within 0.15: the error of waves on a string is of order 4, that of bending and of connectors of order 2.
    Average acceleration with the plain mass lags by w t (w dt)^2 / 12; a twentieth of that remains.
    """
    line = discretise(simple_line(spans=2), 2.0)
    matrices = assemble_matrices(line)
    w2, shapes = eigh(matrices.stiffness.toarray(), matrices.mass.toarray())
    chosen = [2, 6, 11]
    amplitude, omega = 1e-4 * shapes[:, chosen], np.sqrt(w2[chosen])
    place, duration, errors = bandwidth_order(line)[matrices.free], 0.8, []

    def spread(values: Array) -> tuple[Array, Array]:
        full = np.zeros((3, line.beams.free.size))
        full[:, place] = values
        shaped = full.reshape(3, *line.beams.free.shape)
        return shaped[..., 0].copy(), shaped[..., 1].copy()

    for time_step in (4e-3, 2e-3, 1e-3):
        kernel, train = build_kernel_arrays(line, time_step), build_empty_train(1)
        initial = np.array([amplitude.sum(axis=1), np.zeros(place.size), -amplitude @ omega**2])
        motion = build_motion(kernel.layout, time_step, spread(initial), line.connectors.preload)
        work = build_workspace(kernel, train)
        advance = bind_arrays(step, kernel, motion, train, work)
        for _ in range(round(duration / time_step)):
            assert advance()
            assert (motion.force > 0).all()
        exact, _ = spread(np.array([amplitude @ np.cos(omega * duration)] * 3))
        errors.append(np.abs(end_of_step(motion, kernel.layout, time_step)[0][0] - exact[0]).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 2.0, atol=0.15)
    late = omega * duration * (omega * time_step) ** 2 / 12
    plain, _ = spread(np.array([amplitude @ (late * np.sin(omega * duration))] * 3))
    assert errors[-1] < np.abs(plain[0]).max() / 20


# Without a base spring the pantograph rests at any height with its uplift force: the start is an equilibrium.
PANTOGRAPH = build_chain(np.array([15.0, 7.2]), np.array([0.0, 4200.0]), np.zeros(2), 120.0, 0, 5e3)


def test_contact_force_converges_with_second_order() -> None:
    """A standing pantograph with an uplift force that rises by 30 N in half a second: a smooth problem.

    The pulse 30 sin^4 starts and ends with three vanishing derivatives, so that only the time step causes errors;
    order 2 within 0.1. (A running pantograph converges more slowly: it starts abruptly and crosses elements.)
    """
    line, duration, forces = discretise(bare_wire(60.0), 1.0), 0.5, []
    for halvings in range(4):
        time_step = 4e-3 / 2**halvings
        kernel = build_kernel_arrays(line, time_step)
        motion, train = start_motion(line, kernel, Passage((PANTOGRAPH,), (27.3,), 0.0, duration, time_step))
        work, force = build_workspace(kernel, train), []
        advance = bind_arrays(step, kernel, motion, train, work)
        for n in range(1, round(duration / time_step) + 1):
            train.force[0, 0] = 120.0 + 30.0 * np.sin(np.pi * n * time_step / duration) ** 4
            assert advance()
            force.append(train.contact[0, 0])
        assert min(force) > 0
        forces.append(np.array(force[2**halvings - 1 :: 2**halvings]))
    changes = np.array([np.sqrt(np.mean((fine - coarse) ** 2)) for coarse, fine in pairwise(forces)])
    np.testing.assert_allclose(np.log2(changes[:-1] / changes[1:]), 2.0, atol=0.1)
