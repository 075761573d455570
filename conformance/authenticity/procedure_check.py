"""Check of a procedure: verdicts of its steps and claims must follow from criteria, cases and evidence."""

from collections.abc import Callable, Iterator

from pantocheck.conformance.results.criterion_format import Criterion
from pantocheck.conformance.results.procedure_format import STEP_NAMES, Procedure
from pantocheck.conformance.results.results_format import CaseResult


def check_procedure(
    stated: Procedure | None,
    decided: Procedure | None,
    cases: list[CaseResult],
    check_grade: Callable[[Criterion], Iterator[str]],
) -> Iterator[str]:
    """Find contradictions in the procedure of a dossier.

    Args:
        stated, decided: Procedure of the results, and the same with the verdicts that follow.
        cases: Cases of the results.
        check_grade: Check of the verdict and margin of one criterion.

    Yields:
        One line per contradiction.
    """
    if stated is None or decided is None:
        return
    if tuple(step.step for step in stated.steps) != STEP_NAMES:
        yield "procedure: its steps are not complete, or not in their order"
    named = [name for step in stated.steps for name in step.cases]
    for case in cases:
        if named.count(case.id) != 1:
            yield f"procedure: {case.id} belongs to {named.count(case.id)} steps"
    for step in stated.steps:
        for row in step.criteria:
            yield from (f"step {step.step}, {row.quantity}: {text}" for text in check_grade(row))
    for name, old, new in zip(STEP_NAMES, stated.steps, decided.steps, strict=False):
        if old != new:
            yield f"step {name}: verdict '{old.verdict}', margin or uncertainty do not follow: '{new.verdict}'"
    for old_claim, new_claim in zip(stated.claims, decided.claims, strict=True):
        if old_claim != new_claim:
            yield f"claim on {old_claim.kind}: '{old_claim.verdict}' stated, '{new_claim.verdict}' follows"
    if stated.evidence != decided.evidence:
        yield "procedure: the passed runs are not those whose cases pass"
