"""Comparison of computed with expected values, and orders of convergence."""

from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from verification.guide.guide_format import CheckedValue, ConvergenceStudy


def compare_relative(
    key: str, quantity: str, unit: str, values: tuple[float, float], tolerance: float, reason: str
) -> CheckedValue:
    """Compare a value with an expected one; the deviation is relative to the expected value.

    Args:
        key, quantity, unit: Name within the topic, words and unit.
        values: Computed and expected value.
        tolerance: Largest relative deviation.
        reason: Reason of the tolerance.
    """
    return _compare(key, quantity, unit, values, tolerance, reason, abs(float(values[1])))


def compare_absolute(
    key: str, quantity: str, unit: str, values: tuple[float, float], tolerance: float, reason: str
) -> CheckedValue:
    """Compare a value with an expected one; parameters as in `compare_relative`, the deviation in the unit."""
    return _compare(key, quantity, unit, values, tolerance, reason, None)


def _compare(
    key: str, quantity: str, unit: str, values: tuple[float, float], tolerance: float, reason: str, scale: float | None
) -> CheckedValue:
    computed, expected = map(float, values)
    deviation = (computed - expected) / (1.0 if scale is None else scale)
    return CheckedValue(
        key=key,
        quantity=quantity,
        unit=unit,
        computed=computed,
        expected=expected,
        kind="absolute" if scale is None else "relative",
        deviation=deviation,
        tolerance=tolerance,
        reason=reason,
        agrees=abs(deviation) <= tolerance,
    )


def build_study(
    key: str,
    quantity: str,
    parameter: str,
    results: Sequence[tuple[float, float]],
    theory: tuple[float, float],
    reason: str,
) -> ConvergenceStudy:
    """Observed orders of convergence beside the theoretical one.

    Args:
        key, quantity: Name within the topic, and quantity whose error is measured.
        parameter: Refined step with its unit.
        results: Step and relative error, the coarsest first.
        theory: Theoretical order, and largest difference of the last observed order from it.
        reason: Origin of the order and reason of the tolerance.
    """
    steps, errors = np.array(results).T
    orders = np.log(errors[:-1] / errors[1:]) / np.log(steps[:-1] / steps[1:])
    order, tolerance = theory
    return ConvergenceStudy(
        key=key,
        quantity=quantity,
        parameter=parameter,
        steps=steps.tolist(),
        errors=errors.tolist(),
        orders=orders.tolist(),
        theory=order,
        tolerance=tolerance,
        reason=reason,
        agrees=bool(abs(orders[-1] - order) <= tolerance),
    )


def relative_rms(computed: RealArray, exact: RealArray) -> float:
    """Root mean square of the error over that of the exact curve."""
    return float(np.sqrt(np.mean((computed - exact) ** 2) / np.mean(exact**2)))
