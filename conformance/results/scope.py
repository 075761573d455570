"""Scope of a run: the steps of the procedure of EN 50318 that its cases cover."""

from collections.abc import Sequence
from typing import Literal

from pantocheck.conformance.results.results_format import STEPS, CaseResult, ScopeStep, Step

State = Literal["done", "informative", "not done"]
STATES_BEST_FIRST: tuple[State, ...] = ("done", "informative", "not done")
"""States of a step, the best first."""

APPARENT_MASS = "apparent_mass_kg"
"""Quantity of a static case that belongs to the pantograph model, not to the line model."""


def build_scope(cases: Sequence[CaseResult]) -> list[ScopeStep]:
    """State of every step of the procedure; a step is as good as its best case."""
    return [_build_step(step, [case for case in cases if step in case.steps]) for step in STEPS]


def _build_step(step: Step, cases: Sequence[CaseResult]) -> ScopeStep:
    state = min((_judge_state(step, case) for case in cases), key=STATES_BEST_FIRST.index, default="not done")
    return ScopeStep(step=step, state=state, cases=[case.id for case in cases])


def _judge_state(step: Step, case: CaseResult) -> State:
    verdict = case.verdict if case.baseline is None else case.criteria_verdict  # a drift concerns no step
    if verdict in ("skip", "error"):
        return "not done"
    is_pantograph = step == "pantograph_model"
    graded = [item for item in case.criteria if case.baseline is None or not item.is_drift]
    criteria = [item for item in graded if (item.quantity == APPARENT_MASS) == is_pantograph]
    counts = any(item.verdict in ("pass", "fail") for item in criteria)
    return "done" if counts and case.library != "modified" else "informative"
