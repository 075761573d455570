"""Time step: Newmark's method with unilateral droppers and contact.

The method is the average acceleration (gamma = 1/2, beta = 1/4) with a corrected mass of the wires (`mass_correction`),
which is Newmark with gamma = 1/2, beta = 1/12 (Fox-Goodwin) on the string part. One step

1. predicts displacement and velocity (`motion`),
2. applies all forces in the predicted state, the scalar forces and contact forces as before,
3. computes the accelerations at connectors and contacts under these forces, by local columns of the inverse of
   A = M + dt/2 C + dt^2/4 K without the scalar forces,
4. sweeps over the scalar forces and contact forces until none of them changes (`sweeps`), and applies the changes,
5. solves for the accelerations of all stations, A a = f (`panels`).

The forces settle before any station is accelerated: the sweeps know the line by compliances between forces only.
"""

import math

from pantocheck.model.dynamics.active_window import Window, active_window
from pantocheck.model.dynamics.connector_step import accelerate_connectors, load_connectors, predict_connectors
from pantocheck.model.dynamics.contact_step import (
    accelerate_contacts,
    correct_train,
    load_contacts,
    predict_train,
    sweep_contacts,
)
from pantocheck.model.dynamics.distributed_step import accelerate_distributed, load_distributed, predict_distributed
from pantocheck.model.dynamics.extents import active_run
from pantocheck.model.dynamics.joint_step import sweep_joints
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, Workspace
from pantocheck.model.dynamics.kernel_compilation import merged_entry_kernel, merged_kernel
from pantocheck.model.dynamics.motion import Motion, hold_passed_stations
from pantocheck.model.dynamics.panels import solve_wires
from pantocheck.model.dynamics.scalar_forces import FORCE_TOLERANCE, MAX_SWEEPS, maximum, sweep_forces
from pantocheck.model.dynamics.train import Train
from pantocheck.model.dynamics.wire_step import add_lumped_forces, predict_wires


@merged_entry_kernel
def step(kernel: KernelArrays, motion: Motion, train: Train, work: Workspace) -> int:
    """Advance line and pantographs by one time step, in place.

    Args:
        kernel: Arrays of the line.
        motion: State of the line.
        train: State of the pantographs; without a pantograph for a free line.
        work: Scratch arrays.

    Returns:
        Number of sweeps; zero when the forces did not converge.
    """
    dt = kernel.time_step
    window = active_window(kernel.window, train, motion.w, motion.active)
    hold_passed_stations(dt, motion, window)
    predict_wires(dt, kernel.wires, motion, window)
    add_lumped_forces(kernel.wires, motion, window)
    predict_connectors(kernel.connectors, kernel.forces, motion, work.scalar, window)
    predict_distributed(kernel.distributed, kernel.forces, motion, work.scalar, window)
    predict_train(kernel.contact, motion, train, work.contact)
    motion.w[2, kernel.load.row, kernel.load.station] += motion.load[0]
    accelerate_connectors(kernel.connectors, motion, work.node, work.scalar, window)
    accelerate_distributed(kernel.distributed, motion, work.scalar, window)
    accelerate_contacts(kernel.contact, kernel.connectors, kernel.distributed, motion, work.contact, window)
    sweeps = settle_forces(kernel, motion, train, work, window)
    load_connectors(kernel.connectors, motion, work.scalar, window)
    load_distributed(kernel.distributed, motion, work.scalar, window)
    load_contacts(kernel.contact, motion, train, work.contact)
    accelerated = solve_wires(kernel.panels, kernel.wires.extents, window, motion.w, motion.r, work.panels)
    correct_train(dt, train)
    return 0 if math.isnan(accelerated) else sweeps


@merged_kernel
def settle_forces(kernel: KernelArrays, motion: Motion, train: Train, work: Workspace, window: Window) -> int:
    """Sweep over contact forces and scalar forces until none of them changes.

    Args:
        kernel: Arrays of the line.
        motion, train: Their forces are replaced.
        work: Predicted forces, and accelerations under the forces of the last step.
        window: Active window.

    Returns:
        Number of sweeps; zero when the forces did not converge.
    """
    connectors, forces = kernel.connectors, kernel.forces
    distributed = motion.force.size - kernel.distributed.number
    for sweeps in range(1, MAX_SWEEPS + 1):
        largest = sweep_contacts(kernel.time_step, train, work.contact, work.scalar)
        largest = maximum(largest, sweep_joints(train, work.contact))
        for k in range(connectors.run.size - 1):
            first, end = active_run(connectors.station, connectors.run, k, window)
            largest = maximum(largest, sweep_forces(forces, work.scalar, motion.force, first, end))
        change = sweep_forces(forces, work.scalar, motion.force, distributed, motion.force.size)
        largest = maximum(largest, change)
        # This comparison is false for NaN, too.
        if largest < FORCE_TOLERANCE:
            return sweeps
    return 0
