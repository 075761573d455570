"""Energy of a passage through an overlap: the contact forces bring to the line and to the heads exactly what they keep.

Average acceleration satisfies, in every step of a linear system with nodal forces f,

    E1 - E0 = (q1 - q0) (f0 + f1) / 2,    E = v'Mv / 2 + q'Kq / 2

so that the balance of a line with bilateral droppers holds to rounding, whichever contact wires the heads touch.
"""

import numpy as np
import pytest

from helpers.lines import Array, overlapping_line, simple_line
from pantocheck.model import Passage, chain, discretise, make_droppers_bilateral
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.motion import end_of_step
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.dynamics.train import Train
from pantocheck.model.fem.assembly import assemble_matrices, bandwidth_order, point_load, stepping_mass
from pantocheck.model.fem.contact_wires import locate_contact_wires

HEAD = chain(np.array([15.0, 7.2]), np.array([50.0, 4200.0]), np.zeros(2), 120.0, 0, 50e3)
"""Pantograph of EN 50318:2002 without dampers."""


def nodal_forces(line: DiscretisedLine, train: Train) -> Array:
    """Contact forces of all heads on the unknowns, in global order."""
    row = locate_contact_wires(line).row
    force = np.zeros(line.beams.free.size)
    for p, wire in np.argwhere(train.contact > 0):
        force += train.contact[p, wire] * point_load(line, row[wire], train.position[p])
    return force


@pytest.mark.parametrize("pantographs", [1, 2])
def test_energy_of_line_and_heads_is_the_work_of_the_forces_over_the_change_of_wires(pantographs: int) -> None:
    """Two sections of three spans of 44 m, overlap of one span, without damping: to 1e-7 of the work on the line.

    The sweeps leave 1e-9 N at each of 40 connectors, which move by millimetres in each of 1200 steps: 1e-8 of it.
    """
    section = simple_line(3, 44.0, (4.0, 14.0, 24.0, 32.0, 40.0))
    line = make_droppers_bilateral(discretise(overlapping_line(2, 3, section=section), 1.0))
    passage = Passage((HEAD,) * pantographs, (90.0, 60.0)[:pantographs], 50.0, 1.2, 1e-3)
    kernel = build_kernel_arrays(line, passage.time_step)
    motion, train = start_motion(line, kernel, passage)
    work = build_workspace(kernel, train)
    matrices, mass = assemble_matrices(line), stepping_mass(line, passage.time_step)
    place = bandwidth_order(line)[matrices.free]

    def state() -> tuple[Array, Array, Array, float]:
        """Displacements and nodal forces of the line, displacements of the heads, and the energy of line and heads."""
        w, r = end_of_step(motion, kernel.layout, passage.time_step)
        q, v = (np.stack([w[i], r[i]], axis=-1).ravel()[place] for i in range(2))
        energy = v @ mass @ v / 2 + q @ matrices.stiffness @ q / 2
        z, u = train.z[0], train.z[1]
        energy += sum(u[p] @ HEAD.mass @ u[p] + z[p] @ HEAD.stiffness @ z[p] for p in range(pantographs)) / 2
        return q, nodal_forces(line, train)[matrices.free], z.copy(), energy

    q, force, z, energy = state()
    press = HEAD.force - HEAD.head * train.contact.sum(axis=1)[:, None]
    start, done, largest, brought, touched = energy, 0.0, 0.0, 0.0, np.zeros(2, dtype=np.bool_)
    for _ in range(1200):
        assert step(kernel, motion, train, work)
        q1, force1, z1, energy = state()
        press1 = HEAD.force - HEAD.head * train.contact.sum(axis=1)[:, None]
        to_line, to_heads = (q1 - q) @ (force + force1) / 2, ((z1 - z) * (press + press1)).sum() / 2
        done, brought = done + to_line + to_heads, brought + abs(to_line)
        largest = max(largest, abs(energy - start - done))
        q, force, z, press = q1, force1, z1, press1
        touched |= train.contact.max(axis=0) > 0
    assert touched.all()
    assert brought > 10.0
    assert largest < 1e-7 * brought
