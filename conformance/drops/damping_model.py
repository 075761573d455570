"""Piecewise Rayleigh damping, one coefficient per kind of component and matrix, and its fit to measured damping ratios.

With C = sum over kinds e of a_e K_e + b_e M_e, a mass-normalised mode phi_j has the damping ratio

    zeta_j = sum_e (a_e k_ej + b_e m_ej) / (2 w_j),    k_ej = phi_j' K_e phi_j,   m_ej = phi_j' M_e phi_j

The fit is a non-negative least-squares problem. The damping of all components but the wires is that of the line; its
share of the measured ratios is subtracted.

References:
    [1] O. Vo Van, E. Balmes, X. Lorang, Damping characterization of a high speed train catenary, IAVSD 2015.
        hdl:10985/10918
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.elements.damping import DAMPING_KEYS
from pantocheck.conformance.results.damping_format import Coefficient, Matching, Observability, Thresholds
from pantocheck.model import Catenary, Kind, Rayleigh
from pantocheck.model.description.catenary import ModalBand
from pantocheck.model.description.one_thread import use_one_thread
from pantocheck.model.modal.modes import ComponentEnergies

Term = tuple[str, str]
"""Kind of component, and name of the matrix of the coefficient."""


@dataclass(frozen=True)
class DampingMatrix:
    """Matrix of a Rayleigh coefficient: key in a line file, unit, and plausible value of the coefficient."""

    key: str
    unit: str
    plausible: float


MATRICES = {
    "stiffness": DampingMatrix("stiffness_coefficient_s", "s", 1e-4),
    "mass": DampingMatrix("mass_coefficient_1_s", "1/s", 0.1),
}
"""Matrices by name, in the order of the terms; plausible values are the largest in Vo Van, Balmes, Lorang 2015."""

TABLE_OF_KIND = DAMPING_KEYS | {Kind.MESSENGER_SUPPORT: "messenger_supports"}
"""Table of a kind of component in the damping of a line file."""


WIRES: tuple[str, ...] = (Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE)
"""Kinds of component that are fitted."""

JOINED_WIRES = "wires"
"""Name of the wires with common coefficients."""


def list_other_damping(line: Catenary) -> dict[Kind, Rayleigh]:
    """Rayleigh damping that a line states for the components that are not fitted."""
    return {kind: line.rayleigh(kind) for kind in Kind if kind not in WIRES}


@dataclass(frozen=True)
class DampingBasis:
    """Damping ratios of the modes per unit of each coefficient."""

    terms: tuple[Term, ...]
    """Kind and matrix of each of the t coefficients."""
    ratios: RealArray
    """Damping ratio per unit of the coefficient [1/s] for stiffness, [s] for mass, (m, t)."""
    stated: RealArray
    """Damping ratio by the components that are not fitted, whose damping the line states, (m,) [-]."""

    def select_modes(self, modes: IntegerArray) -> "DampingBasis":
        """Basis of selected modes, by index."""
        return DampingBasis(self.terms, self.ratios[modes], self.stated[modes])

    def predict(self, values: Mapping[Term, float]) -> RealArray:
        """Damping ratios for coefficients by term, (m,); a coefficient that is not named is 0."""
        return np.asarray(self.stated + self.ratios @ np.array([values.get(term, 0.0) for term in self.terms]))

    def join_wires(self) -> "DampingBasis":
        """Basis in which the wires of `WIRES` share their coefficients, as terms of the kind `JOINED_WIRES`."""
        others = [i for i, (kind, _) in enumerate(self.terms) if kind not in WIRES]
        shared = [
            self.ratios[:, [self.terms.index((wire, matrix)) for wire in WIRES]].sum(axis=1) for matrix in MATRICES
        ]
        terms = (*((JOINED_WIRES, matrix) for matrix in MATRICES), *(self.terms[i] for i in others))
        return DampingBasis(terms, np.column_stack([*shared, self.ratios[:, others]]), self.stated)


def build_damping_basis(frequency: RealArray, energies: ComponentEnergies, stated: RealArray) -> DampingBasis:
    """Build the basis from the frequencies [Hz], the energies and the stated damping ratios of the modes."""
    terms = tuple((str(kind), matrix) for kind in energies.kinds for matrix in MATRICES)
    both = np.stack([energies.stiffness, energies.mass], axis=2).reshape(frequency.size, -1)
    return DampingBasis(terms, np.asarray(both / (4 * np.pi * frequency[:, None])), stated)


# Fit to measured damping ratios.
MODEL_ERROR = 0.01
"""Relative error of a computed damping ratio that is due to the line model [-]."""

MODAL_GROUPS = 2
"""Groups of span modes with a band of modal damping, as in Vo Van, Balmes and Lorang (2015), section 3."""


@dataclass(frozen=True)
class MeasuredModes:
    """The m measured modes with a computed counterpart."""

    frequency: RealArray
    """Frequency, (m,) [Hz]."""
    damping_ratio: RealArray
    std: RealArray
    """Damping ratio and its standard deviation, (m,) [-]."""
    group: IntegerArray
    """Number of the group of span modes, (m,); 0: none."""

    def select(self, modes: IntegerArray) -> "MeasuredModes":
        """Selected modes, by index."""
        return MeasuredModes(self.frequency[modes], self.damping_ratio[modes], self.std[modes], self.group[modes])


@dataclass(frozen=True)
class DampingFit:
    """Fitted piecewise Rayleigh damping."""

    coefficients: tuple[Coefficient, ...]
    """Fitted coefficients."""
    predicted: RealArray
    """Damping ratios of the fit at the measured modes, (m,) [-]."""
    used: NDArray[np.bool_]
    """Mask of the modes in the fit, (m,); outliers of their group are left out."""
    residual: float
    """Root mean square of (measured - predicted) / measured over the modes in the fit [-]."""

    @property
    def values(self) -> dict[Term, float]:
        """Fitted coefficients by term."""
        return {(c.kind, c.matrix): c.value for c in self.coefficients}


@use_one_thread
def fit_damping_model(basis: DampingBasis, measured: MeasuredModes) -> DampingFit:
    """Fit the coefficients of the wires by non-negative least squares.

    All groups of span modes have the same weight, whatever their number of modes. Within a group, the weight of a mode
    follows from its uncertainty and that of the line model. Modes with a residual far from the median of their group
    are left out.

    Args:
        basis: Damping ratios of the computed counterparts of the measured modes per unit of each coefficient.
        measured: The measured modes.

    Raises:
        InputError: There are not more modes than coefficients.
    """
    terms = [term for term in basis.terms if term[0] in (*WIRES, JOINED_WIRES)]
    refuse_few_modes(measured.frequency.size, len(terms))
    columns = basis.ratios[:, [basis.terms.index(term) for term in terms]]
    target, std = measured.damping_ratio - basis.stated, ratio_deviation(measured)
    used = np.ones(target.size, dtype=np.bool_)
    for _ in range(3):
        values = solve_weighted(columns, target, mode_weights(std, measured.group, used))
        used = near_their_group(target - columns @ values, std, measured.group)
    # The last fit uses the final set of modes.
    values = solve_weighted(columns, target, mode_weights(std, measured.group, used))
    predicted = basis.stated + columns @ values
    low_95, high_95 = _confidence_intervals(columns, values, target - columns @ values, measured, used)
    relative = (measured.damping_ratio - predicted) / measured.damping_ratio
    coefficients = tuple(
        Coefficient(kind=kind, matrix=matrix, value=float(value), low_95=float(lower), high_95=float(upper))
        for (kind, matrix), value, lower, upper in zip(terms, values, low_95, high_95, strict=True)
    )
    return DampingFit(coefficients, predicted, used, float(np.sqrt(np.mean(relative[used] ** 2))))


def refuse_few_modes(modes: int, coefficients: int) -> None:
    """Refuse a fit with no more modes than coefficients.

    Raises:
        InputError: There are too few modes.
    """
    if modes <= coefficients:
        raise InputError(
            "modes",
            f"only {modes} modes for a fit of {coefficients} coefficients",
            f"Identify at least {coefficients + 1} modes whose half-power bands overlap no other mode, or name the "
            "line of the record with --line.",
        )


def ratio_deviation(measured: MeasuredModes) -> RealArray:
    """Standard deviation of measured minus computed damping ratios, (m,), due to measurement and line model [-]."""
    return np.hypot(measured.std, MODEL_ERROR * measured.damping_ratio)


def mode_weights(std: RealArray, group: IntegerArray, used: NDArray[np.bool_]) -> RealArray:
    """Square roots of the weights of the modes, (m,): 1 / (std sqrt(n)) with n used modes in the group.

    Modes that are not used have the weight 0.
    """
    count = np.array([max(int(np.sum(used & (group == number))), 1) for number in group])
    return np.where(used, 1 / (std * np.sqrt(count)), 0.0)


def solve_weighted(columns: RealArray, target: RealArray, weight: RealArray) -> RealArray:
    """Non-negative least-squares coefficients, (t,), of columns (m, t); `weight` is the square root of the weights."""
    scale = np.maximum(np.linalg.norm(columns * weight[:, None], axis=0), np.finfo(float).tiny)
    solution, _ = scipy.optimize.nnls(columns * weight[:, None] / scale, target * weight)
    return np.asarray(solution / scale)


def near_their_group(residual: RealArray, std: RealArray, group: IntegerArray) -> NDArray[np.bool_]:
    near = np.ones(residual.size, dtype=np.bool_)
    for number in np.unique(group):
        members = np.flatnonzero(group == number)
        distance = residual[members] - np.median(residual[members])
        spread = 1.4826 * np.median(np.abs(distance))
        near[members] = np.abs(distance) <= 4 * np.hypot(std[members], spread)
    return near


def _confidence_intervals(
    columns: RealArray, values: RealArray, residual: RealArray, measured: MeasuredModes, used: NDArray[np.bool_]
) -> tuple[RealArray, RealArray]:
    """95 % intervals of weighted least squares on one line, with the scatter that the residuals show."""
    std = ratio_deviation(measured)
    weight = mode_weights(std, measured.group, used)
    freedom = max(int(used.sum()) - columns.shape[1], 1)
    found = std * np.sqrt(np.sum((residual[used] / std[used]) ** 2) / freedom)
    scale = np.maximum(np.linalg.norm(columns * weight[:, None], axis=0), np.finfo(float).tiny)
    gain = np.linalg.pinv(columns * weight[:, None] / scale) * weight * np.maximum(found, measured.std) / scale[:, None]
    width = scipy.special.stdtrit(freedom, 0.975) * np.sqrt(np.sum(gain**2, axis=1))
    return np.maximum(values - width, 0.0), values + width


def fit_modal_bands(measured: MeasuredModes, groups: int = MODAL_GROUPS) -> tuple[ModalBand, ...]:
    """Median measured damping ratios of the first groups, each in a band that ends half-way to the next group.

    A group without modes has no band; the bands ascend.
    """
    present = [number for number in range(1, groups + 2) if np.any(measured.group == number)]
    edges = {
        n: (measured.frequency[measured.group == n].min(), measured.frequency[measured.group == n].max())
        for n in present
    }
    bands = []
    for number in (n for n in present if n <= groups):
        low, high = edges[number]
        width = max(high - low, 0.05 * low)
        below = (edges[number - 1][1] + low) / 2 if number - 1 in edges else low - width / 2
        above = (high + edges[number + 1][0]) / 2 if number + 1 in edges else high + width / 2
        median = float(np.median(measured.damping_ratio[measured.group == number]))
        bands.append(ModalBand(float(below), float(above), median))
    return tuple(bands)


# Observability of the coefficients of a damping model in the measured modes.
THRESHOLDS = Thresholds(largest_share=0.05, plausible_over_std=3.0, matched_share=0.8, median_mac=0.9)
"""Lower limits for an observable coefficient (the first two) and for a determined coefficient (all).

The record T1 has the matched share 1.0 and the median MAC 0.998 on its line, and 0.58 and 0.82 on a line with other
spans.
"""


def compute_observability(basis: DampingBasis, measured: MeasuredModes, fit: DampingFit) -> tuple[Observability, ...]:
    """Compute the observability of each coefficient; parameters as in `fit_damping_model`, and its result `fit`.

    If the model misfits the damping ratios by more than their standard deviations, the misfit takes their place: it
    could otherwise pass for information on the coefficients.
    """
    std = ratio_deviation(measured)
    misfit = float(np.sqrt(np.mean(((measured.damping_ratio - fit.predicted) / std)[fit.used] ** 2)))
    weighted = basis.ratios / (max(1.0, misfit) * std)[:, None]
    rows = []
    for i, (kind, matrix) in enumerate(basis.terms):
        plausible = MATRICES[matrix].plausible
        share = float(np.max(plausible * basis.ratios[:, i] / measured.damping_ratio, initial=0.0))
        others = [j for j, term in enumerate(basis.terms) if j != i and term in fit.values]
        length = float(np.sum(weighted[:, i] ** 2))
        remaining = float(np.sum((weighted[:, i] - _project(weighted[:, others], weighted[:, i])) ** 2))
        determined = length > 0.0 and remaining > 1e-12 * length
        deviation = 1 / float(np.sqrt(remaining)) if determined else None
        growth = 1.0
        if (kind, matrix) in fit.values:
            without = residual_without_term(basis, measured, fit, (kind, matrix))
            growth = without / max(fit.residual, np.finfo(float).tiny)
        rows.append(
            Observability(
                kind=kind,
                matrix=matrix,
                largest_share=share,
                variance_inflation=length / remaining if determined else None,
                std=deviation,
                plausible=plausible,
                plausible_over_std=0.0 if deviation is None else plausible / deviation,
                residual_without=growth,
                observable=share >= THRESHOLDS.largest_share
                and deviation is not None
                and plausible >= THRESHOLDS.plausible_over_std * deviation,
            )
        )
    return tuple(rows)


def judge_coefficients(
    coefficients: Sequence[Coefficient], observability: Sequence[Observability], matching: Matching
) -> tuple[Coefficient, ...]:
    """Mark each coefficient as determined, or state the thresholds that are not reached."""
    common = []
    if matching.matched_share < THRESHOLDS.matched_share:
        common.append(
            f"{matching.matched} of {matching.modes} modes are matched, needed are {100 * THRESHOLDS.matched_share:g} %"
        )
    if matching.median_mac is None:
        common.append("the modes have a single sensor, so that no shapes can be compared")
    elif matching.median_mac < THRESHOLDS.median_mac:
        common.append(f"the median MAC is {matching.median_mac:.2g}, needed is {THRESHOLDS.median_mac:g}")
    observable = {(row.kind, row.matrix) for row in observability if row.observable}
    judged = []
    for c in coefficients:
        reasons = common if (c.kind, c.matrix) in observable else [*common, "it is not observable in the modes"]
        judged.append(c.model_copy(update={"determined": not reasons, "reason": "; ".join(reasons)}))
    return tuple(judged)


def residual_without_term(basis: DampingBasis, measured: MeasuredModes, fit: DampingFit, left_out: Term) -> float:
    """Root mean square of the relative residual of a fit without one coefficient, over the modes in the fit [-]."""
    kept = [basis.terms.index(term) for term in fit.values if term != left_out]
    target = measured.damping_ratio - basis.stated
    weight = mode_weights(ratio_deviation(measured), measured.group, fit.used)
    values = solve_weighted(basis.ratios[:, kept], target, weight)
    relative = (target - basis.ratios[:, kept] @ values) / measured.damping_ratio
    return float(np.sqrt(np.mean(relative[fit.used] ** 2)))


def _project(columns: RealArray, vector: RealArray) -> RealArray:
    """Projection of a vector on the span of the columns."""
    if columns.shape[1] == 0:
        return np.zeros_like(vector)
    q = np.linalg.qr(columns)[0]
    return np.asarray(q @ (q.T @ vector))
