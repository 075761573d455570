"""Library case of this version: its values beside published ranges, and beside converged values."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.converged_file import find_converged
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.execution.runner import run_case
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from verification.guide.guide_format import ConvergedComparison, LibraryCase, PublishedRange


def compute_library_case(case_id: str) -> LibraryCase:
    """Run a library case on the reference simulator and list its values.

    Raises:
        RuntimeError: The reference simulator has no result.
    """
    (case,) = (case for case in select_cases([case_id]) if case.id == case_id)
    result = run_case(case, ReferenceSimulator(), "provisional")
    if result.verdict == "error":
        raise RuntimeError(result.reason or "the reference simulator has no result")
    return list_case_values(case, result)


def list_case_values(case: Case, result: CaseResult) -> LibraryCase:
    """Values of a graded library case beside its published ranges and converged values."""
    limits = {limit.target: limit for limit in case.limits}
    return LibraryCase(
        case=case.id,
        title=case.file.title,
        edition=case.file.edition,
        superseded_by=case.file.superseded_by,
        input_digest=case.digest,
        quantities=result.quantities,
        published=[_compare_with_range(row, limits[row.quantity, row.pantograph, row.item]) for row in result.criteria],
        converged=list_converged(result),
        simulated_s=result.run.simulated_s,
        wall_s=result.run.wall_s,
    )


def _compare_with_range(criterion: Criterion, limit: Limit) -> PublishedRange:
    inside = None if criterion.value is None else _lies_between(criterion.value, limit.lower, limit.upper)
    return PublishedRange(
        quantity=criterion.quantity,
        pantograph=criterion.pantograph,
        item=criterion.item,
        lower=limit.lower,
        upper=limit.upper,
        value=criterion.value,
        uncertainty=criterion.uncertainty,
        inside=inside,
        trust=limit.trust,
        source=criterion.source,
        role="criterion" if limit.finding is None else limit.finding.role,
    )


def _lies_between(value: float, lower: float | None, upper: float | None) -> bool:
    return (lower is None or value >= lower) and (upper is None or value <= upper)


def list_converged(result: CaseResult) -> list[ConvergedComparison]:
    """Values of a result beside the converged values of both formulations; empty where none are stored."""
    converged = find_converged(result.id)
    if converged is None or result.verification is None:
        return []
    limits = {(row.pantograph, row.quantity): row for row in result.verification.criteria}
    rows = []
    for stored in converged.value:
        limit = limits.get((stored.owner, stored.quantity))
        if limit is None or limit.value is None or limit.lower is None or limit.upper is None:
            continue
        rows.append(
            ConvergedComparison(
                quantity=stored.quantity,
                pantograph=stored.owner,
                value=limit.value,
                discretisation=limit.components.get("discretisation"),
                first=stored.value,
                second=stored.second_value,
                half_width=stored.half_width,
                lower=limit.lower,
                upper=limit.upper,
                inside=_lies_between(limit.value, limit.lower, limit.upper),
            )
        )
    return rows
