"""SALib: Sobol indices of the function of Ishigami and Homma."""

import numpy as np
from scipy.stats import qmc

from pantocheck.conformance.campaigns.sample_statistics import estimate_sobol_indices
from pantocheck.conformance.core.array_types import RealArray
from verification.guide.comparisons import compare_absolute
from verification.guide.guide_format import CheckedValue

DESIGNS = 1024
INDEX_TOLERANCE = 1e-6
"""Largest difference of an index: both centre the values with slightly different means."""


def evaluate_ishigami(x: RealArray) -> RealArray:
    """Values sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 of designs (..., 3) (Ishigami and Homma 1990)."""
    return np.asarray(np.sin(x[..., 0]) + 7 * np.sin(x[..., 1]) ** 2 + 0.1 * x[..., 2] ** 4 * np.sin(x[..., 0]))


def compare_indices() -> list[CheckedValue]:
    """Indices of first order and total indices beside those of SALib, from the same designs."""
    from SALib.analyze import sobol

    points = np.pi * (2 * qmc.Sobol(6, scramble=True, rng=1).random(DESIGNS) - 1)
    first_set, second_set = points[:, :3], points[:, 3:]
    exchanged = np.stack([first_set] * 3, axis=1)
    for i in range(3):
        exchanged[:, i, i] = second_set[:, i]
    values = (evaluate_ishigami(first_set), evaluate_ishigami(second_set), evaluate_ishigami(exchanged))
    shares = estimate_sobol_indices(*values)
    problem = {"num_vars": 3, "names": ["x1", "x2", "x3"], "bounds": [[-np.pi, np.pi]] * 3}
    ordered = np.column_stack([values[0], values[2], values[1]]).ravel()
    theirs = sobol.analyze(problem, ordered, calc_second_order=False, num_resamples=100, seed=1)
    reason = "The same estimators (Saltelli et al. 2010, Jansen 1999) on the same designs."
    rows = []
    for kind, ours, key in (("first-order", shares.first[0], "S1"), ("total", shares.total[0], "ST")):
        rows += [
            compare_absolute(f"{kind}-{i + 1}", f"{kind} index of x{i + 1}", "-", pair, INDEX_TOLERANCE, reason)
            for i, pair in enumerate(zip(ours, theirs[key], strict=True))
        ]
    return rows
