"""Modes of the line about its initial state, every dropper taut."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.catenary import Kind, Rayleigh
from pantocheck.model.description.one_thread import use_one_thread
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, with_damping
from pantocheck.model.fem import beam
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
    return build_line_modes(line, w2[ascending], _normalise_sign(vectors[:, ascending].T))


def build_line_modes(line: DiscretisedLine, eigenvalue: Array, vectors: Array) -> Modes:
    """Modes by their squared angular frequencies, (n,) [1/s2], and vectors of the free unknowns, (n, unknowns)."""
    shape = np.zeros((len(vectors), line.beams.free.size))
    shape[:, bandwidth_order(line)[free_unknowns(line)]] = vectors
    return Modes(np.sqrt(eigenvalue) / (2 * np.pi), shape.reshape(-1, *line.beams.free.shape))


def compute_modes_below(line: DiscretisedLine, frequency: float) -> Modes:
    """Compute all modes of a line below a frequency [Hz]."""
    matrices, largest = assemble_matrices(line), free_unknowns(line).size - 2
    shifted = matrices.stiffness - (2 * np.pi * frequency) ** 2 * matrices.mass
    # As many pivots are negative as modes lie below (Sylvester's law of inertia); the next mode proves the number.
    factors = splu(shifted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    count = int(np.sum(factors.U.diagonal() < 0)) + 1
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
    """Shapes whose first large entry is positive: rounding alone makes one of two equal entries the largest."""
    size = np.abs(vectors)
    first = (size > (1 - 1e-6) * size.max(axis=1, keepdims=True)).argmax(axis=1)
    return np.asarray(vectors * np.sign(np.take_along_axis(vectors, first[:, None], axis=1)))


def deflection_at(line: DiscretisedLine, modes: Modes, row: int, position: float) -> Array:
    """Deflection of every mode at a station [m] of one row, (n,) [kg^-1/2]."""
    return np.asarray(modes.shape[:, row, line.mesh.station(position), 0])


def component_energies(line: DiscretisedLine, modes: Modes) -> ComponentEnergies:
    """Compute the share of every kind of component in the energies of the modes.

    Returns:
        Energies. The damping C = sum of a_e K_e + b_e M_e gives mode j the ratio sum (a_e k_ej + b_e m_ej) / (2 w_j).
    """
    kinds = tuple(Kind)
    # With one coefficient set to one, the damping matrix is the stiffness or the mass of that component.
    units = [
        {kind: unit} for unit in (Rayleigh(stiffness_coefficient=1.0), Rayleigh(mass_coefficient=1.0)) for kind in kinds
    ]
    constant, *forms = damping_forms([with_damping(line, damping) for damping in ({}, *units)], modes.shape)
    return ComponentEnergies(kinds, *((np.array(forms) - constant).reshape(2, len(kinds), -1).transpose(0, 2, 1)))


def damping_forms(lines: Sequence[DiscretisedLine], shape: Array) -> Array:
    """Products phi' C phi of shapes, (n, rows, stations, 2), with the damping of lines.

    Args:
        lines: Lines that differ in their damping alone.
        shape: Shapes of such a line.

    Returns:
        Products, (lines, n).
    """
    beams, connectors = lines[0].beams, lines[0].connectors
    ends = np.concatenate([shape[:, :, :-1], shape[:, :, 1:]], axis=-1).transpose(1, 2, 0, 3)
    elements = (
        beam.stiffness(beams.length, beams.tension, beams.bending_stiffness),
        beam.mass(beams.length, beams.mass_per_length),
    )
    stiffness, mass = (np.einsum("rena,rena->rn", ends @ matrices, ends) for matrices in elements)
    deflection = shape[..., 0] ** 2
    elongation = np.einsum("cr,nrc->cn", connectors.coefficient, shape[:, :, connectors.station, 0]) ** 2
    return np.array(
        [
            line.beams.stiffness_coefficient @ stiffness
            + line.beams.mass_coefficient @ mass
            + np.tensordot(line.beams.lumped_damping, deflection, ((0, 1), (1, 2)))
            + line.connectors.damping @ elongation
            for line in lines
        ]
    )


def damping_ratios(line: DiscretisedLine, modes: Modes) -> Array:
    """Damping ratio of every mode, phi' C phi / (2 w), without the coupling of modes through the damping.

    Args:
        line: Discretised line with its damping.
        modes: Modes of the line.

    Returns:
        Damping ratios, (n,) [-].
    """
    return np.asarray(damping_forms([line], modes.shape)[0] / (4 * np.pi * modes.frequency))
