"""Independent explicit time integration: central differences with assembled matrices.

It shares only the assembled matrices with the kernel: no Newmark method, no effective matrix, no low-rank correction,
no iteration. Damping forces use the velocity of the last half step.
"""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from helpers.lines import Array
from pantocheck.model import DiscretisedLine, Passage
from pantocheck.model.dynamics.reference_kernel import remove_connectors
from pantocheck.model.statics.assembly import (
    assemble_matrices,
    bandwidth_order,
    connector_directions,
    contact_stiffness,
    point_load,
)
from pantocheck.model.statics.static_solver import StaticSolver


def contact_force(line: DiscretisedLine, passage: Passage) -> Array:
    """Contact force of one pantograph of two masses; the simulation starts at rest like `simulate_passage`.

    Args:
        line: Discretised line in the vertical plane.
        passage: Passage with an explicit time step below 2 / w_max.

    Returns:
        Contact force, (T,) [N].
    """
    (model,) = passage.pantographs
    matrices = assemble_matrices(remove_connectors(line))
    free, dt, connectors = matrices.free, passage.time_step, line.connectors
    row, place = line.contact_rows[0], bandwidth_order(line)[matrices.free]
    rest = line.state.deflection.ravel()[bandwidth_order(line)]
    solve = splu(matrices.mass).solve
    stiffness, damping = sp.csr_array(matrices.stiffness), sp.csr_array(matrices.damping)
    bars = sp.csr_array(connector_directions(line)[free])
    pull = sp.csr_array(bars.T)
    load = model.static_force * point_load(line, row, passage.start[0])
    q = StaticSolver(line).deflection(load).displacement.ravel()[place]
    v = np.zeros(q.size)
    head_height = point_load(line, row, passage.start[0])[free] @ q + point_load(line, row, passage.start[0]) @ rest
    n = model.head.size
    constrained = np.block([[model.stiffness, model.head[:, None]], [model.head[None], np.zeros((1, 1))]])
    z = np.linalg.solve(
        constrained, np.append(model.force, head_height + model.static_force / model.contact_stiffness)
    )[:n]
    zv, inverse = np.zeros(n), np.linalg.inv(model.mass)
    steps = round(passage.duration / dt)
    record = np.zeros(steps)
    for step in range(steps):
        # Forces at the start of the step, the pantograph where it is then.
        position = passage.start[0] + passage.speed * dt * step
        share = point_load(line, row, position)
        tension = connectors.stiffness * (pull @ q) + connectors.damping * (pull @ v)
        change = np.where(connectors.unilateral, np.maximum(tension, -connectors.preload), tension)
        closing = model.head @ z - share[free] @ q - share @ rest
        force = max(0.0, contact_stiffness(line, row, position, model.contact_stiffness) * closing)
        record[step] = force
        v = v + dt * solve(share[free] * force - stiffness @ q - damping @ v - bars @ change)
        q = q + dt * v
        push = model.force - model.head * force - model.damping @ zv - model.stiffness @ z
        zv = zv + dt * inverse @ push
        z = z + dt * zv
    return record
