"""Extrapolation of a value from three meshes, and its comparison with that of another formulation."""

import math
from dataclasses import dataclass

SAFETY_FACTOR = 1.25
"""Factor on the extrapolated error for an observed order of convergence (Roache 1998, ASME V&V 20)."""
TWO_MESH_FACTOR = 3.0
"""The same factor where no order is observed."""
ORDERS = (1.0, 4.0)
"""Observed orders of convergence that are used; outside of them the three meshes are not in the asymptotic range."""
AGREEMENT_PCT = 1.0
"""Largest difference of two formulations with which a value counts as confirmed [%]."""
FORMAL_ORDER = 2
"""Order of both formulations in the length of elements or distance of points, with the time step in proportion."""


@dataclass(frozen=True)
class Extrapolation:
    """Value for vanishing element length and time step."""

    value: float
    """Extrapolated value; the finest one where no order is observed."""
    half_width: float
    """Half-width of its interval."""
    order: float | None
    """Observed order of convergence; None if it is not observed."""


def extrapolate(values: tuple[float, float, float]) -> Extrapolation:
    """Extrapolate values of meshes whose steps are halved twice, with the grid convergence index (Roache 1998).

    Where no order is observed, the value is the finest one and the safety factor that for two meshes, with the formal
    order. A change that is small by chance does not narrow the interval below a quarter of the change before it.
    """
    first, second = values[1] - values[0], values[2] - values[1]
    order = math.log2(first / second) if second and first / second > 1 else math.nan
    if ORDERS[0] <= order <= ORDERS[1]:
        change = second / (2**order - 1)
        return Extrapolation(values[2] + change, SAFETY_FACTOR * abs(change), order)
    reduction = 2**FORMAL_ORDER
    half_width = TWO_MESH_FACTOR * max(abs(second), abs(first) / reduction) / (reduction - 1)
    return Extrapolation(values[2], half_width, None)


def extrapolate_pair(coarse: float, fine: float) -> float:
    """Extrapolate values of the second formulation at two spacings, the fine one half of the coarse one."""
    return fine + (fine - coarse) / (2**FORMAL_ORDER - 1)


def difference_pct(quantity: str, value: float, second: float, mean: float | None) -> float:
    """Difference of the second formulation from the reference simulator [%].

    Args:
        quantity: Name of the quantity.
        value, second: Extrapolated values of the reference simulator and of the second formulation.
        mean: Mean contact force [N], from which extremes are counted; None for a quantity of the line.
    """
    extreme = quantity.startswith(("statistical_", "max_force", "min_force"))
    return 100 * (second - value) / abs(value - (mean or 0.0) if extreme else value)
