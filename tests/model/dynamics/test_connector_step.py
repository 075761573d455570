"""Connectors in a time step: tensions of the sweeps satisfy the law of the droppers and the balance of the rows."""

import numpy as np

from helpers.lines import DAMPED, simple_line
from pantocheck.model.discretised_line import DiscretisedLine, discretise
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.block_tridiagonal import solve_wires
from pantocheck.model.dynamics.connector_step import connector_ends, predict_connectors, sweep_connectors
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, build_kernel_arrays
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.dynamics.sweeps import FORCE_TOLERANCE

TIME_STEP = 1e-3


def swept_state() -> tuple[DiscretisedLine, KernelArrays, Motion, int]:
    """Two spans, the contact wire lifted by 5 mm between x = 20 m and x = 40 m, after sweeps over the connectors."""
    line = discretise(simple_line(damping=DAMPED), 1.0)
    kernel = build_kernel_arrays(line, TIME_STEP)
    rows, stations = line.beams.free.shape[:2]
    w, r = np.zeros((3, rows, stations)), np.zeros((3, rows, stations))
    lifted = (line.mesh.position > 20.0) & (line.mesh.position < 40.0)
    w[0, line.contact_rows[0], lifted] = 5e-3
    motion = Motion(w, r, line.connectors.preload.copy(), np.zeros(0), np.zeros(1), np.zeros(0))
    window, predicted = Window(0, stations - 1), np.zeros(line.connectors.station.size)
    predict_connectors(kernel.connectors, motion, predicted, window)
    solve_wires(kernel.factor, kernel.wires.extents, Window(0, stations - 1), w[2], r[2])
    sweeps = 1
    while sweep_connectors(kernel.connectors, motion, predicted, window) > FORCE_TOLERANCE:
        sweeps += 1
    return line, kernel, motion, sweeps


def test_sweeps_settle_within_a_few() -> None:
    """Droppers 6 m apart hardly influence each other within a step of 1 ms."""
    assert swept_state()[3] <= 4


def test_tensions_follow_the_law_of_unilateral_droppers() -> None:
    """N = max(0, N0 + k d + c d') with the elongation at the end of the step, to the tolerance of the sweeps."""
    line, _, motion, _ = swept_state()
    connectors = line.connectors
    acceleration = np.einsum("nb,nb->n", connectors.coefficient, motion.w[2].T[connectors.station])
    displacement = np.einsum("nb,nb->n", connectors.coefficient, motion.w[0].T[connectors.station])
    elongation, rate = displacement + TIME_STEP**2 / 4 * acceleration, TIME_STEP / 2 * acceleration
    law = np.maximum(0.0, connectors.preload + connectors.stiffness * elongation + connectors.damping * rate)
    np.testing.assert_allclose(motion.tension, law, rtol=0, atol=1e-7)
    assert (motion.tension == 0.0).any()
    assert (motion.tension > 0.0).any()


def test_accelerations_balance_the_tensions() -> None:
    """The local columns give the same accelerations as a solution with all tensions as loads; cut columns: 1e-12."""
    line, kernel, motion, _ = swept_state()
    w, r = np.zeros_like(motion.w[2]), np.zeros_like(motion.r[2])
    for n, station in enumerate(line.connectors.station):
        w[:, station] -= line.connectors.coefficient[n] * (motion.tension[n] - line.connectors.preload[n])
    solve_wires(kernel.factor, kernel.wires.extents, Window(0, w.shape[1] - 1), w, r)
    np.testing.assert_allclose(motion.w[2], w, rtol=0, atol=1e-9 * np.abs(w).max())


def test_ends_are_listed_connector_by_connector() -> None:
    """A dropper of a vertical line has two ends at one station."""
    line = discretise(simple_line(), 1.0)
    ends = connector_ends(line.connectors)
    assert [station for _, station in ends[:4]] == np.repeat(line.connectors.station[:2], 2).tolist()
    assert {row for row, _ in ends} == {0, 1}
