"""Statistics of the contact force over the evaluated stretch."""

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered, NoMeanForce


def coefficient_of_variation(mean: float, deviation: float) -> float:
    """Standard deviation over mean force [-] (EN 50317 practice; Vo Van et al. 2015, Table 1).

    Raises
    ------
    NoMeanForce
        The mean is not positive.
    """
    if mean <= 0:
        raise NoMeanForce(f"the mean force is {mean:.4g} N: a variation relative to it means nothing")
    return deviation / mean


def statistical_extremes(mean: float, deviation: float) -> tuple[float, float]:
    """Statistical minimum and maximum, mean -+ 3 standard deviations [N]."""
    return mean - 3 * deviation, mean + 3 * deviation


def contact_loss(force: RealArray, filter_applied_Hz: float | None = None) -> float:
    """Share of samples without contact [%].

    Parameters
    ----------
    force : (n,) ndarray
        Unfiltered contact force over the evaluated stretch [N]; no contact is zero force.
    filter_applied_Hz : float or None
        Cut-off of a low-pass the force has been through [Hz]; None: unfiltered.

    Raises
    ------
    AlreadyFiltered
        a filter smears a loss of contact into a low force, so that none would be counted.
    """
    if filter_applied_Hz is not None:
        raise AlreadyFiltered(
            f"the force was delivered filtered at {filter_applied_Hz:g} Hz; "
            "losses of contact can only be counted in the unfiltered force"
        )
    return float(100 * np.count_nonzero(force <= 0) / force.size)


def force_histogram(force: RealArray, bins: int = 30) -> tuple[RealArray, RealArray]:
    """Edges of the classes [N] and share of the samples in each [%]; widths are 1, 2 or 5 times a power of ten."""
    spread = float(np.ptp(force))
    raw = max(spread, 1.0) / bins
    decade = 10 ** np.floor(np.log10(raw))
    width = decade * next(step for step in (1, 2, 5, 10) if step * decade >= raw * (1 - 1e-9))
    first, last = np.floor(force.min() / width), np.floor(force.max() / width) + 1
    edges = np.arange(first, last + 1) * width
    counts, _ = np.histogram(force, edges)
    return edges, 100 * counts / force.size
