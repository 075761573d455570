"""Observability of the coefficients of a damping model in the measured modes."""

from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.damping.damping_format import (
    Coefficient,
    Matching,
    Observability,
    Thresholds,
)
from pantocheck.conformance.identification.damping.damping_model import (
    DampingFit,
    MeasuredModes,
    fit_deviation,
    fit_weights,
    solve_weighted,
)
from pantocheck.conformance.identification.damping.damping_terms import MATRICES, DampingBasis, Term

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
    weighted = basis.ratios / (_misfit(measured, fit) * fit_deviation(measured))[:, None]
    rows = []
    for i, (kind, matrix) in enumerate(basis.terms):
        plausible = MATRICES[matrix].plausible
        share = float(np.max(plausible * basis.ratios[:, i] / measured.damping_ratio, initial=0.0))
        others = [j for j, term in enumerate(basis.terms) if j != i and term in fit.values]
        length = float(np.sum(weighted[:, i] ** 2))
        remaining = float(np.sum((weighted[:, i] - _project(weighted[:, others], weighted[:, i])) ** 2))
        determined = length > 0.0 and remaining > 1e-12 * length
        std = 1 / float(np.sqrt(remaining)) if determined else None
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
                std=std,
                plausible=plausible,
                plausible_over_std=0.0 if std is None else plausible / std,
                residual_without=growth,
                observable=share >= THRESHOLDS.largest_share
                and std is not None
                and plausible >= THRESHOLDS.plausible_over_std * std,
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
    target, weight = (
        measured.damping_ratio - basis.stated,
        fit_weights(fit_deviation(measured), measured.group, fit.used),
    )
    values = solve_weighted(basis.ratios[:, kept], target, weight)
    relative = (target - basis.ratios[:, kept] @ values) / measured.damping_ratio
    return float(np.sqrt(np.mean(relative[fit.used] ** 2)))


def _misfit(measured: MeasuredModes, fit: DampingFit) -> float:
    """Root mean square of (measured - fitted) / standard deviation over the modes in the fit, at least 1 [-]."""
    residual = (measured.damping_ratio - fit.predicted) / fit_deviation(measured)
    return max(1.0, float(np.sqrt(np.mean(residual[fit.used] ** 2))))


def _project(columns: RealArray, vector: RealArray) -> RealArray:
    """Projection of a vector on the span of the columns."""
    if columns.shape[1] == 0:
        return np.zeros_like(vector)
    q = np.linalg.qr(columns)[0]
    return np.asarray(q @ (q.T @ vector))
