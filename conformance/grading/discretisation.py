"""Uncertainty from mesh and time step, by Richardson extrapolation and the grid convergence index.

Element length and time step are doubled and halved together, a refinement ratio of 2. With the values f_2 (doubled),
f_1 (of the case) and f_0 (halved), the observed order and the error of f_1 are

    p = log2((f_2 - f_1) / (f_1 - f_0)),    e = (f_1 - f_0) 2^p / (2^p - 1)

(Roache 1994, doi:10.1115/1.2910291; ASME V&V 20-2009; Eca and Hoekstra 2014, doi:10.1016/j.jcp.2014.01.006). The
half-width of the 95 % interval is the error times a safety factor. Without an observed order, the difference f_1 - f_0
is used. A quarter of f_2 - f_1, which predicts it at second order, replaces it where it is small by chance.
"""

import math

LOWEST_ORDER, HIGHEST_ORDER = 0.5, 4.0
"""Range of an observed order: below it, values hardly converge; above it, cubic elements do not converge."""

METHOD_ORDER = 2.0
"""Order of the time integration: a higher observed order is taken as this one (Eca and Hoekstra 2014)."""

SAFETY_FACTOR = 1.25
"""Safety factor where an order is observed (Roache 1994; Eca and Hoekstra 2014)."""

LARGE_SAFETY_FACTOR = 3.0
"""Safety factor on a difference of two meshes where no order is observed (Roache 1994; Eca and Hoekstra 2014)."""


def observed_order(coarse: float, value: float, fine: float) -> float | None:
    """Order of convergence of three values, each with half of the steps of the one before; None: no convergence.

    Args:
        coarse, value, fine: Values with steps doubled, as in the case, and halved.
    """
    first, second = coarse - value, value - fine
    return math.log2(first / second) if second and first / second > 0 else None


def discretisation_half_width(coarse: float | None, value: float, fine: float) -> float:
    """Half-width of the 95 % interval of a value from mesh and time step.

    Args:
        coarse: Value with element length and time step doubled; None if it is not known.
        value, fine: Value of the case, and with element length and time step halved.

    Returns:
        Richardson error times `SAFETY_FACTOR` where an order is observed, else a difference times
        `LARGE_SAFETY_FACTOR`.
    """
    if coarse is None:
        return LARGE_SAFETY_FACTOR * abs(value - fine)
    order = observed_order(coarse, value, fine)
    if order is not None and LOWEST_ORDER <= order <= HIGHEST_ORDER:
        growth = math.pow(2, min(order, METHOD_ORDER))
        return SAFETY_FACTOR * abs(value - fine) * growth / (growth - 1)
    return LARGE_SAFETY_FACTOR * max(abs(value - fine), abs(coarse - value) / 2**METHOD_ORDER)
