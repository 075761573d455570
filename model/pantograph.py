"""Pantographs: chains of lumped masses, or any linear model given by its matrices or modes.

 wire
======
  |  contact force F, pressing the head down
 [m_n]   head
  |  k_n, c_n
 [...]
  |  k_1, c_1
-----    base
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from pantocheck.model.arrays import Array


@dataclass(frozen=True)
class Pantograph:
    """A linear pantograph model: M z'' + C z' + K z = force - contact force on the head.

    Displacements z are counted upwards from the contact wire's height at the supports.

    Parameters
    ----------
    mass, damping, stiffness : (n, n) ndarray
        Symmetric matrices [kg, N s/m, N/m].
    head : (n,) ndarray
        Picks the head's displacement out of the unknowns [-].
    force : (n,) ndarray
        Constant force on the unknowns: uplift, and preload of the springs [N].
    static_force : float
        Contact force at rest [N].
    contact_stiffness : float
        Of the penalty between head and wire [N/m].
    """

    mass: Array
    damping: Array
    stiffness: Array
    head: Array
    force: Array
    static_force: float
    contact_stiffness: float


def chain(
    masses: Array,
    stiffness: Array,
    damping: Array,
    uplift_force: float,
    uplift_on: int,
    contact_stiffness: float,
    unstretched_height: float = 0.0,
) -> Pantograph:
    """A chain of lumped masses from base to head.

    Parameters
    ----------
    masses : (n,) ndarray
        From the base upwards [kg].
    stiffness, damping : (n,) ndarray
        Of the element below each mass [N/m, N s/m].
    uplift_force : float
        Constant [N].
    uplift_on : int
        Index of the mass it acts on.
    contact_stiffness : float
        [N/m].
    unstretched_height : float
        Of all masses, over the contact wire at the supports, at which no spring is stretched [m].

    Returns
    -------
    Pantograph
        The pantograph.
    """
    n = len(masses)
    force, head = np.zeros(n), np.zeros(n)
    force[uplift_on] = uplift_force
    head[-1] = 1.0
    stiff = _chain_matrix(stiffness)
    force += stiff @ np.full(n, unstretched_height)
    return Pantograph(
        np.diag(np.asarray(masses, dtype=float)),
        _chain_matrix(damping),
        stiff,
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
    working_height: float = 0.0,
) -> Pantograph:
    """A linear pantograph given by its matrices, at rest when it presses with its static force at a working height.

    Where its constant uplift force acts makes no difference to a linear model: it only sets this state of rest.

    Parameters
    ----------
    mass, damping, stiffness : (n, n) ndarray
        Symmetric matrices [kg, N s/m, N/m]; for modal unknowns, per their normalisation.
    head : (n,) ndarray
        Picks the head's displacement out of the unknowns.
    static_force : float
        Contact force at rest [N].
    contact_stiffness : float
        [N/m].
    working_height : float
        Of the head at rest, over the contact wire at the supports [m].

    Returns
    -------
    Pantograph
        The pantograph.
    """
    head, stiff = np.asarray(head, dtype=float), np.asarray(stiffness, dtype=float)
    # Any unknowns that put the head at its height will do: what they stretch is preload.
    at_rest = head * working_height / (head @ head)
    return Pantograph(
        np.asarray(mass, dtype=float),
        np.asarray(damping, dtype=float),
        stiff,
        head,
        static_force * head + stiff @ at_rest,
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
    """A pantograph given by its modes, mass-normalised.

    Parameters
    ----------
    frequency : (n,) ndarray
        [Hz]; zero for a rigid-body mode.
    damping_ratio : (n,) ndarray
        [-].
    head_shape : (n,) ndarray
        Displacement of the head in each mode [kg^-1/2].
    modal_force : (n,) ndarray
        Constant force on each mode [N kg^-1/2].
    static_force : float
        Contact force at rest [N].
    contact_stiffness : float
        [N/m].

    Returns
    -------
    Pantograph
        The pantograph.
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


def frequencies(pantograph: Pantograph) -> Array:
    """Undamped natural frequencies with the base fixed and the head free, ascending [Hz]."""
    w2 = eigh(pantograph.stiffness, pantograph.mass, eigvals_only=True)
    return np.asarray(np.sqrt(np.maximum(w2, 0.0)) / (2 * np.pi))


def apparent_mass(pantograph: Pantograph, frequency: Array) -> Array:
    """Frequency response at the head: force over acceleration, as a test rig measures it.

    Parameters
    ----------
    pantograph : Pantograph
        The model.
    frequency : (m,) ndarray
        Above zero [Hz].

    Returns
    -------
    (m,) ndarray
        Complex [kg].
    """
    omega = 2 * np.pi * np.asarray(frequency, dtype=float)
    receptance = np.empty(omega.size, dtype=complex)
    for i, w in enumerate(omega):
        dynamic = pantograph.stiffness + 1j * w * pantograph.damping - w**2 * pantograph.mass
        receptance[i] = pantograph.head @ np.linalg.solve(dynamic, pantograph.head.astype(complex))
    return -1.0 / (omega**2 * receptance)


def _chain_matrix(element: Array) -> Array:
    n = len(element)
    matrix = np.zeros((n, n))
    for i, value in enumerate(element):
        matrix[i, i] += value
        if i:
            matrix[i - 1, i - 1] += value
            matrix[i, i - 1] -= value
            matrix[i - 1, i] -= value
    return matrix
