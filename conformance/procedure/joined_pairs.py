"""Line tests joined over the pairs: mean, spread and largest difference of every quantity."""

import math
from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.procedure_format import JoinedQuantity
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.results.results_part import Number


def join_pairs(cases: Sequence[CaseResult]) -> list[JoinedQuantity]:
    """Join the differences of all pairs that were compared.

    Args:
        cases: Results of the pairs.

    Returns:
        Quantities that a pair has in both runs, by pantograph (0: the line) and in the order of reports.
    """
    owners = sorted({int(owner) for case in cases if case.comparison for owner in case.comparison.quantities})
    joined = (_join_quantity(cases, str(owner), name) for owner in owners for name in QUANTITIES)
    return [item for item in joined if item is not None]


def _join_quantity(cases: Sequence[CaseResult], owner: str, name: str) -> JoinedQuantity | None:
    differences: dict[str, float] = {}
    widths: list[float | None] = []
    for case in cases:
        if case.comparison is None:
            continue
        simulated = case.quantities.get(owner, {}).get(name)
        measured = case.comparison.quantities.get(owner, {}).get(name)
        if isinstance(simulated, float) and isinstance(measured, float):
            differences[case.id] = simulated - measured
            stated = (case.uncertainty, case.comparison.uncertainty)
            widths.append(_join_widths([part.get(owner, {}).get(name) for part in stated]))
    if not differences:
        return None
    values = np.array(list(differences.values()))
    known = [width for width in widths if width is not None]
    largest = max(differences, key=lambda case: abs(differences[case]))
    return JoinedQuantity(
        quantity=name,
        pantograph=int(owner),
        runs=values.size,
        mean_difference=float(values.mean()),
        uncertainty=math.hypot(*known) / values.size if len(known) == values.size else None,
        spread=float(values.std(ddof=1)) if values.size > 1 else None,
        largest_difference=differences[largest],
        largest_in=largest,
    )


def _join_widths(widths: Sequence[Number | None]) -> float | None:
    """Half-width of a difference from those of both values; None if one is not known."""
    numbers = [width for width in widths if isinstance(width, float)]
    return math.hypot(*numbers) if len(numbers) == len(widths) else None
