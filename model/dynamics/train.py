"""Pantographs of a train as plain arrays, with their state.

Strips are numbered through the train: those of the first pantograph from front to rear, then those of the second.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.contact_law import penetration
from pantocheck.model.description.pantograph import equilibrium
from pantocheck.model.dynamics.passage import Passage


class Train(NamedTuple):
    """Pantographs and their state; P pantographs of at most n unknowns, C strips, J joints, W contact wires."""

    position: Array
    """Position along the track, (P,) [m]."""
    speed: Array
    """Speed of the train, (1,) [m/s]."""
    elapsed: Array
    """Time since the start, (1,) [s]."""
    ramp: Array
    """Time over which the heads are released, (1,) [s]."""
    held: Array
    """Force that holds each strip down at the start of the ramp, (C,) [N]."""
    inverse: Array
    """Inverse of the effective matrix M + dt/2 C + dt^2/4 K of each pantograph, (P, n, n) [1/kg]."""
    damping: Array
    stiffness: Array
    """Matrices of each pantograph, (P, n, n) [N s/m, N/m]."""
    force: Array
    """Constant forces, (P, n) [N]."""
    first_strip: Indices
    """First strip of each pantograph, and C, (P + 1,)."""
    owner: Indices
    """Pantograph of each strip, (C,)."""
    offset: Array
    """Distance of each strip ahead of the position of its pantograph, (C,) [m]."""
    head: Array
    """Displacement of each strip per unknown, below the track axis, (C, n) [-]."""
    lateral: Array
    """Additions to it by the powers of the lateral position of the wire, from 1 on, (C, D, n) [1/m, ...]."""
    contact_stiffness: Array
    """Stiffness of the penalty contact, infinite for a rigid contact, (C,) [N/m]."""
    contact_damping: Array
    """Damping beside this stiffness, (C,) [N s/m]."""
    hertz: Array
    """Penetration per F^(2/3) by Hertz's law, zero without this law, (C,) [m/N^(2/3)]."""
    joint_owner: Indices
    """Pantograph of each joint, (J,)."""
    joint: Array
    """Closing of each joint per unknown, (J, n) [-]."""
    joint_law: Array
    """Stiffness, damping, gap, lower and upper bound of each joint, (J, 5) [N/m, N s/m, m, N, N]."""
    joint_gain: Array
    """Force of each joint per acceleration of its closing within a step, (J,) [kg]."""
    joint_compliance: Array
    """Change of this force per force, (J,) [-]."""
    joint_force: Array
    """Forces of the joints, (J,) [N]."""
    z: Array
    """Displacement, velocity, acceleration, (3, P, n) [m, m/s, m/s2]."""
    contact: Array
    """Contact forces, (C, W) [N]."""


def build_empty_train(contact_wires: int) -> Train:
    """Build a train without a pantograph, for the free motion of a line."""
    return _allocate((0, 1, 0, 0, 0), contact_wires)


def build_train(passage: Passage, touched: NDArray[np.bool_], wire_height: Array, flexibility: Array) -> Train:
    """Build the pantographs at rest, each pressing with its static force, or held down if the passage has a ramp.

    The touched contact wires share the force of a strip equally.

    Args:
        passage: Pantographs, positions, speed, time step and ramp.
        touched: Whether each strip touches each contact wire at the start, (C, W).
        wire_height: Height of each touched contact wire at the position of each strip in the state at the start,
            (C, W) [m].
        flexibility: Residual flexibility of each touched contact wire there, (C, W) [m/N].

    Returns:
        Pantographs and their state.
    """
    unknowns = max(p.head.size for p in passage.pantographs)
    joints = [(p, joint) for p, pantograph in enumerate(passage.pantographs) for joint in pantograph.joints]
    powers = max(len(strip.shape) for p in passage.pantographs for strip in p.strips) - 1
    sizes = (len(passage.pantographs), unknowns, len(wire_height), powers, len(joints))
    train = _allocate(sizes, wire_height.shape[1])
    train.position[:], train.speed[0], train.ramp[0] = passage.start, passage.speed, passage.ramp
    train.first_strip[1:] = np.cumsum([len(p.strips) for p in passage.pantographs])
    half, quarter = passage.time_step / 2, passage.time_step**2 / 4
    for p, pantograph in enumerate(passage.pantographs):
        n, strips = pantograph.head.size, slice(*train.first_strip[p : p + 2])
        effective = pantograph.mass + half * pantograph.damping + quarter * pantograph.stiffness
        train.inverse[p, :n, :n] = np.linalg.inv(effective)
        train.damping[p, :n, :n], train.stiffness[p, :n, :n] = pantograph.damping, pantograph.stiffness
        train.force[p, :n] = pantograph.force
        train.owner[strips], train.head[strips, :n] = p, pantograph.strip_shapes
        train.offset[strips] = [strip.offset for strip in pantograph.strips]
        for c, strip in zip(range(strips.start, strips.stop), pantograph.strips, strict=True):
            train.lateral[c, : len(strip.shape) - 1, :n] = strip.shape[1:]
        train.contact_stiffness[strips] = pantograph.contact_stiffness
        train.contact_damping[strips] = pantograph.contact_damping
        train.hertz[strips] = pantograph.hertz_coefficient ** (-2 / 3)
        height = np.zeros(len(pantograph.strips))
        for k, (c, part) in enumerate(zip(range(strips.start, strips.stop), pantograph.strip_shares, strict=True)):
            share = part * pantograph.static_force / touched[c].sum() if passage.ramp == 0 else 0.0
            train.contact[c, touched[c]] = share
            overlap = share * (1 / pantograph.contact_stiffness + float(flexibility[c, touched[c]].mean()))
            overlap += penetration(math.inf, pantograph.hertz_coefficient, share)
            height[k] = float(wire_height[c, touched[c]].mean()) + overlap
        train.z[0, p, :n], forces_down = equilibrium(pantograph, height)
        train.held[strips] = forces_down if passage.ramp > 0 else 0.0
    for j, (p, joint) in enumerate(joints):
        train.joint_owner[j], train.joint[j, : joint.direction.size] = p, joint.direction
        train.joint_law[j] = joint.stiffness, joint.damping, joint.gap, joint.lower, joint.upper
        train.joint_gain[j] = quarter * joint.stiffness + half * joint.damping
        train.joint_compliance[j] = train.joint_gain[j] * (train.joint[j] @ train.inverse[p] @ train.joint[j])
    return train


def _allocate(sizes: tuple[int, int, int, int, int], contact_wires: int) -> Train:
    """Train with zeros in all arrays; sizes: pantographs, unknowns, strips, powers of the lateral position, joints."""
    pantographs, unknowns, strips, powers, joints = sizes
    return Train(
        position=np.zeros(pantographs),
        speed=np.zeros(1),
        elapsed=np.zeros(1),
        ramp=np.zeros(1),
        held=np.zeros(strips),
        inverse=np.zeros((pantographs, unknowns, unknowns)),
        damping=np.zeros((pantographs, unknowns, unknowns)),
        stiffness=np.zeros((pantographs, unknowns, unknowns)),
        force=np.zeros((pantographs, unknowns)),
        first_strip=np.zeros(pantographs + 1, dtype=np.int64),
        owner=np.zeros(strips, dtype=np.int64),
        offset=np.zeros(strips),
        head=np.zeros((strips, unknowns)),
        lateral=np.zeros((strips, powers, unknowns)),
        contact_stiffness=np.zeros(strips),
        contact_damping=np.zeros(strips),
        hertz=np.zeros(strips),
        joint_owner=np.zeros(joints, dtype=np.int64),
        joint=np.zeros((joints, unknowns)),
        joint_law=np.zeros((joints, 5)),
        joint_gain=np.zeros(joints),
        joint_compliance=np.zeros(joints),
        joint_force=np.zeros(joints),
        z=np.zeros((3, pantographs, unknowns)),
        contact=np.zeros((strips, contact_wires)),
    )
