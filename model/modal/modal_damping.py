"""Modal damping of selected modes, in place of their Rayleigh damping.

C = C_R + M Phi diag(2 zeta_j w_j - phi_j' C_R phi_j) Phi' M   (Bianchi et al. 2010). The second term gives the selected
modes their damping ratios and does not change any other mode: exactly if C_R is diagonal in the modes, as with equal
coefficients of all components, otherwise to first order in the damping. It is a full matrix of low rank, never formed.

A ratio below that of the Rayleigh damping makes its term negative. C can then be indefinite, if the components have
other coefficients: such a line is refused.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.catenary import ModalBand
from pantocheck.model.description.failures import NegativeDamping
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.modal.modes import compute_modes_below, free_vectors
from pantocheck.model.statics.assembly import GlobalMatrices, assemble_matrices, bandwidth_order


@dataclass(frozen=True)
class ModalTerms:
    """Low-rank part of the damping matrix: sum over the modes of damping times weight weight'."""

    damping: Array
    """2 zeta w minus the Rayleigh damping of the mode, (n,) [1/s]."""
    weight: Array
    """M phi, (n, rows, stations, 2) [kg^1/2]."""


def build_modal_terms(line: DiscretisedLine) -> ModalTerms:
    """Compute the low-rank part of the damping of a line; without modal damping its rank is zero.

    Raises:
        NegativeDamping: The damping matrix would be negative.
    """
    bands = line.catenary.modal_damping
    if not bands:
        return ModalTerms(np.zeros(0), np.zeros((0, *line.beams.free.shape)))
    matrices = assemble_matrices(line)
    modes = compute_modes_below(line, max(band.to_frequency for band in bands))
    order = bandwidth_order(line)[matrices.free]
    damping, weight = [], []
    for frequency, vector in zip(modes.frequency, free_vectors(line, modes), strict=True):
        for band in bands:
            if band.from_frequency <= frequency < band.to_frequency:
                rayleigh = vector @ (matrices.damping @ vector)
                damping.append(4 * np.pi * band.damping_ratio * frequency - rayleigh)
                momentum = np.zeros(line.beams.free.size)
                momentum[order] = matrices.mass @ vector
                weight.append(momentum.reshape(line.beams.free.shape))
    terms = ModalTerms(np.array(damping), np.array(weight).reshape(-1, *line.beams.free.shape))
    _check_positive(matrices, terms.damping, terms.weight.reshape(len(damping), -1)[:, order])
    return terms


LARGEST_GROWTH_1_S = 1e-3
"""Rate [1/s] by which a damping matrix may be negative: a motion that grows by 0.05 % per second."""


def _check_positive(matrices: GlobalMatrices, damping: Array, weight: Array) -> None:
    """Refuse negative terms that make the whole damping matrix negative.

    C_R + e M - W W' is positive if and only if 1 - W' (C_R + e M)^-1 W is. Positive terms are left out: a line that
    needs them beside negative ones is refused, too.

    Args:
        matrices: Matrices of the line; their damping is C_R.
        damping: Damping of each term, (n,) [1/s].
        weight: M phi of the free unknowns, (n, unknowns) [kg^1/2].

    Raises:
        NegativeDamping: A motion would grow.
    """
    negative = damping < 0
    if not negative.any():
        return
    taken = weight[negative] * np.sqrt(-damping[negative])[:, None]
    rest = splu(csc_matrix(matrices.damping + LARGEST_GROWTH_1_S * matrices.mass)).solve(taken.T)
    if np.linalg.eigvalsh(np.eye(taken.shape[0]) - taken @ rest)[0] < 0:
        raise NegativeDamping(
            "damping.modal: some motion would grow, because a ratio is smaller than that of the components, and these "
            "have other coefficients. Give a higher ratio, or wires with similar coefficients."
        )


def apply_modal_bands(ratios: Array, frequency: Array, bands: tuple[ModalBand, ...]) -> Array:
    """Damping ratios of Rayleigh plus modal damping: the ratio of the band inside a band, the Rayleigh ratio elsewhere.

    Args:
        ratios: Damping ratios of Rayleigh damping, (n,) [-].
        frequency: Natural frequencies of the modes, (n,) [Hz].
        bands: Bands of the modal damping.

    Returns:
        Damping ratios, (n,) [-].
    """
    combined = ratios.copy()
    for band in bands:
        combined[(frequency >= band.from_frequency) & (frequency < band.to_frequency)] = band.damping_ratio
    return combined
