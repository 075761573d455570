"""Topic: balance of energy and momentum of a passage with two pantographs."""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.model import DiscretisedLine, Passage, SimulationError, build_chain, discretise, make_droppers_bilateral
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.motion import end_of_step
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.dynamics.train import Train
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order, correct_mass, point_load
from pantocheck.model.statics.contact_wires import locate_contact_wires
from verification.guide.comparisons import compare_absolute
from verification.guide.guide_format import Topic
from verification.guide.topics.bare_wires import build_short_line

_HEAD = build_chain(np.array([15.0, 7.2]), np.array([50.0, 4200.0]), np.zeros(2), 120.0, 0, 50e3)
"""Pantograph of EN 50318:2002 without dampers."""


@dataclass(frozen=True)
class PassageBalance:
    """Largest differences of the balances of a passage without damping."""

    energy: float
    """Largest difference between the change of the energy and the work of the forces, over the work on the line [-]."""
    momentum: float
    """Largest difference between the change of the vertical momentum and the impulse of the forces, over the largest
    impulse of the contact forces [-].
    """
    work: float
    """Sum of the work on the line in both directions [J]."""
    touched: tuple[bool, ...]
    """Whether a head touched each contact wire."""


def study_balances() -> Topic:
    """Energy and momentum of a line and two pantographs."""
    line = make_droppers_bilateral(discretise(build_short_line(4), 1.0))
    balance = measure_balances(line, Passage((_HEAD, _HEAD), (60.0, 35.0), 50.0, 1.5, 1e-3))
    reason = "Average acceleration keeps both balances exactly; the rounding of 1500 steps remains."
    return Topic(
        title="Energy and momentum of a passage with two pantographs",
        theory="Without damping, the energy of line and pantographs changes by the work of the uplift and contact "
        "forces. Their vertical momentum changes by the impulse of all forces from outside.",
        setting="Line of four spans of 44 m with droppers that stay connected, two pantographs 25 m apart at 180 km/h, "
        "1500 steps of 1 ms.",
        comparisons=[
            compare_absolute(
                "energy",
                "largest difference of energy and work, over the work on the line",
                "-",
                (balance.energy, 0.0),
                1e-12,
                reason,
            ),
            compare_absolute(
                "momentum",
                "largest difference of momentum and impulse, over the impulse of the contact forces",
                "-",
                (balance.momentum, 0.0),
                1e-12,
                reason,
            ),
        ],
    )


def measure_balances(line: DiscretisedLine, passage: Passage) -> PassageBalance:
    """Balances of a passage on a line without damping and with bilateral droppers, step by step.

    Args:
        line: Line without lateral field and without damping.
        passage: Pantographs without dampers.
    """
    kernel = build_kernel_arrays(line, passage.time_step)
    motion, train = start_motion(line, kernel, passage)
    work = build_workspace(kernel, train)
    matrices, mass = assemble_matrices(line), correct_mass(line, passage.time_step)
    place = bandwidth_order(line)[matrices.free]
    upwards = (bandwidth_order(line) % 2 == 0)[matrices.free].astype(np.float64)

    def state() -> "_State":
        """Motion, forces and energies at the end of the last time step."""
        w, r = end_of_step(motion, kernel.layout, passage.time_step)
        q, v = (np.stack([w[i], r[i]], axis=-1).ravel()[place] for i in range(2))
        z, u = train.z[0], train.z[1]
        elastic, contact = matrices.stiffness @ q, _nodal_forces(line, train)[matrices.free]
        press = np.array(
            [p.force - p.head * f for p, f in zip(passage.pantographs, train.contact.sum(axis=1), strict=True)]
        )
        springs = np.array([p.stiffness @ z[k] for k, p in enumerate(passage.pantographs)])
        heads = [(u[k] @ p.mass @ u[k] + z[k] @ springs[k]) / 2 for k, p in enumerate(passage.pantographs)]
        momenta = [(p.mass @ u[k]).sum() for k, p in enumerate(passage.pantographs)]
        return _State(
            q,
            contact,
            z.copy(),
            press,
            float(v @ mass @ v / 2 + q @ elastic / 2 + sum(heads)),
            float(upwards @ (mass @ v) + sum(momenta)),
            float(upwards @ (contact - elastic) + (press - springs).sum()),
            float(train.contact.sum()),
        )

    take_step = bind_arrays(step, kernel, motion, train, work)

    def advance() -> "_State":
        if not take_step():
            raise SimulationError("the forces of a time step did not converge")
        return state()

    # The start counts the force of the base springs from the first step on, so that the balance begins behind it.
    before, worked, impulse, pressed = advance(), 0.0, 0.0, 0.0
    start, largest, brought = before, np.zeros(2), 0.0
    touched = np.zeros(train.contact.shape[1], dtype=np.bool_)
    for _ in range(round(passage.duration / passage.time_step) - 1):
        now = advance()
        on_line = float((now.q - before.q) @ (before.contact + now.contact) / 2)
        worked += on_line + float(((now.z - before.z) * (before.press + now.press)).sum() / 2)
        impulse += passage.time_step * (before.force + now.force) / 2
        pressed += passage.time_step * (before.contact_force + now.contact_force) / 2
        brought += abs(on_line)
        errors = (now.energy - start.energy - worked, now.momentum - start.momentum - impulse)
        largest = np.maximum(largest, np.abs(errors))
        touched |= train.contact.max(axis=0) > 0
        before = now
    return PassageBalance(float(largest[0] / brought), float(largest[1] / pressed), brought, tuple(map(bool, touched)))


@dataclass(frozen=True)
class _State:
    """Displacements and nodal forces of the line, displacements and forces of the heads, energy and momentum."""

    q: RealArray
    contact: RealArray
    z: RealArray
    press: RealArray
    energy: float
    momentum: float
    force: float
    contact_force: float


def _nodal_forces(line: DiscretisedLine, train: Train) -> RealArray:
    """Contact forces of all heads on the unknowns, in global order."""
    row = locate_contact_wires(line).row
    force = np.zeros(line.beams.free.size)
    for p, wire in np.argwhere(train.contact > 0):
        force += train.contact[p, wire] * point_load(line, row[wire], train.position[p])
    return force
