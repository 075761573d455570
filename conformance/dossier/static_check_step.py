"""Static check: elasticity and contact wire heights measured along a line against its model."""

from collections.abc import Iterator

from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.comparison.comparison_limits import unit_of_difference
from pantocheck.conformance.comparison.static_comparison import build_tolerances, compare_statics
from pantocheck.conformance.comparison.static_differences import CRITERIA
from pantocheck.conformance.comparison.static_record import STATIC_VALUES, read_static_record
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.dossier.dossier_file import LineEntry, StaticTolerance
from pantocheck.conformance.dossier.dossier_reading import Dossier
from pantocheck.conformance.dossier.step_result import StepResult, grade_again
from pantocheck.conformance.grading.criterion_grading import skip_unlimited
from pantocheck.conformance.results.comparison_format import StaticComparison, StaticQuantity

NEEDED_BY_STATIC_CHECK = "needed by the static check of this suite"
"""Source of a criterion without a tolerance."""


def check_statics(dossier: Dossier) -> StepResult:
    """Compare the measured static values of every line with its model.

    Elasticity and height both need a tolerance and measured values; a criterion without them is skipped.

    Args:
        dossier: Dossier with its lines.
    """
    entries = dossier.file.line
    if not any(entry.statics for entry in entries):
        reason = "the dossier names no measured elasticity and contact wire heights of a line (key line.statics)"
        return StepResult("static_check", "not done", reason)
    statics, criteria = [], []
    for number, entry in enumerate(entries, 1):
        item = number if len(entries) > 1 else None
        if entry.statics is None:
            reason = f"line {entry.name!r} has no measured values (key line[{number}].statics)"
            criteria += list(_skip_missing(entry.tolerance, item, reason))
            continue
        try:
            statics.append(_compare(dossier, entry, entry.statics))
        except InputError as error:
            return StepResult("static_check", "error", " ".join(str(error).split()), statics=tuple(statics))
        stated = {"item": item, "trust": entry.tolerance.trust, "source": source_text(entry.tolerance.source)}
        criteria += [grade_again(row, stated, dossier.file.trust) for row in statics[-1].criteria]
        criteria += _skip_ungraded(entry.tolerance, item)
    notes = ("A table of static values is unverified: it has no second channel that could confirm it.",)
    return StepResult("static_check", criteria=tuple(criteria), statics=tuple(statics), notes=notes)


def _compare(dossier: Dossier, entry: LineEntry, name: str) -> StaticComparison:
    line = dossier.lines[entry.name]
    record = read_static_record(dossier.locate(name), line.geometry)
    return compare_statics(record, line, entry.element_m, build_tolerances(_list_tolerances(entry.tolerance)))


def _list_tolerances(tolerance: StaticTolerance) -> dict[StaticQuantity, float]:
    """Stated tolerances by the name of their criterion."""
    stated: dict[StaticQuantity, float | None] = {
        "elasticity_difference_mm_N": tolerance.elasticity_mm_N,
        "elasticity_difference_pct": tolerance.elasticity_pct,
        "contact_wire_height_difference_mm": tolerance.height_mm,
    }
    return {name: value for name, value in stated.items() if value is not None}


def _skip_ungraded(tolerance: StaticTolerance, item: int | None) -> Iterator[Criterion]:
    """Skipped criteria of the values for which the dossier states no tolerance."""
    graded = {CRITERIA[name] for name in _list_tolerances(tolerance)}
    for value in STATIC_VALUES:
        if value not in graded:
            quantity = next(name for name, kind in CRITERIA.items() if kind == value)
            yield _skip(quantity, item, "the dossier states no tolerance")


def _skip_missing(tolerance: StaticTolerance, item: int | None, reason: str) -> Iterator[Criterion]:
    """Skipped criteria of a line without measured values."""
    for quantity in _list_tolerances(tolerance) or CRITERIA:
        yield _skip(quantity, item, reason)


def _skip(quantity: StaticQuantity, item: int | None, reason: str) -> Criterion:
    return skip_unlimited(quantity, reason, NEEDED_BY_STATIC_CHECK, item=item, unit=unit_of_difference(quantity))
