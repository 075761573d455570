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
from numpy.typing import NDArray

from pantocheck.model.description.arrays import Array


@dataclass(frozen=True)
class ContactStrip:
    """Collector strip: point of contact with a wire."""

    offset: float
    """Distance ahead of the position of the pantograph [m]."""
    shape: Array
    """Displacement of the strip at the lateral position y per unknown: coefficients of the powers of y from 0 on,
    (D, n) [-, 1/m, ...]; one row if the lateral position of the wire has no effect.
    """


@dataclass(frozen=True)
class Joint:
    """Force between parts of a pantograph: X = stiffness (e - gap) + damping e', within bounds, e = direction . z.

    A stop is unilateral: X >= 0. Coulomb friction has the bounds +-F and a damper F / v: it slides at speeds above v.
    """

    direction: Array
    """Closing of both parts per unknown, (n,) [-]; the force on the unknowns is -X direction."""
    stiffness: float = 0.0
    damping: float = 0.0
    """Coefficients [N/m, N s/m]."""
    gap: float = 0.0
    """Closing from which the stiffness acts [m]."""
    lower: float = 0.0
    upper: float = math.inf
    """Bounds of the force [N]."""


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
    own_strips: tuple[ContactStrip, ...] = ()
    """Collector strips from front to rear; empty: the head is the only one."""
    joints: tuple[Joint, ...] = ()
    """Forces of friction and stops."""

    @property
    def strips(self) -> tuple[ContactStrip, ...]:
        """Points of contact from front to rear."""
        return self.own_strips or (ContactStrip(0.0, self.head[None]),)

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


def from_poles(
    pole: NDArray[np.complex128],
    residue: NDArray[np.complex128],
    static_force: float,
    contact_stiffness: float,
) -> Pantograph:
    """Build a pantograph from its receptance, the sum of r / (s - p) and of the conjugate terms [m/N].

    A term is a state x with x' = p x + f, times r. The real and the negative imaginary part of r x' = r p x + r f are a
    symmetric system without mass, C z' + K z = head f, so that a transfer function is a pantograph like any other.

    Args:
        pole: Poles with an imaginary part of zero or above, (n,) [1/s].
        residue: Residues, (n,) [m/(N s)].
        static_force: Contact force at rest [N].
        contact_stiffness: Stiffness of the penalty contact [N/m].
    """
    real = np.flatnonzero(np.repeat(pole.imag == 0, 2) & (np.arange(2 * pole.size) % 2 == 1))

    def matrix(factor: NDArray[np.complex128]) -> Array:
        """Symmetric matrix of the form Re(factor x^2) of every pair, twice; a real pole has one unknown."""
        blocks = [np.array([[f.real, -f.imag], [-f.imag, -f.real]]) * (2 if p.imag else 1) for f, p in pairs(factor)]
        return np.delete(np.delete(scipy.linalg.block_diag(*blocks), real, 0), real, 1)

    def pairs(factor: NDArray[np.complex128]) -> list[tuple[complex, complex]]:
        return list(zip(factor.tolist(), pole.tolist(), strict=True))

    head = np.delete(np.ravel([(2 if p.imag else 1) * np.array([r.real, -r.imag]) for r, p in pairs(residue)]), real)
    damping = matrix(residue)
    stiffness = -matrix(residue * pole)
    return from_matrices(0 * damping, damping, stiffness, head, static_force, contact_stiffness)


def add_unknown(pantograph: Pantograph, mass: float, damping: float = 0.0, stiffness: float = 0.0) -> Pantograph:
    """Add an unknown with its own mass, damper and spring; no strip moves with it yet.

    Args:
        pantograph: Linear model.
        mass, damping, stiffness: Coefficients [kg, N s/m, N/m], or those of a rotation or of a mode.
    """
    ends = ((pantograph.mass, mass), (pantograph.damping, damping), (pantograph.stiffness, stiffness))
    matrices = [np.asarray(scipy.linalg.block_diag(matrix, value)) for matrix, value in ends]
    strips = tuple(replace(strip, shape=np.pad(strip.shape, ((0, 0), (0, 1)))) for strip in pantograph.own_strips)
    return replace(
        pantograph,
        mass=matrices[0],
        damping=matrices[1],
        stiffness=matrices[2],
        head=np.append(pantograph.head, 0.0),
        force=np.append(pantograph.force, 0.0),
        own_strips=strips,
    )


def add_spring(pantograph: Pantograph, direction: Array, stiffness: float, damping: float) -> Pantograph:
    """Add a spring and a damper [N/m, N s/m] on the displacement direction . z; direction: (n,)."""
    square = np.outer(direction, direction)
    return replace(
        pantograph,
        stiffness=pantograph.stiffness + stiffness * square,
        damping=pantograph.damping + damping * square,
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


def state_space(pantograph: Pantograph) -> tuple[Array, Array, Array]:
    """State space x' = A x - B F of the contact forces, and the head as a sum of the states.

    Returns:
        A: Matrix of the states: displacements and velocities, or those of a transfer function, (k, k).
        B: Effect of each strip, (k, strips).
        head: Displacement of the head per state, (k,).
    """
    n, shapes = pantograph.head.size, pantograph.strip_shapes
    if not pantograph.mass.any():
        inverse = np.linalg.inv(pantograph.damping)
        return -inverse @ pantograph.stiffness, inverse @ shapes.T, pantograph.head
    inverse = np.linalg.inv(pantograph.mass)
    lower = [-inverse @ pantograph.stiffness, -inverse @ pantograph.damping]
    matrix = np.block([[np.zeros((n, n)), np.eye(n)], lower])
    drive = np.vstack([np.zeros(shapes.T.shape), inverse @ shapes.T])
    return matrix, drive, np.append(pantograph.head, np.zeros(n))


def frequencies(pantograph: Pantograph) -> Array:
    """Undamped natural frequencies with the base fixed and the head free, ascending [Hz]."""
    if not pantograph.mass.any():  # a transfer function has poles only
        return np.unique(np.abs(np.linalg.eigvals(state_space(pantograph)[0]).imag)) / (2 * np.pi)
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
