"""Damping models fitted to measured damping ratios.

With C = sum over component kinds e of a_e K_e + b_e M_e, a mass-normalised mode phi_j has

    zeta_j = sum_e (a_e k_ej + b_e m_ej) / (2 w_j),    k_ej = phi_j' K_e phi_j,   m_ej = phi_j' M_e phi_j

which is linear in the coefficients; none of them is negative, so they follow from non-negative least squares.

References
----------
.. [1] O. Vo Van, E. Balmes, X. Lorang, Damping characterization of a high speed train catenary, IAVSD 2015.
   hdl:10985/10918
"""

from dataclasses import dataclass

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from pantocheck.conformance.array_types import IntegerArray, RealArray
from pantocheck.conformance.input_files.input_error import InputError

MODEL_ERROR = 0.01  # relative error of a computed damping ratio by the line model alone
FIT_REPLICATES = 400
WIRES = ("contact_wire", "messenger_wire")
MATRICES = ("stiffness", "mass")


@dataclass(frozen=True)
class ModalEnergies:
    """Energies of mass-normalised computed modes by kind of component.

    Parameters
    ----------
    frequency : (m,) ndarray
        [Hz].
    kinds : tuple[str, ...]
        (e,) component kinds.
    stiffness : (m, e) ndarray
        k_ej [1/s2].
    mass : (m, e) ndarray
        m_ej [-].
    """

    frequency: RealArray
    kinds: tuple[str, ...]
    stiffness: RealArray
    mass: RealArray

    def columns(self) -> tuple[tuple[tuple[str, str], ...], RealArray]:
        """Names (kind, matrix) and what a unit of each coefficient adds to every damping ratio, (m, 2 e)."""
        names = tuple((kind, matrix) for kind in self.kinds for matrix in MATRICES)
        both = np.stack([self.stiffness, self.mass], axis=2).reshape(self.frequency.size, -1)
        return names, np.asarray(both / (4 * np.pi * self.frequency[:, None]))


@dataclass(frozen=True)
class MeasuredMode:
    """Measured modes that have a computed counterpart, in the order of the energies.

    Parameters
    ----------
    frequency : (m,) ndarray
        [Hz].
    damping_ratio, std : (m,) ndarray
        And its standard deviation.
    group : (m,) ndarray
        Number of the group of span modes, 0 for none.
    """

    frequency: RealArray
    damping_ratio: RealArray
    std: RealArray
    group: IntegerArray


@dataclass(frozen=True)
class Coefficient:
    """One coefficient of the fit.

    Parameters
    ----------
    kind : str
        Component.
    matrix : str
        `stiffness` [s] or `mass` [1/s], which it multiplies.
    value : float
        Fitted.
    low, high : float
        95 % confidence interval.
    """

    kind: str
    matrix: str
    value: float
    low: float
    high: float


@dataclass(frozen=True)
class DampingFit:
    """Piecewise Rayleigh damping.

    Parameters
    ----------
    coefficients : tuple[Coefficient, ...]
        Of the kinds fitted.
    predicted : (m,) ndarray
        Damping ratios of the fit at the measured modes.
    used : (m,) ndarray
        Modes that entered; outliers of their group did not.
    residual : float
        Root mean square of (measured - predicted) / measured over the modes used.
    """

    coefficients: tuple[Coefficient, ...]
    predicted: RealArray
    used: NDArray[np.bool_]
    residual: float

    def value(self, kind: str, matrix: str) -> float:
        """A coefficient; 0 if it was not fitted."""
        return next((c.value for c in self.coefficients if (c.kind, c.matrix) == (kind, matrix)), 0.0)


def fit_damping_model(
    energies: ModalEnergies,
    measured: MeasuredMode,
    kinds: tuple[str, ...] = WIRES,
) -> DampingFit:
    """Coefficients of the chosen kinds by non-negative least squares.

    Every group of span modes weighs the same, whatever the number of its modes; a mode whose residual is far from the
    median of its group is left out. Within a group modes weigh by their uncertainty and that of the model.

    Parameters
    ----------
    energies : ModalEnergies
        Of the computed counterparts of the measured modes.
    measured : MeasuredMode
        The measured modes.
    kinds : tuple[str, ...]
        Component kinds to fit.

    Raises
    ------
    InputError
        Fewer modes than coefficients.
    """
    names, columns = energies.columns()
    chosen = [i for i, (kind, _) in enumerate(names) if kind in kinds]
    if measured.frequency.size <= len(chosen):
        raise InputError(
            "modes",
            f"{measured.frequency.size} modes for {len(chosen)} coefficients",
            "Identify more modes, or check that the line of the case is the one measured.",
        )
    target, std = measured.damping_ratio, fit_deviation(measured)
    used = np.ones(target.size, dtype=np.bool_)
    for _ in range(3):
        values = solve_weighted(columns[:, chosen], target, fit_weights(std, measured.group, used))
        used = _near_their_group(target - columns[:, chosen] @ values, std, measured.group)
    # The values are those of the modes said to be used.
    values = solve_weighted(columns[:, chosen], target, fit_weights(std, measured.group, used))
    predicted = columns[:, chosen] @ values
    low, high = _interval(columns[:, chosen], target, std, measured.std, measured.group, used)
    relative = (target - predicted) / target
    return DampingFit(
        tuple(
            Coefficient(*names[i], value=float(values[n]), low=float(low[n]), high=float(high[n]))
            for n, i in enumerate(chosen)
        ),
        predicted,
        used,
        float(np.sqrt(np.mean(relative[used] ** 2))),
    )


def fit_deviation(measured: MeasuredMode) -> RealArray:
    """Standard deviation of measured less computed damping ratios, (m,): that of the measurement and of the model."""
    return np.hypot(measured.std, MODEL_ERROR * measured.damping_ratio)


def fit_weights(std: RealArray, group: IntegerArray, used: NDArray[np.bool_]) -> RealArray:
    """Square roots of the weights: 1 / std, over the root of the number of modes used in the mode's group.

    Parameters
    ----------
    std : (m,) ndarray
        Standard deviation of each mode.
    group : (m,) ndarray
        Its group.
    used : (m,) ndarray
        Whether it enters; others have no weight.
    """
    count = np.array([max(int(np.sum(used & (group == number))), 1) for number in group])
    return np.where(used, 1 / (std * np.sqrt(count)), 0.0)


def solve_weighted(columns: RealArray, target: RealArray, weight: RealArray) -> RealArray:
    """Non-negative coefficients of weighted least squares, (e,).

    Parameters
    ----------
    columns : (m, e) ndarray
        What a unit of each coefficient adds to the target.
    target : ndarray
        (m,).
    weight : (m,) ndarray
        Square roots of the weights.
    """
    scale = np.maximum(np.linalg.norm(columns * weight[:, None], axis=0), np.finfo(float).tiny)
    solution, _ = scipy.optimize.nnls(columns * weight[:, None] / scale, target * weight)
    return np.asarray(solution / scale)


def _near_their_group(left: RealArray, std: RealArray, group: IntegerArray) -> NDArray[np.bool_]:
    keep = np.ones(left.size, dtype=np.bool_)
    for number in np.unique(group):
        members = np.flatnonzero(group == number)
        off = left[members] - np.median(left[members])
        spread = 1.4826 * np.median(np.abs(off))
        keep[members] = np.abs(off) <= 4 * np.hypot(std[members], spread)
    return keep


def _interval(
    columns: RealArray,
    target: RealArray,
    std: RealArray,
    noise: RealArray,
    group: IntegerArray,
    used: NDArray[np.bool_],
) -> tuple[RealArray, RealArray]:
    """2.5 and 97.5 percentiles over replicates: every group's modes drawn anew, and disturbed by their noise."""
    random = np.random.default_rng(20150817)
    numbers = [np.flatnonzero((group == number) & used) for number in np.unique(group)]
    numbers = [members for members in numbers if members.size]
    drawn = np.empty((FIT_REPLICATES, columns.shape[1]))
    for r in range(FIT_REPLICATES):
        rows = np.concatenate([random.choice(members, members.size) for members in numbers])
        noisy = target[rows] + noise[rows] * random.standard_normal(rows.size)
        everything = np.ones(rows.size, dtype=np.bool_)
        drawn[r] = solve_weighted(columns[rows], noisy, fit_weights(std[rows], group[rows], everything))
    return np.percentile(drawn, 2.5, axis=0), np.percentile(drawn, 97.5, axis=0)


@dataclass(frozen=True)
class FittedModalBand:
    """Damping ratio of one group: measured median over a band around it [Hz]."""

    low: float
    high: float
    damping_ratio: float


def fit_modal_bands(measured: MeasuredMode, last_group: int = 3) -> tuple[FittedModalBand, ...]:
    """Measured medians of the first groups, each over a band that ends half-way to the next group.

    Parameters
    ----------
    measured : MeasuredMode
        The measured modes.
    last_group : int
        Groups 1..last_group.
    """
    present = [number for number in range(1, last_group + 2) if np.any(measured.group == number)]
    edges = {
        n: (measured.frequency[measured.group == n].min(), measured.frequency[measured.group == n].max())
        for n in present
    }
    bands = []
    for number in (n for n in present if n <= last_group):
        low, high = edges[number]
        width = max(high - low, 0.05 * low)
        below = (edges[number - 1][1] + low) / 2 if number - 1 in edges else low - width / 2
        above = (high + edges[number + 1][0]) / 2 if number + 1 in edges else high + width / 2
        median = float(np.median(measured.damping_ratio[measured.group == number]))
        bands.append(FittedModalBand(float(below), float(above), median))
    return tuple(bands)


def add_modal_damping(frequency: RealArray, rayleigh: RealArray, bands: tuple[FittedModalBand, ...]) -> RealArray:
    """Damping ratios of Rayleigh + modal: the bands' own ratio inside them, Rayleigh elsewhere, (m,)."""
    ratio = rayleigh.copy()
    for band in bands:
        ratio[(frequency >= band.low) & (frequency < band.high)] = band.damping_ratio
    return ratio
