"""Pantograph model: frequency responses measured at its head against the model."""

from collections.abc import Iterator

from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.comparison.comparison_limits import RESPONSE_BANDS
from pantocheck.conformance.comparison.response_comparison import compare_responses
from pantocheck.conformance.comparison.response_record import read_response
from pantocheck.conformance.grading.criterion_grading import Requirement, build_criterion
from pantocheck.conformance.grading.near_limit import ValueErrors
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.sourced_table import NO_SOURCE
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.procedure.dossier import Dossier
from pantocheck.conformance.procedure.dossier_tables import PantographEntry
from pantocheck.conformance.procedure.step_result import StepResult
from pantocheck.conformance.results.comparison_format import ComparisonCriterion, ResponseComparison
from pantocheck.conformance.results.criterion_format import Criterion

NEEDED_BY_PANTOGRAPHS = "needed by the comparison of pantographs of this suite"
"""Source of a criterion without a limit."""


def check_pantographs(dossier: Dossier) -> StepResult:
    """Compare the measured responses of every pantograph with its model.

    Every band up to the cut-off of the line tests needs a limit; a band without one is skipped.

    Args:
        dossier: Dossier with its pantographs.
    """
    entries = dossier.file.pantograph
    if not any(entry.responses for entry in entries):
        reason = "the dossier names no measured frequency response of a pantograph (key pantograph.responses)"
        return StepResult("pantograph_model", "not done", reason)
    responses: list[ResponseComparison] = []
    criteria: list[Criterion] = []
    for number, entry in enumerate(entries, 1):
        if not entry.responses:
            reason = f"pantograph {entry.name!r} has no measured response (key pantograph[{number}].responses)"
            criteria.append(_skip("complex_deviation_pct", number, dossier.file.trust, reason))
            continue
        try:
            responses.append(_compare(dossier, entry))
        except InputError as error:
            text = " ".join(str(error).split())
            return StepResult("pantograph_model", "error", text, responses=tuple(responses))
        criteria += [_convert(row, entry, number, dossier.file.trust) for row in responses[-1].criteria]
        criteria += _skip_unlimited(dossier, entry, number)
    notes = ("A frequency response is unverified: it has no second channel that could confirm it.",)
    return StepResult("pantograph_model", criteria=tuple(criteria), responses=tuple(responses), notes=notes)


def _compare(dossier: Dossier, entry: PantographEntry) -> ResponseComparison:
    records = [read_response(dossier.locate(name)) for name in entry.responses]
    return compare_responses(records, dossier.pantographs[entry.name], entry.limit)


def _convert(row: ComparisonCriterion, entry: PantographEntry, number: int, trust: Trust) -> Criterion:
    where = row.where
    low, high = where.band_Hz or (0.0, 0.0)
    height = "" if where.height_m is None else f", {where.height_m:g} m"
    requirement = Requirement(
        f"{row.quantity}, {low:g} to {high:g} Hz, {where.static_force_N:g} N{height}",
        number,
        None,
        None,
        row.upper,
        entry.trust,
        source_text(row.source or NO_SOURCE),
        unit=row.unit,
    )
    if row.verdict == "skip":
        return build_criterion(requirement, None, row.reason, trust)
    return build_criterion(requirement, row.value, None, trust, ValueErrors(limit_uncertainty=row.measurement or 0.0))


def _skip_unlimited(dossier: Dossier, entry: PantographEntry, number: int) -> Iterator[Criterion]:
    """Skipped criteria of the bands up to the cut-off of the line tests for which the dossier states no limit."""
    limited = {limit.band_Hz for limit in entry.limit}
    for low, high in RESPONSE_BANDS:
        if (low, high) not in limited and high <= dossier.file.line_test.filter.cutoff_Hz:
            name = f"complex_deviation_pct, {low:g} to {high:g} Hz"
            yield _skip(name, number, dossier.file.trust, "the dossier states no limit of this band")


def _skip(name: str, number: int, trust: Trust, reason: str) -> Criterion:
    requirement = Requirement(name, number, None, None, None, "primary", NEEDED_BY_PANTOGRAPHS, unit="")
    return build_criterion(requirement, None, reason, trust)
