"""The time step: Newmark average acceleration, waves kept in time (`dispersion`), unilateral droppers and contact.

The rows of beams are factored once. Connectors, contacts and modal dampers are scalar forces whose effect within the
step is known in closed form, so each is solved exactly in turn, and the turns are repeated until no force changes any
more. Forces far apart do not feel each other within a step, so two or three turns do.
"""

from numba import njit

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.dynamics.active_window import active_stations, hold_outside
from pantocheck.model.dynamics.block_tridiagonal import solve_line
from pantocheck.model.dynamics.connector_step import larger, predict_connectors, sweep_connectors
from pantocheck.model.dynamics.contact_step import correct_train, predict_train, sweep_contacts
from pantocheck.model.dynamics.modal_step import predict_modes, sweep_modes
from pantocheck.model.dynamics.state import KernelArrays, Motion, Train, Workspace
from pantocheck.model.dynamics.wire_step import correct_wires, predict_wires, wire_forces

FORCE_TOLERANCE = 1e-9
"""A step has converged when no force changed by more than this in a turn [N]; forces are of the order of 100 N."""
MAX_SWEEPS = 200
"""After so many turns a step is given up."""


@njit(cache=True)
def step(line: KernelArrays, motion: Motion, train: Train, work: Workspace) -> int:
    """Advance line and pantographs by one time step, in place.

    Parameters
    ----------
    line : KernelArrays
        Line.
    motion : Motion
        Motion.
    train : Train
        Train, with no pantograph at all for a free line.
    work : Workspace
        Workspace.

    Returns
    -------
    int
        Turns taken; zero when the forces did not converge.
    """
    dt = line.time_step
    w, r = motion.w[2], motion.r[2]
    first, last = active_stations(line, train)
    predict_wires(dt, motion, first, last)
    wire_forces(line, motion, work, first, last)
    hold_outside(motion, first, last)
    predict_connectors(line, motion, work, first, last)
    predict_train(line, motion, train, work)
    w[line.load_row, line.load_station] += motion.load[0]
    predict_modes(line, motion, work)
    solve_line(line.factor, first, last, w, r)
    turns = 0
    while turns < MAX_SWEEPS:
        turns += 1
        largest = sweep_contacts(line, train, work, w, r, first, last)
        largest = larger(largest, sweep_connectors(line, motion, work, w, r, first, last))
        largest = larger(largest, sweep_modes(line, motion, work, w, r))
        if largest < FORCE_TOLERANCE:
            break
    correct_wires(dt, motion, first, last)
    correct_train(dt, train)
    # A comparison that is also false for NaN.
    return turns if largest < FORCE_TOLERANCE else 0


@njit(cache=True)
def march(
    line: KernelArrays,
    motion: Motion,
    train: Train,
    work: Workspace,
    load: Array,
    watch_row: Indices,
    watch_station: Indices,
    contact: Array,
    height: Array,
    watched: Array,
    tension: Array,
) -> int:
    """Advance by as many steps as the outputs have room for.

    Parameters
    ----------
    line, motion, train, work : KernelArrays or Motion or Train or Workspace
        As for `step`.
    load : (T,) ndarray
        External load [N].
    watch_row, watch_station : (U,) int ndarray
        Where motion is recorded.
    contact : (T, P) ndarray
        Contact force in total, filled [N].
    height : (T, P) ndarray
        Of the head, filled [m].
    watched : (T, U, 3) ndarray
        Displacement, velocity, acceleration at the watched stations, filled [m, m/s, m/s2].
    tension : (T, N) ndarray
        Of the first connectors, as many as there is room for, filled [N].

    Returns
    -------
    int
        Steps completed.
    """
    for n in range(load.size):
        motion.load[0] = load[n]
        if step(line, motion, train, work) == 0:
            return n
        for p in range(train.position.size):
            total, head = 0.0, 0.0
            for k in range(train.contact.shape[1]):
                total += train.contact[p, k]
            for i in range(train.z.shape[2]):
                head += train.head[p, i] * train.z[0, p, i]
            contact[n, p], height[n, p] = total, head
        for u in range(watch_row.size):
            for i in range(3):
                watched[n, u, i] = motion.w[i, watch_row[u], watch_station[u]]
        for d in range(tension.shape[1]):
            tension[n, d] = motion.tension[d]
    return int(load.size)
