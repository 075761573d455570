"""Time step: Newmark's method with unilateral droppers and contact.

The method is the average acceleration (gamma = 1/2, beta = 1/4) with a corrected mass of the wires (`mass_correction`),
which is Newmark with gamma = 1/2, beta = 1/12 (Fox-Goodwin) on the string part. One step

1. predicts displacement and velocity,   q* = q + dt v + dt^2/4 a,   v* = v + dt/2 a
2. applies all forces in the predicted state, the scalar forces (`sweeps`) as before,
3. solves for the accelerations, A a = f, with the factors of A = M + dt/2 C + dt^2/4 K without the scalar forces,
4. sweeps over the scalar forces until none of them changes (`sweeps`),
5. corrects displacement and velocity,   q = q* + dt^2/4 a,   v = v* + dt/2 a
"""

from numba import njit

from pantocheck.model.dynamics.active_window import active_window, pin_neighbours
from pantocheck.model.dynamics.block_tridiagonal import solve_wires
from pantocheck.model.dynamics.connector_step import predict_connectors, sweep_connectors
from pantocheck.model.dynamics.contact_step import correct_train, predict_train, sweep_contacts
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, Workspace
from pantocheck.model.dynamics.modal_step import predict_modes, sweep_modes
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.dynamics.stretch_step import predict_stretches, sweep_stretches
from pantocheck.model.dynamics.sweeps import FORCE_TOLERANCE, MAX_SWEEPS, maximum
from pantocheck.model.dynamics.train import Train
from pantocheck.model.dynamics.wire_step import apply_wire_forces, correct_wires, predict_wires


@njit(cache=True)
def step(kernel: KernelArrays, motion: Motion, train: Train, work: Workspace) -> int:
    """Advance line and pantographs by one time step, in place.

    Parameters
    ----------
    kernel : KernelArrays
        Arrays of the line.
    motion : Motion
        State of the line.
    train : Train
        State of the pantographs; without a pantograph for a free line.
    work : Workspace
        Scratch arrays.

    Returns
    -------
    int
        Number of sweeps; zero when the forces did not converge.
    """
    dt = kernel.time_step
    window = active_window(kernel.window, train)
    predict_wires(dt, kernel.wires.extents, motion, window)
    apply_wire_forces(kernel.wires, motion, work.wires, window)
    pin_neighbours(motion, window)
    predict_connectors(kernel.connectors, motion, work.tension, window)
    predict_train(kernel.contact, motion, train, work.contact)
    motion.w[2, kernel.load.row, kernel.load.station] += motion.load[0]
    predict_stretches(kernel.stretches, motion, work.elongation)
    predict_modes(kernel.modal, motion, work.modal_velocity)
    solve_wires(kernel.factor, kernel.wires.extents, window, motion.w[2], motion.r[2])
    sweeps = 0
    while sweeps < MAX_SWEEPS:
        sweeps += 1
        largest = sweep_contacts(kernel.contact, motion, train, work.contact, window)
        largest = maximum(largest, sweep_connectors(kernel.connectors, motion, work.tension, window))
        largest = maximum(largest, sweep_stretches(kernel.stretches, motion, work.elongation))
        largest = maximum(largest, sweep_modes(kernel.modal, motion, work.modal_velocity))
        if largest < FORCE_TOLERANCE:
            break
    correct_wires(dt, kernel.wires.extents, motion, window)
    correct_train(dt, train)
    # This comparison is false for NaN, too.
    return sweeps if largest < FORCE_TOLERANCE else 0
