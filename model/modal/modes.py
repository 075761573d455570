"""Modes of the line about its initial state, every dropper taut."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.catenary import Kind, Rayleigh
from pantocheck.model.description.one_thread import use_one_thread
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, with_damping
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order, free_unknowns
from pantocheck.model.statics.unit_responses import factored_stiffness


@dataclass(frozen=True)
class Modes:
    """Real modes of the undamped line, mass-normalised."""

    frequency: Array
    """Natural frequencies, ascending, (n,) [Hz]."""
    shape: Array
    """Deflection and slope of each mode, (n, rows, stations, 2) [kg^-1/2, kg^-1/2 m^-1]."""


@dataclass(frozen=True)
class ComponentEnergies:
    """Shares of the kinds of component in the energies of each mode."""

    kinds: tuple[Kind, ...]
    """Kinds in the order of the columns."""
    stiffness: Array
    """phi' K_e phi, (n, kinds); the sum over the kinds is (2 pi f)^2, without the share of held stretches [1/s2]."""
    mass: Array
    """phi' M_e phi, (n, kinds); the sum over the kinds is 1 [-]."""


@use_one_thread
def compute_modes(line: DiscretisedLine, count: int) -> Modes:
    """Compute the lowest modes of a line, every dropper taut.

    Args:
        line: Line in its initial state.
        count: Number of modes.
    """
    matrices, factored = assemble_matrices(line), factored_stiffness(line)

    def solve_free(force: Array) -> Array:
        """Displacements of the free unknowns under forces on them."""
        full = np.zeros(line.beams.free.size)
        full[matrices.free] = force.ravel()
        return factored.solve(full)[matrices.free]

    # A fixed start vector makes the result reproducible to the last digit.
    start = np.ones(matrices.free.size)
    inverse = LinearOperator(matrices.stiffness.shape, matvec=solve_free, dtype=np.float64)
    w2, vectors = eigsh(matrices.stiffness, count, matrices.mass, sigma=0.0, v0=start, OPinv=inverse)
    ascending = np.argsort(w2)
    shape = np.zeros((count, line.beams.free.size))
    shape[:, bandwidth_order(line)[matrices.free]] = _normalise_sign(vectors[:, ascending].T)
    return Modes(np.sqrt(w2[ascending]) / (2 * np.pi), shape.reshape(count, *line.beams.free.shape))


def compute_modes_below(line: DiscretisedLine, frequency: float) -> Modes:
    """Compute all modes of a line below a frequency [Hz]."""
    count, largest = 16, free_unknowns(line).size - 2
    while True:
        modes = compute_modes(line, min(count, largest))
        if modes.frequency[-1] >= frequency or count >= largest:
            inside = modes.frequency < frequency
            return Modes(modes.frequency[inside], modes.shape[inside])
        count *= 2


def free_vectors(line: DiscretisedLine, modes: Modes) -> Array:
    """Mode shapes as vectors of the free unknowns in global order, (n, unknowns)."""
    return modes.shape.reshape(len(modes.frequency), -1)[:, bandwidth_order(line)[free_unknowns(line)]]


def _normalise_sign(vectors: Array) -> Array:
    """Shapes with a positive largest entry."""
    largest = np.take_along_axis(vectors, np.abs(vectors).argmax(axis=1)[:, None], axis=1)
    return np.asarray(vectors * np.sign(largest))


def deflection_at(line: DiscretisedLine, modes: Modes, row: int, position: float) -> Array:
    """Deflection of every mode at a station [m] of one row, (n,) [kg^-1/2]."""
    return np.asarray(modes.shape[:, row, line.mesh.station(position), 0])


def component_energies(line: DiscretisedLine, modes: Modes) -> ComponentEnergies:
    """Compute the share of every kind of component in the energies of the modes.

    Returns:
        Energies. The damping C = sum of a_e K_e + b_e M_e gives mode j the ratio sum (a_e k_ej + b_e m_ej) / (2 w_j).
    """
    vectors = free_vectors(line, modes)
    kinds = tuple(Kind)
    stiffness, mass = (np.zeros((len(vectors), len(kinds))) for _ in range(2))
    constant = _energy(with_damping(line, {}), vectors)
    for k, kind in enumerate(kinds):
        # With one coefficient set to one, the damping matrix is the stiffness or the mass of that component.
        stiffness[:, k] = _energy(with_damping(line, {kind: Rayleigh(stiffness_coefficient=1.0)}), vectors) - constant
        mass[:, k] = _energy(with_damping(line, {kind: Rayleigh(mass_coefficient=1.0)}), vectors) - constant
    return ComponentEnergies(kinds, stiffness, mass)


def _energy(line: DiscretisedLine, vectors: Array) -> Array:
    """Product phi' C phi of every vector with the damping of the line."""
    return np.asarray(np.einsum("ji,ij->j", vectors, assemble_matrices(line).damping @ vectors.T))


def damping_ratios(line: DiscretisedLine, modes: Modes) -> Array:
    """Damping ratio of every mode, phi' C phi / (2 w), without the coupling of modes through the damping.

    Args:
        line: Discretised line with its damping.
        modes: Modes of the line.

    Returns:
        Damping ratios, (n,) [-].
    """
    return _energy(line, free_vectors(line, modes)) / (4 * np.pi * modes.frequency)
