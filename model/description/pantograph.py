"""Pantographs: chains of lumped masses, or any linear model defined by its matrices or modes.

 wire
======
  |  contact force F, pressing the head down
 [m_n]   head
  |  k_n, c_n
 [...]
  |  k_1, c_1
-----    base
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import scipy  # loads scipy.linalg when it is used

from pantocheck.model.description.arrays import Array


@dataclass(frozen=True)
class Strip:
    """Collector strip: point of contact with a wire."""

    offset: float
    """Distance ahead of the position of the pantograph [m]."""
    shape: Array
    """Displacement of the strip at the lateral position y per unknown: coefficients of the powers of y from 0 on,
    (D, n) [-, 1/m, ...]; one row if the lateral position of the wire has no effect.
    """


@dataclass(frozen=True)
class Pantograph:
    """Linear pantograph model: M z'' + C z' + K z = force - contact forces on the strips.

    Displacements z are positive upwards from the datum of the line.
    """

    mass: Array
    damping: Array
    stiffness: Array
    """Symmetric matrices, (n, n) [kg, N s/m, N/m]."""
    head: Array
    """Selects the displacement of the head from the unknowns, (n,) [-]; of several strips, their mean."""
    force: Array
    """Constant forces on the unknowns, (n,): uplift force and preload of the springs [N]."""
    static_force: float
    """Contact force at rest [N]."""
    contact_stiffness: float
    """Stiffness of the penalty contact between head and wire; infinite: none, head and wire touch rigidly [N/m]."""
    contact_damping: float = 0.0
    """Damping beside this stiffness [N s/m]."""
    hertz_coefficient: float = math.inf
    """Coefficient K of Hertz's law F = K penetration^1.5, in series with the stiffness; infinite: none [N/m^1.5]."""
    own_strips: tuple[Strip, ...] = ()
    """Collector strips from front to rear; empty: the head is the only one."""

    @property
    def strips(self) -> tuple[Strip, ...]:
        """Points of contact from front to rear."""
        return self.own_strips or (Strip(0.0, self.head[None]),)

    @property
    def strip_shapes(self) -> Array:
        """Displacement of each strip below the track axis per unknown, (strips, n) [-]."""
        return np.array([strip.shape[0] for strip in self.strips])

    @property
    def strip_shares(self) -> Array:
        """Share of each strip in the static force on a level wire, (strips,) [-]."""
        size = len(self.strips)
        if size == 1 or self.static_force == 0:
            return np.full(size, 1 / size)
        forces, raised = (equilibrium(self, height)[1] for height in (0.0, 1.0))
        slope = raised - forces
        # The height at which both carry the static force; without a base spring every height is suitable.
        height = (self.static_force - forces.sum()) / slope.sum() if abs(slope.sum()) > 1e-9 else 0.0
        return np.asarray((forces + height * slope) / (forces + height * slope).sum())


def build_chain(
    masses: Array,
    stiffness: Array,
    damping: Array,
    uplift_force: float,
    uplift_on: int,
    contact_stiffness: float,
) -> Pantograph:
    """Build a chain of lumped masses from base to head.

    Args:
        masses: Masses from the base upwards, (n,) [kg].
        stiffness, damping: Stiffness and damping of the element below each mass, (n,) [N/m, N s/m].
        uplift_force: Constant uplift force [N].
        uplift_on: Index of the mass on which it acts.
        contact_stiffness: Stiffness of the penalty contact [N/m].

    Returns:
        Linear model.
    """
    n = len(masses)
    force, head = np.zeros(n), np.zeros(n)
    force[uplift_on] = uplift_force
    head[-1] = 1.0
    return Pantograph(
        np.diag(np.asarray(masses, dtype=float)),
        _chain_matrix(damping),
        _chain_matrix(stiffness),
        head,
        force,
        uplift_force,
        contact_stiffness,
    )


def from_matrices(
    mass: Array,
    damping: Array,
    stiffness: Array,
    head: Array,
    static_force: float,
    contact_stiffness: float,
) -> Pantograph:
    """Build a pantograph from its matrices, at rest under its static force with the head at height zero.

    In a linear model the constant uplift force only determines the state of rest, wherever it acts.

    Args:
        mass, damping, stiffness: Symmetric matrices, (n, n) [kg, N s/m, N/m]; for modal unknowns in the units of their
            normalisation.
        head: Selects the displacement of the head from the unknowns, (n,).
        static_force: Contact force at rest [N].
        contact_stiffness: Stiffness of the penalty contact [N/m].
    """
    head = np.asarray(head, dtype=float)
    return Pantograph(
        np.asarray(mass, dtype=float),
        np.asarray(damping, dtype=float),
        np.asarray(stiffness, dtype=float),
        head,
        static_force * head,
        static_force,
        contact_stiffness,
    )


def from_modes(
    frequency: Array,
    damping_ratio: Array,
    head_shape: Array,
    modal_force: Array,
    static_force: float,
    contact_stiffness: float,
) -> Pantograph:
    """Build a pantograph from its mass-normalised modes.

    Args:
        frequency: Natural frequencies, (n,); zero for a rigid-body mode [Hz].
        damping_ratio: Damping ratios, (n,) [-].
        head_shape: Displacement of the head in each mode, (n,) [kg^-1/2].
        modal_force: Constant force on each mode, (n,) [N kg^-1/2].
        static_force: Contact force at rest [N].
        contact_stiffness: Stiffness of the penalty contact [N/m].

    Returns:
        Linear model.
    """
    omega = 2 * np.pi * np.asarray(frequency, dtype=float)
    return Pantograph(
        np.eye(omega.size),
        np.diag(2 * np.asarray(damping_ratio) * omega),
        np.diag(omega**2),
        np.asarray(head_shape, dtype=float),
        np.asarray(modal_force, dtype=float),
        static_force,
        contact_stiffness,
    )


def preload_springs(pantograph: Pantograph, displacement: Array) -> Pantograph:
    """Preload the springs so that they are unstretched at a displacement of the unknowns, (n,) ndarray [m]."""
    return replace(pantograph, force=pantograph.force + pantograph.stiffness @ displacement)


def equilibrium(pantograph: Pantograph, height: float | Array) -> tuple[Array, Array]:
    """Static equilibrium with the strips held at a height.

    Args:
        pantograph: Linear model.
        height: Height of each strip, or of all, above the datum of the line, (strips,) [m].

    Returns:
        displacement: Displacements of the unknowns, all but the strips in equilibrium, (n,).
        contact_forces: Contact force that holds each strip, (strips,) [N].
    """
    n, shapes = pantograph.head.size, pantograph.strip_shapes
    size = n + len(shapes)
    system = np.zeros((size, size))
    system[:n, :n] = pantograph.stiffness
    system[:n, n:], system[n:, :n] = shapes.T, shapes
    held = np.append(pantograph.force, np.broadcast_to(height, len(shapes)))
    solution = np.linalg.solve(system, held)
    return np.asarray(solution[:n]), np.asarray(solution[n:])


def frequencies(pantograph: Pantograph) -> Array:
    """Undamped natural frequencies with the base fixed and the head free, ascending [Hz]."""
    w2 = scipy.linalg.eigh(pantograph.stiffness, pantograph.mass, eigvals_only=True)
    return np.asarray(np.sqrt(np.maximum(w2, 0.0)) / (2 * np.pi))


def apparent_mass(pantograph: Pantograph, frequency: Array) -> Array:
    """Frequency response at the head: force over acceleration, as measured on a test rig.

    Args:
        pantograph: Linear model.
        frequency: Frequencies above zero, (m,) [Hz].

    Returns:
        Complex apparent mass, (m,) [kg].
    """
    omega = 2 * np.pi * np.asarray(frequency, dtype=float)
    receptance = np.empty(omega.size, dtype=complex)
    for i, w in enumerate(omega):
        dynamic = pantograph.stiffness + 1j * w * pantograph.damping - w**2 * pantograph.mass
        receptance[i] = pantograph.head @ np.linalg.solve(dynamic, pantograph.head.astype(complex))
    return -1.0 / (omega**2 * receptance)


def _chain_matrix(element: Array) -> Array:
    """Matrix of a chain of elements, each between a mass and its lower neighbour or the base."""
    above = element[1:]
    return np.diag(element + np.append(above, 0.0)) - np.diag(above, 1) - np.diag(above, -1)
