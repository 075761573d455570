"""Probability that all counted values lie inside their limits, from the joint samples of the criteria."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.results_part import select_item
from pantocheck.conformance.core.verdicts import judge
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.criterion_grading import find_value
from pantocheck.conformance.results.case_facts_format import ReadingFacts
from pantocheck.conformance.results.results_format import CaseConformity, CaseResult

COUNTED = frozenset({"pass", "undecided", "fail"})
"""Verdicts of criteria that are graded and count."""


def find_case_conformity(
    criteria: Sequence[Criterion], starts: tuple[int, int] = (0, 0), readings: Iterable[ReadingFacts] = ()
) -> CaseConformity | None:
    """Conformity of all counted values of a case; None if no value has a joint sample.

    Args:
        criteria: Criteria of the case.
        starts: Number of starts that were run, and of those with all counted values inside their limits.
        readings: Values under the further readings of the case.
    """
    if (inside := _find_conforming_draws(criteria)) is None:
        return None
    others = {
        reading.id: float(found.mean())
        for reading in readings
        if reading.reason is None and (found := _find_conforming_draws(criteria, reading)) is not None
    }
    share = float(inside.mean())
    return CaseConformity(probability=share, starts=starts[0], passing_starts=starts[1], readings=others)


def find_conformity(cases: Iterable[CaseResult]) -> float | None:
    """Probability that all counted values of several cases lie inside their limits; None without a joint sample."""
    found = [inside for case in cases if (inside := _find_conforming_draws(case.criteria)) is not None]
    return float(np.all(found, axis=0).mean()) if found else None


def _find_conforming_draws(
    criteria: Iterable[Criterion], reading: ReadingFacts | None = None
) -> NDArray[np.bool_] | None:
    """Draws with every counted value inside its limits; a value without a sample is the same in all draws.

    A reading shifts the draws by the difference of its value. A value that it does not change, or lacks, stays.
    """
    counted = [row for row in criteria if row.verdict in COUNTED and not row.is_drift and row.value is not None]
    sizes = {len(row.draws) for row in counted if row.draws}
    if not sizes:
        return None
    draws = [(row, row.draws or [row.value or 0.0] * max(sizes), _find_shift(row, reading)) for row in counted]
    inside = [[judge(x + shift, row.lower, row.upper) == "pass" for x in values] for row, values, shift in draws]
    return np.asarray(np.all(inside, axis=0))


def _find_shift(row: Criterion, reading: ReadingFacts | None) -> float:
    """Difference of the value of a criterion under a reading from that of the case."""
    if reading is None or row.value is None:
        return 0.0
    value = select_item(reading.quantities.get(str(row.pantograph), {}).get(row.quantity), row.item)
    return 0.0 if value is None else value - row.value


def count_passing_starts(evaluation: CaseEvaluation, criteria: Iterable[Criterion]) -> tuple[int, int]:
    """Number of starts that were run, that of the case included, and of those with all counted values inside.

    Args:
        evaluation: Delivery with its other starts; without one, no start is counted.
        criteria: Criteria of the case.
    """
    counted = [row for row in criteria if row.verdict in COUNTED]
    others = evaluation.start_evaluations
    if not others:
        return 0, 0
    runs = [evaluation.evaluation, *others]
    values = [[(find_value(row.target, run.values), row) for row in counted] for run in runs]
    inside = [all(x is not None and judge(x, row.lower, row.upper) == "pass" for x, row in run) for run in values]
    return len(runs), sum(inside)
