"""Modes of the line about its initial state, every dropper taut."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import eigsh

from pantocheck.model.arrays import Array
from pantocheck.model.catenary import Kind, Rayleigh
from pantocheck.model.discretised_line import DiscretisedLine, with_damping
from pantocheck.model.fem.assembly import assemble_matrices, bandwidth_order


@dataclass(frozen=True)
class Modes:
    """Real modes of the undamped line, mass-normalised.

    Parameters
    ----------
    frequency : (n,) ndarray
        Ascending [Hz].
    shape : (n, rows, stations, 2) ndarray
        Deflection and slope [kg^-1/2, kg^-1/2 m^-1].
    """

    frequency: Array
    shape: Array


@dataclass(frozen=True)
class ComponentEnergies:
    """How the energy of each mode is shared out over the kinds of component.

    Parameters
    ----------
    kinds : tuple[Kind, ...]
        The kinds, in the order of the columns.
    stiffness : (n, kinds) ndarray
        Phi' K_e phi, adding up to (2 pi f)^2 [1/s2].
    mass : (n, kinds) ndarray
        Phi' M_e phi, adding up to 1 [-].
    """

    kinds: tuple[Kind, ...]
    stiffness: Array
    mass: Array


def compute_modes(line: DiscretisedLine, count: int) -> Modes:
    """The lowest modes of a line.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    count : int
        How many.

    Returns
    -------
    Modes
        The modes.
    """
    matrices = assemble_matrices(line)
    # A fixed start vector makes the iteration, and with it the last digits, the same every time.
    begin = np.ones(matrices.free.size)
    w2, vectors = eigsh(matrices.stiffness, count, matrices.mass, sigma=0.0, v0=begin)
    ascending = np.argsort(w2)
    shape = np.zeros((count, line.beams.free.size))
    shape[:, bandwidth_order(line)[matrices.free]] = _signed(vectors[:, ascending].T)
    return Modes(np.sqrt(w2[ascending]) / (2 * np.pi), shape.reshape(count, *line.beams.free.shape))


def _signed(vectors: Array) -> Array:
    """Each shape turned so that its largest entry is positive."""
    largest = np.take_along_axis(vectors, np.abs(vectors).argmax(axis=1)[:, None], axis=1)
    signed: Array = vectors * np.sign(largest)
    return signed


def deflection_at(line: DiscretisedLine, shapes: Modes, row: int, position: float) -> Array:
    """Deflection of every mode at one place of one row.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    shapes : Modes
        Its modes.
    row : int
        Which row.
    position : float
        At a station [m].

    Returns
    -------
    (n,) ndarray
        [kg^-1/2].
    """
    return np.asarray(shapes.shape[:, row, line.mesh.station(position), 0])


def component_energies(line: DiscretisedLine, shapes: Modes) -> ComponentEnergies:
    """Share of every kind of component in the energies of the modes.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    shapes : Modes
        Its modes.

    Returns
    -------
    ComponentEnergies
        The energies; a damping model a_e K_e + b_e M_e gives mode j the ratio sum (a_e k_ej + b_e m_ej) / (2 omega_j).
    """
    free = assemble_matrices(line).free
    vectors = shapes.shape.reshape(len(shapes.frequency), -1)[:, bandwidth_order(line)[free]]
    kinds = tuple(Kind)
    stiffness, mass = (np.zeros((len(vectors), len(kinds))) for _ in range(2))
    dampers = _energy(with_damping(line, {}), vectors)
    for k, kind in enumerate(kinds):
        # The damping matrix with one coefficient set to one is that component's stiffness or mass.
        stiffness[:, k] = _energy(with_damping(line, {kind: Rayleigh(stiffness_coefficient=1.0)}), vectors) - dampers
        mass[:, k] = _energy(with_damping(line, {kind: Rayleigh(mass_coefficient=1.0)}), vectors) - dampers
    return ComponentEnergies(kinds, stiffness, mass)


def _energy(line: DiscretisedLine, vectors: Array) -> Array:
    return np.asarray(np.einsum("ji,ij->j", vectors, assemble_matrices(line).damping @ vectors.T))


def damping_ratios(line: DiscretisedLine, shapes: Modes) -> Array:
    """Damping ratio of every mode, its coupling with others through the damping left out: phi' C phi / (2 omega).

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line, with its damping.
    shapes : Modes
        Its modes.

    Returns
    -------
    (n,) ndarray
        [-].
    """
    free = assemble_matrices(line).free
    vectors = shapes.shape.reshape(len(shapes.frequency), -1)[:, bandwidth_order(line)[free]]
    return _energy(line, vectors) / (4 * np.pi * shapes.frequency)
