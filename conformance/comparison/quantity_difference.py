"""Differences of the quantities of several runs, and whether they exceed the uncertainties."""

from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.comparison.compared_run import ComparedRun
from pantocheck.conformance.comparison.run_comparison_format import ComparedQuantity
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.quantities.registry import QUANTITIES


def compare_quantities(runs: Sequence[ComparedRun], owner: int) -> tuple[ComparedQuantity, ...]:
    """Compare every quantity that a run has.

    Parameters
    ----------
    runs : sequence of ComparedRun
        Runs; the first one is the reference of the differences.
    owner : int
        Number of the pantograph; 0: the line.

    Returns
    -------
    tuple of ComparedQuantity
        Quantities in the order of reports.
    """
    known = {name for run in runs for name in run.values.get(owner, {})}
    return tuple(_compare_quantity(name, runs, owner) for name in QUANTITIES if name in known)


def _compare_quantity(name: str, runs: Sequence[ComparedRun], owner: int) -> ComparedQuantity:
    values = [run.values.get(owner, {}).get(name) for run in runs]
    widths = [run.uncertainty.get(owner, {}).get(name) for run in runs]
    pairs = [_compare_value(values[0], value, widths[0], width) for value, width in zip(values, widths, strict=True)]
    return ComparedQuantity(
        name=name,
        values=tuple(values),
        uncertainty=tuple(widths),
        difference=tuple(difference for difference, _ in pairs),
        beyond_uncertainty=tuple(beyond for _, beyond in pairs),
    )


def _compare_value(
    first: Value | None, other: Value | None, first_width: Value | None, other_width: Value | None
) -> tuple[float | None, bool | None]:
    """Largest difference of two values, and whether it exceeds the root of the sum of squares of their half-widths."""
    if first is None or other is None or np.shape(first) != np.shape(other):
        return None, None
    differences = np.atleast_1d(np.subtract(other, first))
    largest = float(differences[np.argmax(np.abs(differences))]) if differences.size else None
    if first_width is None or other_width is None:
        return largest, None
    return largest, bool(np.any(np.abs(differences) > np.hypot(first_width, other_width)))
