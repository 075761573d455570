"""Topic: contact laws of head and wire against closed forms, and the energy of a passage with loss of contact."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.model import DiscretisedLine, Pantograph, Passage, SimulationError, build_chain, discretise
from pantocheck.model.description.head_structure import (
    MountedStrip,
    Rotation,
    add_bending_mode,
    add_friction,
    add_stop,
    mount_strips,
)
from pantocheck.model.discretisation.discretised_line import make_droppers_bilateral
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.motion import end_of_step
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.fem.beam import wave_speed
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order, correct_mass, point_load
from verification.guide.comparisons import build_study, compare_absolute, relative_rms
from verification.guide.guide_format import Topic
from verification.guide.topics.bare_wires import WIRE_MASS, WIRE_TENSION, build_short_line, build_wire
from verification.guide.topics.long_string_passage import (
    CONSTRAINED,
    DISCRETISATIONS,
    SHARES,
    average_force,
    simulate_heads,
    solve_delay_equations,
)

LAWS = {
    "spring": {"contact_stiffness": 50e3},
    "constraint": {},
    "hertz": {"hertz_coefficient": 1.2e9},
}
"""Parameters of each law; the coefficient is that of copper on carbon (12 GN/m2, 6 mm)."""

_STRIPS = (MountedStrip(0.3, 2.0, 8000.0, 10.0), MountedStrip(-0.25, 2.0, 8000.0, 10.0))
_SUSPENSION = np.array([-1.0, 1.0])

HEADS: dict[str, Callable[[Pantograph], Pantograph]] = {
    "one strip": lambda chain: chain,
    "two strips": lambda chain: mount_strips(chain, _STRIPS, Rotation(0.2, 40.0, 1.0)),
    "bending mode": lambda chain: add_bending_mode(chain, 30.0, 0.02, [(0.3,)]),
    "friction": lambda chain: add_friction(chain, _SUSPENSION, 15.0, 1e-3),
    "stops": lambda chain: add_stop(add_stop(chain, _SUSPENSION, 0.0, 2e5, 50.0), -_SUSPENSION, 0.06, 2e5, 0.0),
}
"""Structures of the head of a pantograph of two masses."""

_MASS, _SPEED = 7.5, 0.5
"""Mass [kg] that hits a string, and its speed [m/s]."""

_SETTLED_S = 0.01
"""Time after an impact from which the force is compared [s]: a step has no jump."""


def study_contact_laws() -> Topic:
    """Impact, constrained heads on a moving string, and energy."""
    impacts = {size: impact_error(*size) for size in DISCRETISATIONS}
    speed = SHARES[1] * wave_speed(WIRE_TENSION, WIRE_MASS)
    heads = [(element, _constrained_error(speed, element, dt)) for element, dt in DISCRETISATIONS]
    ledgers = {law: measure_ledger(law) for law in LAWS}
    ledgers |= {head: measure_ledger("spring", head=head) for head in list(HEADS)[1:]}
    return Topic(
        title="Contact laws",
        theory="A mass m that hits a long string at the speed u feels F = Zu exp(-Zt/m), Z = 2 sqrt(T m_l), with the "
        "mass per length m_l. Two heads that constraints hold on a moving string are equations with delays: F = Zu "
        "minus the force that arrives from the other head. The energy of line and head changes by the work of uplift "
        "force and train, less that of the dampers and that which the contact takes.",
        setting="Strings of 400 m without bending; a line of four spans of 44 m under a pantograph with 250 N at 270 "
        "km/h, which loses contact.",
        comparisons=[
            compare_absolute(
                "impact-impulse",
                "impulse of an impact within 50 ms, relative",
                "-",
                (impacts[DISCRETISATIONS[1]][0], 0.0),
                2e-3,
                "Elements of 0.5 m, 1 ms; the instant of the impact is known to one time step.",
            ),
            compare_absolute(
                "constraint-heads",
                f"RMS error of the force of a constrained head at {SHARES[1]:g} of the wave speed, mean over 10 ms",
                "-",
                (heads[1][1], 0.0),
                0.02,
                "A string without bending has a kink in elements of 0.5 m; measured error and a third.",
            ),
            *(
                compare_absolute(
                    f"energy-{law.replace(' ', '-')}",
                    f"energy balance with {law}, over the energy put in",
                    "-",
                    (ledger.error, 0.0),
                    1e-6,
                    "Average acceleration keeps the balance exactly, also where contact is lost within a step.",
                )
                for law, ledger in ledgers.items()
            ),
        ],
        convergence=[
            build_study(
                "impact",
                "impulse of an impact within 50 ms",
                "element length [m]",
                [(element, abs(impacts[element, dt][0])) for element, dt in DISCRETISATIONS],
                (1.0, 0.5),
                "The instant of the impact is known to one time step: order 1.",
            ),
            build_study(
                "constraint",
                "force of a constrained head, mean over 10 ms (RMS)",
                "element length [m]",
                heads,
                (1.0, 0.15),
                "A cubic element cannot represent a kink that moves through it: order 1.",
            ),
        ],
    )


def _constrained_error(speed: float, element: float, dt: float) -> float:
    times, force = simulate_heads(speed, element, dt, CONSTRAINED)
    exact = solve_delay_equations(speed, times, CONSTRAINED)
    return relative_rms(average_force(times, force[0]), average_force(times, exact[0]))


def impact_error(element: float, dt: float) -> tuple[float, float]:
    """Errors of an impact on a string by a constraint: impulse within 50 ms, and RMS of the force, relative."""
    string = discretise(build_wire(400.0, bending_stiffness=0.0), element)
    line = replace(string, state=replace(string.state, deflection=np.zeros_like(string.state.deflection)))
    one = np.ones((1, 1))
    mass = Pantograph(_MASS * one, 0 * one, 0 * one, np.ones(1), np.zeros(1), 0.0, np.inf)
    kernel = build_kernel_arrays(line, dt)
    motion, train = start_motion(line, kernel, Passage((mass,), (200.3,), 0.0, 0.1, dt))
    work = build_workspace(kernel, train)
    train.z[1], gap = _SPEED, 2.37e-3
    train.z[0] -= gap
    time, force = dt * np.arange(1, round(0.06 / dt) + 1), []
    advance = bind_arrays(step, kernel, motion, train, work)
    for _ in time:
        if not advance():
            raise SimulationError("the forces of a time step did not converge")
        force.append(float(train.contact[0, 0]))
    impedance, since = 2 * np.sqrt(WIRE_TENSION * WIRE_MASS), time - gap / _SPEED
    exact = np.where(since > 0, impedance * _SPEED * np.exp(-impedance * np.maximum(since, 0.0) / _MASS), 0.0)
    inside = since < 0.05
    impulse = _MASS * _SPEED * (1 - np.exp(-impedance * since[inside][-1] / _MASS))
    computed, later = np.array(force), since > _SETTLED_S
    brought = dt * (computed[inside].sum() - computed[inside][-1] / 2)
    return float(brought / impulse - 1), relative_rms(computed[later], exact[later])


@dataclass(frozen=True)
class Ledger:
    """Energy of a passage."""

    put_in: float
    """Work of uplift force and train, sizes added [J]."""
    error: float
    """Largest error of the balance over this work [-]."""
    lost_in_contact: float
    """Energy that the contact takes and does not store, over this work [-]."""
    taken_by_joints: float
    """Energy that friction and stops take, over this work [-]."""
    losses: int
    """Number of losses of contact by a strip."""
    bounds: int
    """Number of steps in which a joint is at a bound of its force, and number of steps in which it is not."""
    inside: int


def measure_ledger(
    law: str, element: float = 0.5, dt: float = 1e-3, damping: float = 0.0, head: str = "one strip"
) -> Ledger:
    """Energy of a passage that loses contact.

    Args:
        law: Law of `LAWS`.
        element, dt: Element length [m] and time step [s].
        damping: Damper beside the law [N s/m].
        head: Structure of `HEADS`.
    """
    line = make_droppers_bilateral(discretise(build_short_line(4), element))
    chain = build_chain(np.array([15.0, 7.2]), np.array([50.0, 4200.0]), np.array([90.0, 10.0]), 250.0, 0, np.inf)
    pantograph = HEADS[head](replace(chain, **LAWS[law], contact_damping=damping))
    states = list(_states(line, pantograph, dt))
    put_in, balance, contact, joints, errors = 0.0, 0.0, 0.0, 0.0, [0.0]
    for a, b in pairwise(states):
        uplift, slope = float((b.z - a.z) @ pantograph.force), b.shape - a.shape
        # The wire moves up the head by its slope: the horizontal contact force takes this work from the train.
        train = -float(a.force @ (slope @ b.height) + b.force @ (slope @ a.height)) / 2
        damped = float((b.z - a.z) @ pantograph.damping @ (b.z - a.z)) / dt
        taken = float((a.force + b.force) @ (b.closing - a.closing)) / 2
        rubbed = float((a.joint + b.joint) @ (pantograph_joints(pantograph) @ (b.z - a.z))) / 2
        put_in, contact, joints = put_in + abs(uplift) + abs(train), contact + taken, joints + rubbed
        balance += b.energy - a.energy - uplift - train + damped + taken + rubbed
        errors.append(abs(balance))
    losses = sum(int(((a.force > 0) & (b.force == 0)).sum()) for a, b in pairwise(states))
    lost = contact - states[-1].stored + states[0].stored
    limits = np.array([(joint.lower, joint.upper) for joint in pantograph.joints]).reshape(-1, 2)
    at_bound = np.array([(state.joint[:, None] == limits).any(axis=1) for state in states])
    bounds = int(at_bound.sum())
    return Ledger(put_in, max(errors) / put_in, lost / put_in, joints / put_in, losses, bounds, at_bound.size - bounds)


def pantograph_joints(pantograph: Pantograph) -> RealArray:
    """Closing of each joint per unknown, (joints, n)."""
    return np.array([joint.direction for joint in pantograph.joints]).reshape(-1, pantograph.head.size)


@dataclass(frozen=True)
class _State:
    """End of a time step: wire, its shape functions at the strips, displacements of the pantograph, forces."""

    height: RealArray
    shape: RealArray
    z: RealArray
    force: RealArray
    closing: RealArray
    joint: RealArray
    energy: float
    stored: float


def _states(line: DiscretisedLine, head: Pantograph, dt: float) -> Iterator[_State]:
    """States behind the first step, which has no acceleration at its start."""
    way = Passage((head,), (35.0,), 270 / 3.6, 1.2, dt)
    kernel = build_kernel_arrays(line, dt)
    motion, train = start_motion(line, kernel, way)
    work, matrices, mass = build_workspace(kernel, train), assemble_matrices(line), correct_mass(line, dt)
    place, row = bandwidth_order(line)[matrices.free], line.contact_rows[0]
    rest = line.state.deflection.ravel()[bandwidth_order(line)]
    advance = bind_arrays(step, kernel, motion, train, work)
    for _ in range(round(way.duration / dt)):
        if not advance():
            raise SimulationError("the forces of a time step did not converge")
        w, r = end_of_step(motion, kernel.layout, dt)
        q, v = (np.stack([w[i], r[i]], axis=-1).ravel()[place] for i in range(2))
        z, u, force = train.z[0, 0].copy(), train.z[1, 0], train.contact[:, 0].copy()
        shape = np.array([point_load(line, row, float(x)) for x in train.position[0] + train.offset])
        height = rest.copy()
        height[matrices.free] += q
        stored = (force**2 / work.contact.stiffness[:, 0] / 2).sum()
        stored += (2 / 5 * force * (force / head.hertz_coefficient) ** (2 / 3)).sum()
        energy = float(v @ mass @ v + q @ (matrices.stiffness @ q) + u @ head.mass @ u + z @ head.stiffness @ z) / 2
        closing = head.strip_shapes @ z - shape @ height
        yield _State(height, shape, z, force, closing, train.joint_force.copy(), energy, float(stored))
