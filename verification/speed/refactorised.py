"""Independent time integration: sparse matrices of scipy, factored for every set of slack droppers."""

import time
from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from pantocheck.model import DiscretisedLine, Passage
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.dynamics.motion import end_of_step
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.statics.assembly import (
    assemble_matrices,
    bandwidth_order,
    connector_directions,
    contact_stiffness,
    correct_mass,
    point_load,
)


def run_refactorised(line: DiscretisedLine, passage: Passage) -> tuple[np.ndarray, float]:
    """Integrate with average acceleration and Newton's method on the set of taut droppers and closed contacts.

    Returns:
        Contact force, (T, P) [N], process time of the steps [s].
    """
    kernel = build_kernel_arrays(line, passage.time_step)
    motion, train = start_motion(line, kernel, passage)
    w, r = end_of_step(motion, kernel.layout, passage.time_step)
    matrices, connectors, dt = assemble_matrices(line), line.connectors, passage.time_step
    n, sizes = matrices.free.size, [p.head.size for p in passage.pantographs]
    at = n + np.concatenate([[0], np.cumsum(sizes)])
    own = [slice(int(a), int(b)) for a, b in pairwise(at)]
    bars = sp.csc_array(
        sp.vstack([connector_directions(line)[matrices.free], sp.csc_array((at[-1] - n, len(connectors.station)))])
    )
    bare_k = matrices.stiffness - (bars[:n] @ sp.diags_array(connectors.stiffness) @ bars[:n].T)
    bare_c = matrices.damping - (bars[:n] @ sp.diags_array(connectors.damping) @ bars[:n].T)
    mass = sp.block_diag([correct_mass(line, dt), *(p.mass for p in passage.pantographs)], format="csc")
    damping = sp.block_diag([bare_c, *(p.damping for p in passage.pantographs)], format="csc")
    stiffness = sp.block_diag([bare_k, *(p.stiffness for p in passage.pantographs)], format="csc")
    place = bandwidth_order(line)[matrices.free]
    q, v, a = (np.concatenate([np.stack([w[i], r[i]], axis=-1).ravel()[place], *train.z[i]]) for i in range(3))
    force = np.concatenate([np.zeros(n), *(p.force for p in passage.pantographs)])
    stiff = np.zeros(len(sizes))
    tension, contact = motion.force[: connectors.station.size].copy(), train.contact[:, 0].copy()
    rest = line.state.deflection.ravel()[bandwidth_order(line)]
    row = line.contact_rows[0]
    steps = round(passage.duration / dt)
    record = np.zeros((steps, len(sizes)))
    begin = time.process_time()
    for step in range(steps):
        closing, height = np.zeros((at[-1], len(sizes))), np.zeros(len(sizes))
        for p, model in enumerate(passage.pantographs):
            here = passage.start[p] + passage.speed * dt * (step + 1)
            share, stiff[p] = point_load(line, row, here), contact_stiffness(line, row, here, model.contact_stiffness)
            closing[:n, p], closing[own[p], p] = -share[matrices.free], model.head
            height[p] = share @ rest
        heads = sp.csc_array(closing)
        predicted_q, predicted_v = q + dt * v + dt**2 / 4 * a, v + dt / 2 * a
        taut, touching = ~connectors.unilateral | (tension > 0), contact > 0
        while True:
            k, c, kc = connectors.stiffness * taut, connectors.damping * taut, stiff * touching
            whole_k = stiffness + bars @ sp.diags_array(k) @ bars.T + heads @ sp.diags_array(kc) @ heads.T
            whole_c = damping + bars @ sp.diags_array(c) @ bars.T
            load = force + bars @ (connectors.preload * ~taut) + heads @ (kc * height)
            effective = sp.csc_array(mass + dt / 2 * whole_c + dt**2 / 4 * whole_k)
            a = splu(effective).solve(load - whole_k @ predicted_q - whole_c @ predicted_v)
            q, v = predicted_q + dt**2 / 4 * a, predicted_v + dt / 2 * a
            tension = connectors.preload + connectors.stiffness * (bars.T @ q) + connectors.damping * (bars.T @ v)
            contact = stiff * (heads.T @ q - height)
            now = ~connectors.unilateral | (tension > 0), contact > 0
            if np.array_equal(now[0], taut) and np.array_equal(now[1], touching):
                break
            taut, touching = now
        record[step] = contact * touching
    return record, time.process_time() - begin
