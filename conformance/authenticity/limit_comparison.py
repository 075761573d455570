"""Limits of a result against those of the installed case."""

from collections.abc import Iterator
from typing import Any

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.converged_file import find_converged
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.grading.case_identity import describe_limit_change, limits_digest
from pantocheck.conformance.grading.case_verification import find_obstacle, verification_digest
from pantocheck.conformance.grading.criterion_grading import Requirement, criterion_name
from pantocheck.conformance.grading.verification_limits import build_requirements, include_start
from pantocheck.conformance.quantities.limit_text import format_bounds, name_value
from pantocheck.conformance.results.criterion_format import Criterion
from pantocheck.conformance.results.results_format import CaseResult

LimitTarget = tuple[str, int, int | None]
"""Quantity, pantograph and item."""


def compare_limits(case: Case, result: CaseResult) -> Iterator[str]:
    """Differences of the limits of a result from those of the installed case.

    Limits of a user may replace those of the case. The result must then state each limit that they weaken.

    Args:
        case: Installed case with the limits of its file.
        result: Result of a case with this id.

    Yields:
        One sentence per difference.
    """
    rows = _by_target(row for row in result.criteria if not row.is_drift)
    limits = {limit.target: limit for limit in case.limits}
    if not rows and result.verdict in ("skip", "error") and result.reason:
        return  # not graded
    if result.limits_digest == limits_digest(case.limits):
        for target in rows.keys() - limits.keys():
            yield f"{criterion_name(rows[target])}: no limit in the library, {_bounds(rows[target])} in the certificate"
        for target, limit in limits.items():
            yield from _compare_limit(limit, rows.get(target))
        return
    for target, limit in limits.items():
        change = describe_limit_change(limit, _replacing_limit(limit, rows.get(target)))
        if change is not None and change not in result.limit_changes:
            yield f"{change}, which the certificate does not state"


def list_own_limits(case: Case, result: CaseResult) -> list[str]:
    """Limits of a result that are not those of the installed case, although it is not stated as modified."""
    limits = {limit.target: limit for limit in case.limits}
    rows = _by_target(row for row in result.criteria if not row.is_drift)
    return [
        f"{criterion_name(row)}: {_bounds(row)}"
        for target, row in rows.items()
        if target not in limits or list(_compare_limit(limits[target], row))
    ]


def compare_verification_limits(case: Case, result: CaseResult) -> Iterator[str]:
    """Differences of the verification limits from the converged values of the installed case; as `compare_limits`."""
    converged, stated = find_converged(case.id), result.verification
    if converged is None:
        if stated is not None:
            yield "the library has no converged values of this case, the certificate has a verification"
        return
    if stated is None:
        yield "the library has converged values of this case, the certificate has no verification"
        return
    if stated.digest != verification_digest(converged):
        yield "the converged values of the library are others than those of the certificate (digest)"
    graded = not (result.reason and result.verdict in ("skip", "error"))
    if find_obstacle(case, converged) is not None or not graded or stated.verdict == "error":
        return
    requirements = build_requirements(converged, case.is_static)
    if result.record is not None and result.record.start == "differs":
        requirements = tuple(include_start(requirement, converged) for requirement in requirements)
    rows, wanted = _by_target(stated.criteria), {_target(item): item for item in requirements}
    for target in rows.keys() - wanted.keys():
        yield f"{criterion_name(rows[target])}: no converged value in the library, a limit in the certificate"
    for target, requirement in wanted.items():
        row = rows.get(target)
        if row is None:
            yield f"{requirement.quantity}: the verification of the certificate lacks this quantity"
        elif (row.lower, row.upper) != (requirement.lower, requirement.upper):
            bounds = format_bounds(requirement.lower, requirement.upper)
            name = criterion_name(row)
            yield f"verification of {name}: {bounds} in the library, {_bounds(row)} in the certificate"


def _compare_limit(limit: Limit, row: Criterion | None) -> Iterator[str]:
    name = name_value(limit.quantity, limit.item) + (f" of pantograph {limit.owner}" if limit.owner else "")
    if row is None:
        bounds = format_bounds(limit.lower, limit.upper)
        yield f"{name}: limit {bounds} in the library, no criterion in the certificate"
        return
    if (row.lower, row.upper) != (limit.lower, limit.upper):
        bounds = format_bounds(limit.lower, limit.upper)
        yield f"{name}: limit {bounds} {row.unit} in the library, {_bounds(row)} {row.unit} in the certificate"
    if row.trust != limit.trust:
        yield f"{name}: trust '{limit.trust}' in the library, '{row.trust}' in the certificate"
    if row.source != source_text(limit.source):
        yield f"{name}: the source of the limit is another one than in the library"
    roles: list[Any] = [item and item.role for item in (limit.finding, row.finding)]
    if roles[0] != roles[1]:
        yield f"{name}: finding '{roles[0]}' in the library, '{roles[1]}' in the certificate"


def _replacing_limit(limit: Limit, row: Criterion | None) -> Limit | None:
    """Limit of the case with the bounds and trust of a criterion; None without a criterion."""
    if row is None:
        return None
    finding = limit.finding if row.finding is not None else None
    return limit.model_copy(update={"lower": row.lower, "upper": row.upper, "trust": row.trust, "finding": finding})


def _by_target(rows: Any) -> dict[LimitTarget, Criterion]:
    return {(row.quantity, row.pantograph, row.item): row for row in rows}


def _target(requirement: Requirement) -> LimitTarget:
    return requirement.quantity, requirement.owner, requirement.item


def _bounds(row: Criterion) -> str:
    return format_bounds(row.lower, row.upper)
