"""Modal damping of selected modes, in place of their Rayleigh damping.

C = C_R + M Phi diag(2 zeta_j w_j - phi_j' C_R phi_j) Phi' M   (Bianchi et al. 2010). The second term gives the selected
modes their damping ratios and does not change any other mode: exactly if C_R is diagonal in the modes, as with equal
coefficients of all components, otherwise to first order in the damping. It is a full matrix of low rank, never formed.
"""

from dataclasses import dataclass

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.catenary import ModalBand
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.modal.modes import compute_modes_below, free_vectors
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order


@dataclass(frozen=True)
class ModalTerms:
    """Low-rank part of the damping matrix: sum over the modes of damping times weight weight'."""

    damping: Array
    """2 zeta w minus the Rayleigh damping of the mode, (n,) [1/s]."""
    weight: Array
    """M phi, (n, rows, stations, 2) [kg^1/2]."""


def build_modal_terms(line: DiscretisedLine) -> ModalTerms:
    """Compute the low-rank part of the damping of a line; without modal damping its rank is zero."""
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
    return ModalTerms(np.array(damping), np.array(weight).reshape(-1, *line.beams.free.shape))


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
