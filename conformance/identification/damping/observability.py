"""Which damping coefficients the measured modes can tell at all."""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.damping.damping_model import (
    DampingFit,
    MeasuredMode,
    ModalEnergies,
    fit_deviation,
    fit_weights,
    solve_weighted,
)

PLAUSIBLE = {"stiffness": 1e-4, "mass": 0.1}  # [s], [1/s]: largest values the study finds for a wire
SHARE_NEEDED = 0.05  # of a mode's damping, at the plausible value
RATIO_NEEDED = 3.0  # plausible value over standard deviation


@dataclass(frozen=True)
class Observability:
    """What the modes say of one coefficient.

    Parameters
    ----------
    kind, matrix : str
        Which.
    share : float
        Largest share that the plausible value would have in any mode's damping ratio.
    inflation : float
        Variance inflation by the likeness to all others that act at all, 1 / (1 - R^2).
    std : float
        Smallest standard deviation with the other wires' coefficients unknown too [s] or [1/s].
    growth : float
        Factor on the fit's residual when the coefficient is left out; 1 if it is not fitted.
    observable : bool
        Whether the plausible value could be seen.
    """

    kind: str
    matrix: str
    share: float
    inflation: float
    std: float
    growth: float
    observable: bool


def compute_observability(
    energies: ModalEnergies, measured: MeasuredMode, fit: DampingFit
) -> tuple[Observability, ...]:
    """Observability of the stiffness and mass coefficient of every kind of component.

    Parameters
    ----------
    energies, measured : ModalEnergies or MeasuredMode
        As for `fit_damping`.
    fit : DampingFit
        With all fitted kinds.
    """
    names, columns = energies.columns()
    weighted = columns / fit_deviation(measured)[:, None]
    fitted = {(c.kind, c.matrix) for c in fit.coefficients}
    found = []
    for i, (kind, matrix) in enumerate(names):
        plausible = PLAUSIBLE[matrix]
        share = float(np.max(plausible * columns[:, i] / measured.damping_ratio, initial=0.0))
        others = [j for j, name in enumerate(names) if j != i and name in fitted]
        length = float(np.sum(weighted[:, i] ** 2))
        left = weighted[:, i] - _projected(weighted[:, others], weighted[:, i])
        remaining = float(np.sum(left**2))
        if length == 0.0 or remaining <= 1e-12 * length:
            std, inflation = float("inf"), float("inf")
        else:
            std, inflation = 1 / float(np.sqrt(remaining)), length / remaining
        growth = (
            residual_without_column(energies, measured, fit, (kind, matrix)) / max(fit.residual, np.finfo(float).tiny)
            if (kind, matrix) in fitted
            else 1.0
        )
        seen = share >= SHARE_NEEDED and plausible >= RATIO_NEEDED * std
        found.append(Observability(kind, matrix, share, inflation, std, float(growth), seen))
    return tuple(found)


def residual_without_column(
    energies: ModalEnergies, measured: MeasuredMode, fit: DampingFit, left_out: tuple[str, str]
) -> float:
    """Root mean square of the relative residual of a fit without one coefficient, over the modes used."""
    names, columns = energies.columns()
    kept = [names.index((c.kind, c.matrix)) for c in fit.coefficients if (c.kind, c.matrix) != left_out]
    target, weight = measured.damping_ratio, fit_weights(fit_deviation(measured), measured.group, fit.used)
    relative = (target - columns[:, kept] @ solve_weighted(columns[:, kept], target, weight)) / target
    return float(np.sqrt(np.mean(relative[fit.used] ** 2)))


def _projected(columns: RealArray, vector: RealArray) -> RealArray:
    if columns.shape[1] == 0:
        return np.zeros_like(vector)
    q = np.linalg.qr(columns / np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny))[0]
    return np.asarray(q @ (q.T @ vector))
