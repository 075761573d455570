"""Derivatives of the modes of a line by its properties, exact for the eigenvalues.

With mass-normalised modes phi_j of K phi = lambda M phi, and a property that changes K by K' and M by M' [1]:

    d lambda_j = phi_j' (K' - lambda_j M') phi_j
    d phi_j = sum over k of phi_k g_kj,    g_kj = phi_k' (K' - lambda_j M') phi_j / (lambda_j - lambda_k)
                                           g_jj = -phi_j' M' phi_j / 2

No eigenvalue is differenced. K' and M' are those of the whole line, its initial state included: the prescribed heights
of the contact wire are held, dropper lengths and forces follow. The static responses K^-1 (K' - lambda_j M') phi_j join
the span as further vectors, so that modes above it contribute to d phi, too.

References:
    [1] R. L. Fox, M. P. Kapoor, Rates of change of eigenvalues and eigenvectors, AIAA Journal 6 (1968) 2426-2429.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sp

from pantocheck.model.description.arrays import Array
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.modal.modes import Modes, build_line_modes, free_vectors
from pantocheck.model.statics.assembly import assemble_matrices, free_unknowns, stretch_directions
from pantocheck.model.statics.unit_responses import factored_stiffness

SMALLEST_SHARE = 1e-6
"""Smallest share of a direction in the responses that joins the span, relative to the largest [-]."""


@dataclass(frozen=True)
class NeighbouringLines:
    """Line with a property a little below and above its value, on the same mesh."""

    lower: DiscretisedLine
    upper: DiscretisedLine
    distance: float
    """Difference of the property between both lines."""


@dataclass(frozen=True)
class ModeDerivatives:
    """Derivatives of m modes by p properties, in a span of s vectors."""

    span: Modes
    """Vectors of the span, the modes first: s shapes with their frequencies."""
    vectors: Array
    """The same as vectors of the free unknowns, (s, unknowns)."""
    eigenvalue: Array
    """Derivatives of the eigenvalues, (p, m) [1/s2]."""
    rotation: Array
    """Shares g_kj of vector k in the derivative of the shape of mode j, (p, s, m)."""

    def form_derivative(self, matrix: sp.csc_array, own: Array) -> Array:
        """Derivatives of the quadratic forms phi_j' C phi_j, (p, m).

        Args:
            matrix: Symmetric matrix C of the free unknowns.
            own: Quadratic forms of its derivatives, (p, m).
        """
        mixed = self.vectors @ (matrix @ self.vectors[: own.shape[1]].T)
        return np.asarray(own + 2 * np.einsum("kj,pkj->pj", mixed, self.rotation))


def derive_modes(line: DiscretisedLine, modes: Modes, neighbours: Sequence[NeighbouringLines]) -> ModeDerivatives:
    """Derive the lowest modes of a line; neighbouring lines for each property."""
    vectors, square = free_vectors(line, modes), (2 * np.pi * modes.frequency) ** 2
    changes = [_difference_matrices(each) for each in neighbours]
    loads = np.array([stiffness @ vectors.T - (mass @ vectors.T) * square for stiffness, mass in changes])
    above, responses = _complete_span(line, vectors, np.hstack(list(loads)))
    span, every = np.vstack([vectors, responses]), np.append(square, above)
    forms, own = span @ loads, np.arange(square.size)
    gap = square - every[:, None]
    gap[own, own] = 1.0
    rotation = forms / gap
    rotation[:, own, own] = [-np.einsum("jn,nj->j", vectors, mass @ vectors.T) / 2 for _, mass in changes]
    return ModeDerivatives(build_line_modes(line, every, span), span, forms[:, own, own], rotation)


def _difference_matrices(neighbours: NeighbouringLines) -> tuple[sp.csc_array, sp.csc_array]:
    """Derivatives of stiffness and mass by a property: matrices are smooth functions of it, closed forms mostly."""
    lower, upper = _full_matrices(neighbours.lower), _full_matrices(neighbours.upper)
    stiffness, mass = ((high - low) / neighbours.distance for low, high in zip(lower, upper, strict=True))
    return stiffness, mass


def _complete_span(line: DiscretisedLine, vectors: Array, loads: Array) -> tuple[Array, Array]:
    """Eigenvalues and vectors of the static responses to loads, (unknowns, l), in what modes leave of their span."""
    stiffness, mass = _full_matrices(line)
    free = free_unknowns(line)
    full = np.zeros((line.beams.free.size, loads.shape[1]))
    full[free] = loads
    response = factored_stiffness(line).solve(full)[free].T
    response -= (response @ (mass @ vectors.T)) @ vectors
    size = np.sqrt(np.einsum("ij,ji->i", response, mass @ response.T))
    response = response[size > 0] / size[size > 0, None]
    weight, share = np.linalg.eigh(_project_matrix(response, mass))
    kept = weight > SMALLEST_SHARE * weight.max(initial=0.0)
    own = (share[:, kept] / np.sqrt(weight[kept])).T @ response
    own -= (own @ (mass @ vectors.T)) @ vectors  # the first subtraction left its rounding, which grew
    eigenvalue, shares = scipy.linalg.eigh(_project_matrix(own, stiffness), _project_matrix(own, mass))
    return eigenvalue, shares.T @ own


def _project_matrix(vectors: Array, matrix: sp.csc_array) -> Array:
    """Product V C V' of vectors V, (n, unknowns), with a matrix of the free unknowns, (n, n)."""
    product = vectors @ (matrix @ vectors.T)
    return np.asarray((product + product.T) / 2)


def _full_matrices(line: DiscretisedLine) -> tuple[sp.csc_array, sp.csc_array]:
    """Stiffness, with that of held stretches, and mass of the free unknowns."""
    matrices = assemble_matrices(line)
    if not line.stretches.stiffness.size:
        return matrices.stiffness, matrices.mass
    held = sp.csr_array(stretch_directions(line))[matrices.free]
    return matrices.stiffness + held @ sp.diags_array(line.stretches.stiffness) @ held.T, matrices.mass
