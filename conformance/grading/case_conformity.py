"""Probability that all counted values lie inside their limits, from the joint samples of the criteria."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.verdicts import judge
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.criterion_grading import find_value
from pantocheck.conformance.results.results_format import CaseConformity, CaseResult

COUNTED = frozenset({"pass", "undecided", "fail"})
"""Verdicts of criteria that are graded and count."""


def find_case_conformity(criteria: Iterable[Criterion], starts: tuple[int, int] = (0, 0)) -> CaseConformity | None:
    """Conformity of all counted values of a case; None if no value has a joint sample.

    Args:
        criteria: Criteria of the case.
        starts: Number of starts that were run, and of those with all counted values inside their limits.
    """
    if (inside := _find_conforming_draws(criteria)) is None:
        return None
    return CaseConformity(probability=float(inside.mean()), starts=starts[0], passing_starts=starts[1])


def find_conformity(cases: Iterable[CaseResult]) -> float | None:
    """Probability that all counted values of several cases lie inside their limits; None without a joint sample."""
    found = [inside for case in cases if (inside := _find_conforming_draws(case.criteria)) is not None]
    return float(np.all(found, axis=0).mean()) if found else None


def _find_conforming_draws(criteria: Iterable[Criterion]) -> NDArray[np.bool_] | None:
    """Draws with every counted value inside its limits; a value without a sample is the same in all draws."""
    counted = [row for row in criteria if row.verdict in COUNTED and not row.is_drift and row.value is not None]
    sizes = {len(row.draws) for row in counted if row.draws}
    if not sizes:
        return None
    draws = [(row, row.draws or [row.value or 0.0] * max(sizes)) for row in counted]
    inside = [[judge(draw, row.lower, row.upper) == "pass" for draw in values] for row, values in draws]
    return np.asarray(np.all(inside, axis=0))


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
