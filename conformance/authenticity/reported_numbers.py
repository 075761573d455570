"""Numbers of results.json: their items, and their comparison."""

import math
from collections.abc import Mapping

from pantocheck.conformance.results.results_part import Number, select_item

EXACT, ROUNDED = 1e-9, 2e-5
"""Relative tolerances: numbers of results.json have all their digits, traces are rounded to six digits."""


def select_first(reported: Mapping[str, Number]) -> dict[str, float]:
    """Quantities with one number each: of several values, the first."""
    numbers = {name: select_item(value, None) for name, value in reported.items()}
    return {name: number for name, number in numbers.items() if number is not None}


def same_number(a: float | None, b: float | None, tolerance: float = EXACT) -> bool:
    """Whether two numbers agree within a relative and absolute tolerance, or both are missing."""
    if a is None or b is None:
        return a is b
    return math.isclose(a, b, rel_tol=tolerance, abs_tol=tolerance)


def format_exact(value: float | None) -> str:
    """Number with the digits that show a discrepancy; `nothing` for None."""
    return "nothing" if value is None else f"{value:.10g}"
