"""Pantograph model: frequency responses measured at its head against the model."""

from collections.abc import Iterator, Sequence

from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.comparison.comparison_limits import RESPONSE_BANDS
from pantocheck.conformance.comparison.response_comparison import compare_responses
from pantocheck.conformance.core.criterion import Criterion, Requirement
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.dossier.dossier_file import PantographEntry, ParameterTable
from pantocheck.conformance.dossier.dossier_reading import Dossier
from pantocheck.conformance.dossier.step_result import StepResult, grade_again
from pantocheck.conformance.grading.criterion_grading import build_criterion, skip_unlimited
from pantocheck.conformance.pantograph.response_record import read_response
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.comparison_format import ResponseComparison
from pantocheck.conformance.results.procedure_format import DeclaredParameter
from pantocheck.conformance.results.results_format import CaseResult

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
            criteria.append(_skip("complex_deviation_pct", number, reason))
            continue
        try:
            responses.append(_compare(dossier, entry))
        except InputError as error:
            text = " ".join(str(error).split())
            return StepResult("pantograph_model", "error", text, responses=tuple(responses))
        criteria += [grade_again(row, _state(row, entry, number), dossier.file.trust) for row in responses[-1].criteria]
        criteria += _skip_unlimited(dossier, entry, number)
    notes = ("A frequency response is unverified: it has no second channel that could confirm it.",)
    return StepResult("pantograph_model", criteria=tuple(criteria), responses=tuple(responses), notes=notes)


def _compare(dossier: Dossier, entry: PantographEntry) -> ResponseComparison:
    records = [read_response(dossier.locate(name)) for name in entry.responses]
    return compare_responses(records, dossier.pantographs[entry.name], entry.limit)


def _state(row: Criterion, entry: PantographEntry, number: int) -> dict[str, str | int]:
    """Name of a criterion with its place, number of its pantograph, trust and source."""
    where = row.where
    low, high = where.band_Hz or (0.0, 0.0)
    height = "" if where.height_m is None else f", {where.height_m:g} m"
    return {
        "quantity": f"{row.quantity}, {low:g} to {high:g} Hz, {where.static_force_N:g} N{height}",
        "pantograph": number,
        "trust": entry.trust,
        "source": source_text(row.source),
    }


def _skip_unlimited(dossier: Dossier, entry: PantographEntry, number: int) -> Iterator[Criterion]:
    """Skipped criteria of the bands up to the cut-off of the line tests for which the dossier states no limit."""
    limited = {limit.band_Hz for limit in entry.limit}
    for low, high in RESPONSE_BANDS:
        if (low, high) not in limited and high <= dossier.file.line_test.filter.cutoff_Hz:
            name = f"complex_deviation_pct, {low:g} to {high:g} Hz"
            yield _skip(name, number, "the dossier states no limit of this band")


def _skip(name: str, number: int, reason: str) -> Criterion:
    return skip_unlimited(name, reason, NEEDED_BY_PANTOGRAPHS, owner=number, unit="")


# Simulation parameters: those that the dossier declares against those that the runs state.
DECLARED = "declared in the dossier"
"""Source of the bounds of this step."""

START_AS_STATED = "as in the case"
"""State of a start that agrees with that of its case."""


def check_parameters(dossier: Dossier, runs: Sequence[CaseResult]) -> StepResult:
    """Compare the declared simulation parameters with those of the runs.

    Numbers bound the values of all runs. Texts, and runs that do not state a value, cannot be compared: a pass then
    counts as unverified.

    Args:
        dossier: Dossier with the declared parameters.
        runs: Results of the cases and pairs that have a run.
    """
    table, trust = dossier.file.parameters, dossier.file.trust
    if not any((table.element_m, table.time_step_s, table.shortest_run_s, table.start)):
        return StepResult("simulation_parameters", "not done", "the dossier declares none (table parameters)")
    largest_elements, steps, lengths = (
        [getattr(case.run, key) for case in runs] for key in ("element_m", "dt_s", "simulated_s")
    )
    parts = [
        _check_bound("largest_element_m", table.element_m, largest_elements, "m", trust),
        _check_bound("largest_time_step_s", table.time_step_s, steps, "s", trust),
        _check_bound("shortest_run_s", table.shortest_run_s, lengths, "s", trust),
        _check_start(table, runs, trust),
    ]
    open_names = [parameter.name for _, parameter in parts if parameter is not None and not parameter.confirmed]
    return StepResult(
        "simulation_parameters",
        unverified=f"not confirmed by every run: {', '.join(open_names)}" if open_names else None,
        criteria=tuple(criterion for criterion, _ in parts if criterion is not None),
        parameters=tuple(parameter for _, parameter in parts if parameter is not None),
        notes=() if table.note is None else (table.note.strip(),),
    )


def _check_bound(
    name: str, declared: float | str | None, values: Sequence[float | None], unit: str, trust: Trust
) -> tuple[Criterion | None, DeclaredParameter | None]:
    """Criterion and row of a parameter whose declared number bounds the values of the runs."""
    known = [value for value in values if value is not None]
    if declared is None:
        return _build_criterion(name, None, (None, None), "the dossier does not declare it", unit, trust), None
    shown = f"{min(known):g} to {max(known):g} {unit}" if known else "not stated"
    if isinstance(declared, str):
        return None, DeclaredParameter(name=name, declared=declared, runs=shown, confirmed=False)
    is_lower = name == "shortest_run_s"
    extreme = (min if is_lower else max)(known) if known else None
    bounds = (declared, None) if is_lower else (None, declared)
    missing = None if known else "no run states it"
    parameter = DeclaredParameter(
        name=name, declared=f"{declared:g} {unit}", runs=shown, confirmed=bool(known) and len(known) == len(values)
    )
    return _build_criterion(name, extreme, bounds, missing, unit, trust), parameter


def _check_start(
    table: ParameterTable, runs: Sequence[CaseResult], trust: Trust
) -> tuple[Criterion | None, DeclaredParameter | None]:
    """Row of the start, which is declared in words; the runs confirm it if they start as their cases state."""
    if table.start is None:
        return _build_criterion("start", None, (None, None), "the dossier does not declare it", "", trust), None
    states = [None if case.record is None else case.record.start for case in runs]
    shown = ", ".join(sorted({state or "not stated" for state in states})) or "no run"
    confirmed = bool(states) and all(state == START_AS_STATED for state in states)
    return None, DeclaredParameter(name="start", declared=table.start, runs=shown, confirmed=confirmed)


def _build_criterion(
    name: str,
    value: float | None,
    bounds: tuple[float | None, float | None],
    missing: str | None,
    unit: str,
    trust: Trust,
) -> Criterion:
    lower, upper = bounds
    requirement = Requirement(
        quantity=name, pantograph=LINE, unit=unit, lower=lower, upper=upper, trust="primary", source=DECLARED
    )
    return build_criterion(requirement, value, missing, trust)
