"""Modes of a line whose properties change, in the span of its known modes, with exact derivatives.

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
from pantocheck.model.modal.modes import Modes, free_vectors
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order, free_unknowns, stretch_directions
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
class ReducedLine:
    """Matrices of a line in a span of s vectors, its modes first; derivatives by p properties."""

    vectors: Array
    """Mass-normalised vectors of the free unknowns, (s, unknowns)."""
    eigenvalue: Array
    """Squared angular frequencies, (s,) [1/s2]."""
    stiffness: Array
    mass: Array
    """Derivatives of the matrices by the properties, (p, s, s)."""


@dataclass(frozen=True)
class ReducedModes:
    """Modes of a changed line in the span; the first ones are those of the line, the last ones none."""

    eigenvalue: Array
    """Squared angular frequencies, ascending, (s,) [1/s2]."""
    vector: Array
    """Shares of the vectors of the span in each mode, (s, s); one column per mode."""
    eigenvalue_derivative: Array
    """Derivatives of the eigenvalues by the properties, (p, s)."""
    rotation: Array
    """Shares g_kj of mode k in the derivative of the shape of mode j, (p, s, s)."""

    def form_derivative(self, matrix: Array, derivative: Array) -> Array:
        """Derivatives of the quadratic forms phi_j' C phi_j by the properties, (p, s).

        Args:
            matrix: Symmetric matrix C in the span, (s, s).
            derivative: Its derivatives by the properties, (p, s, s).
        """
        own = np.sum(self.vector * (derivative @ self.vector), axis=1)
        return np.asarray(own + 2 * np.einsum("jk,pkj->pj", self.vector.T @ matrix @ self.vector, self.rotation))


def reduce_line(line: DiscretisedLine, modes: Modes, neighbours: Sequence[NeighbouringLines]) -> ReducedLine:
    """Reduce a line to its modes and their static responses to changes; neighbouring lines for each property."""
    vectors, eigenvalue = free_vectors(line, modes), (2 * np.pi * modes.frequency) ** 2
    changes = [_difference_matrices(each) for each in neighbours]
    loads = [stiffness @ vectors.T - (mass @ vectors.T) * eigenvalue for stiffness, mass in changes]
    if loads:
        eigenvalue, vectors = _add_responses(line, vectors, np.hstack(loads))
    count = eigenvalue.size
    stiffness, mass = (
        np.array([project_matrix(vectors, pair[part]) for pair in changes]).reshape(-1, count, count) for part in (0, 1)
    )
    return ReducedLine(vectors, eigenvalue, stiffness, mass)


def _difference_matrices(neighbours: NeighbouringLines) -> tuple[sp.csc_array, sp.csc_array]:
    """Derivatives of stiffness and mass by a property: matrices are smooth functions of it, closed forms mostly."""
    lower, upper = _full_matrices(neighbours.lower), _full_matrices(neighbours.upper)
    stiffness, mass = ((high - low) / neighbours.distance for low, high in zip(lower, upper, strict=True))
    return stiffness, mass


def _add_responses(line: DiscretisedLine, vectors: Array, loads: Array) -> tuple[Array, Array]:
    """Eigenvalues and vectors of the span of modes and static responses to loads, (unknowns, l)."""
    stiffness, mass = _full_matrices(line)
    free = free_unknowns(line)
    full = np.zeros((line.beams.free.size, loads.shape[1]))
    full[free] = loads
    response = factored_stiffness(line).solve(full)[free].T
    response -= (response @ (mass @ vectors.T)) @ vectors
    size = np.sqrt(np.einsum("ij,ij->i", response @ mass, response))
    response = response[size > 0] / size[size > 0, None]
    weight, share = np.linalg.eigh(project_matrix(response, mass))
    kept = weight > SMALLEST_SHARE * weight.max(initial=0.0)
    span = np.vstack([vectors, (share[:, kept] / np.sqrt(weight[kept])).T @ response])
    eigenvalue, shares = scipy.linalg.eigh(project_matrix(span, stiffness), project_matrix(span, mass))
    own = shares.T @ span
    sign = np.sign(np.einsum("ij,ij->i", own[: len(vectors)] @ mass, vectors))
    own[: len(vectors)] *= np.where(sign == 0, 1.0, sign)[:, None]
    return eigenvalue, own


def project_matrix(vectors: Array, matrix: sp.csc_array) -> Array:
    """Product V C V' of vectors V, (n, unknowns), with a matrix of the free unknowns, (n, n)."""
    product = vectors @ (matrix @ vectors.T)
    return np.asarray((product + product.T) / 2)


def solve_reduced(reduced: ReducedLine, change: Array) -> ReducedModes:
    """Compute the modes of a line whose properties change by `change`, (p,), and their derivatives there."""
    stiffness = np.diag(reduced.eigenvalue) + np.tensordot(change, reduced.stiffness, 1)
    mass = np.eye(reduced.eigenvalue.size) + np.tensordot(change, reduced.mass, 1)
    eigenvalue, vector = scipy.linalg.eigh(stiffness, mass)
    # Each mode keeps the sign of its largest share.
    largest = np.take_along_axis(vector, np.abs(vector).argmax(axis=0)[None], axis=0)
    vector = vector * np.sign(largest)
    forms_k, forms_m = (vector.T @ forms @ vector for forms in (reduced.stiffness, reduced.mass))
    numerator = forms_k - forms_m * eigenvalue
    gap = eigenvalue[None, :] - eigenvalue[:, None]
    np.fill_diagonal(gap, 1.0)
    rotation = numerator / gap
    diagonal = np.arange(eigenvalue.size)
    rotation[:, diagonal, diagonal] = -forms_m[:, diagonal, diagonal] / 2
    return ReducedModes(eigenvalue, vector, numerator[:, diagonal, diagonal], rotation)


def _full_matrices(line: DiscretisedLine) -> tuple[sp.csc_array, sp.csc_array]:
    """Stiffness, with that of held stretches, and mass of the free unknowns."""
    matrices = assemble_matrices(line)
    held = sp.csr_array(stretch_directions(line))[matrices.free]
    return matrices.stiffness + held @ sp.diags_array(line.stretches.stiffness) @ held.T, matrices.mass


def span_shapes(line: DiscretisedLine, reduced: ReducedLine) -> Modes:
    """Vectors of the span as shapes of the line."""
    shape = np.zeros((reduced.eigenvalue.size, line.beams.free.size))
    shape[:, bandwidth_order(line)[free_unknowns(line)]] = reduced.vectors
    return Modes(np.sqrt(reduced.eigenvalue) / (2 * np.pi), shape.reshape(-1, *line.beams.free.shape))
