"""Modal damping on chosen modes, the Rayleigh part compensated there.

C = C_R + M Phi diag(2 zeta_j w_j - phi_j' C_R phi_j) Phi' M   (Bianchi et al. 2010). The second term gives the chosen
modes exactly their ratios and leaves all others alone. As a matrix it is full, but low in rank: it is never formed.
"""

from dataclasses import dataclass

import numpy as np

from pantocheck.model.arrays import Array
from pantocheck.model.catenary import ModalBand
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.fem.assembly import assemble_matrices, bandwidth_order
from pantocheck.model.modal.modes import Modes, compute_modes


@dataclass(frozen=True)
class ModalTerms:
    """The low-rank part of the damping: sum over modes of damping times weight weight'.

    Parameters
    ----------
    damping : (n,) ndarray
        2 zeta w less what the Rayleigh part gives the mode [1/s].
    weight : (n, rows, stations, 2) ndarray
        M phi [kg^1/2].
    """

    damping: Array
    weight: Array


def build_modal_terms(line: DiscretisedLine) -> ModalTerms:
    """The low-rank part of a line's damping; of rank zero when the line asks for none.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.

    Returns
    -------
    ModalTerms
        The terms.
    """
    bands = line.catenary.modal_damping
    if not bands:
        return ModalTerms(np.zeros(0), np.zeros((0, *line.beams.free.shape)))
    matrices = assemble_matrices(line)
    shapes = modes_below(line, max(band.to_frequency for band in bands))
    place = bandwidth_order(line)[matrices.free]
    vectors = shapes.shape.reshape(len(shapes.frequency), -1)[:, place]
    damping, weight = [], []
    for frequency, vector in zip(shapes.frequency, vectors, strict=True):
        for band in bands:
            if band.from_frequency <= frequency < band.to_frequency:
                rayleigh = vector @ (matrices.damping @ vector)
                damping.append(4 * np.pi * band.damping_ratio * frequency - rayleigh)
                whole = np.zeros(line.beams.free.size)
                whole[place] = matrices.mass @ vector
                weight.append(whole.reshape(line.beams.free.shape))
    return ModalTerms(np.array(damping), np.array(weight).reshape(-1, *line.beams.free.shape))


def modes_below(line: DiscretisedLine, frequency: float) -> Modes:
    """All modes of a line below a frequency.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    frequency : float
        [Hz].

    Returns
    -------
    Modes
        The modes.
    """
    count, most = 16, assemble_matrices(line).free.size - 2
    while True:
        found = compute_modes(line, min(count, most))
        if found.frequency[-1] >= frequency or count >= most:
            inside = found.frequency < frequency
            return Modes(found.frequency[inside], found.shape[inside])
        count *= 2


def apply_modal_bands(ratios: Array, frequency: Array, bands: tuple[ModalBand, ...]) -> Array:
    """Damping ratios of Rayleigh plus modal damping: the ratio of the band inside a band, the Rayleigh ratio elsewhere.

    Parameters
    ----------
    ratios : (n,) ndarray
        Damping ratios of Rayleigh damping [-].
    frequency : (n,) ndarray
        Natural frequencies of the modes [Hz].
    bands : tuple of ModalBand
        Bands of the modal damping.
    """
    combined = ratios.copy()
    for band in bands:
        combined[(frequency >= band.from_frequency) & (frequency < band.to_frequency)] = band.damping_ratio
    return combined
