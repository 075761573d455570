"""Pantographs of a train as plain arrays, with their state."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.contact_law import penetration
from pantocheck.model.description.pantograph import equilibrium
from pantocheck.model.dynamics.passage import Passage


class Train(NamedTuple):
    """Pantographs and their state; P pantographs of at most n unknowns, W contact wires of the line."""

    position: Array
    """Position along the track, (P,) [m]."""
    speed: Array
    """Speed of the train, (1,) [m/s]."""
    elapsed: Array
    """Time since the start, (1,) [s]."""
    ramp: Array
    """Time over which the heads are released, (1,) [s]."""
    held: Array
    """Force that holds each head down at the start of the ramp, (P,) [N]."""
    inverse: Array
    """Inverse of the effective matrix M + dt/2 C + dt^2/4 K of each pantograph, (P, n, n) [1/kg]."""
    damping: Array
    stiffness: Array
    """Matrices of each pantograph, (P, n, n) [N s/m, N/m]."""
    head: Array
    """Selects the displacement of the head, (P, n) [-]."""
    force: Array
    """Constant forces, (P, n) [N]."""
    contact_stiffness: Array
    """Stiffness of the penalty contact, infinite for a rigid contact, (P,) [N/m]."""
    contact_damping: Array
    """Damping beside this stiffness, (P,) [N s/m]."""
    hertz: Array
    """Penetration per F^(2/3) by Hertz's law, zero without this law, (P,) [m/N^(2/3)]."""
    z: Array
    """Displacement, velocity, acceleration, (3, P, n) [m, m/s, m/s2]."""
    contact: Array
    """Contact forces, (P, W) [N]."""


def build_empty_train(contact_wires: int) -> Train:
    """Build a train without a pantograph, for the free motion of a line."""
    return _allocate(0, 1, contact_wires)


def build_train(passage: Passage, touched: NDArray[np.bool_], wire_height: Array, flexibility: Array) -> Train:
    """Build the pantographs at rest, each pressing with its static force, or held down if the passage has a ramp.

    The touched contact wires share the force equally.

    Args:
        passage: Pantographs, positions, speed, time step and ramp.
        touched: Whether each head touches each contact wire at the start, (P, W).
        wire_height: Height of each touched contact wire at the position of each head in the state at the start, (P, W)
            [m].
        flexibility: Residual flexibility of each touched contact wire there, (P, W) [m/N].

    Returns:
        Pantographs and their state.
    """
    wires = wire_height.shape[1]
    train = _allocate(len(passage.pantographs), max(p.head.size for p in passage.pantographs), wires)
    train.position[:], train.speed[0], train.ramp[0] = passage.start, passage.speed, passage.ramp
    half, quarter = passage.time_step / 2, passage.time_step**2 / 4
    for p, pantograph in enumerate(passage.pantographs):
        n = pantograph.head.size
        effective = pantograph.mass + half * pantograph.damping + quarter * pantograph.stiffness
        train.inverse[p, :n, :n] = np.linalg.inv(effective)
        train.damping[p, :n, :n], train.stiffness[p, :n, :n] = pantograph.damping, pantograph.stiffness
        train.head[p, :n], train.force[p, :n] = pantograph.head, pantograph.force
        train.contact_stiffness[p], train.contact_damping[p] = pantograph.contact_stiffness, pantograph.contact_damping
        train.hertz[p] = pantograph.hertz_coefficient ** (-2 / 3)
        share = pantograph.static_force / touched[p].sum() if passage.ramp == 0 else 0.0
        train.contact[p, touched[p]] = share
        overlap = share * (1 / pantograph.contact_stiffness + float(flexibility[p, touched[p]].mean()))
        overlap += penetration(math.inf, pantograph.hertz_coefficient, share)
        train.z[0, p, :n], force_down = equilibrium(pantograph, float(wire_height[p, touched[p]].mean()) + overlap)
        train.held[p] = force_down if passage.ramp > 0 else 0.0
    return train


def _allocate(pantographs: int, unknowns: int, contact_wires: int) -> Train:
    """Train with zeros in all arrays."""
    return Train(
        position=np.zeros(pantographs),
        speed=np.zeros(1),
        elapsed=np.zeros(1),
        ramp=np.zeros(1),
        held=np.zeros(pantographs),
        inverse=np.zeros((pantographs, unknowns, unknowns)),
        damping=np.zeros((pantographs, unknowns, unknowns)),
        stiffness=np.zeros((pantographs, unknowns, unknowns)),
        head=np.zeros((pantographs, unknowns)),
        force=np.zeros((pantographs, unknowns)),
        contact_stiffness=np.zeros(pantographs),
        contact_damping=np.zeros(pantographs),
        hertz=np.zeros(pantographs),
        z=np.zeros((3, pantographs, unknowns)),
        contact=np.zeros((pantographs, contact_wires)),
    )
