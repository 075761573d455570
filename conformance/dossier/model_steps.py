"""Steps without a measured run: pantograph model, line at rest, simulation parameters, reference models, claims."""

from collections.abc import Iterator, Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.limits import own_source
from pantocheck.conformance.comparison.comparison_limits import RESPONSE_BANDS, unit_of_difference
from pantocheck.conformance.comparison.response_comparison import compare_responses
from pantocheck.conformance.comparison.static_comparison import CRITERIA, build_tolerances, compare_statics
from pantocheck.conformance.comparison.static_record import STATIC_VALUES, read_static_record
from pantocheck.conformance.core.criterion import Criterion, Requirement
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.dossier.dossier_file import (
    LineEntry,
    PantographEntry,
    ParameterTable,
    StaticTolerance,
    ValidityTable,
)
from pantocheck.conformance.dossier.dossier_reading import Dossier
from pantocheck.conformance.dossier.step_result import StepInterrupted, StepResult, describe_conditions, grade_again
from pantocheck.conformance.execution.runner import Progress, RunInterrupted, run_cases
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.grading.criterion_grading import build_criterion, skip_unlimited
from pantocheck.conformance.grading.procedure_verdict import is_reference
from pantocheck.conformance.pantograph.response_record import read_response
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.comparison_format import ResponseComparison, StaticComparison, StaticQuantity
from pantocheck.conformance.results.procedure_format import DeclaredParameter, ValidityClaim
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.system import System

NEEDED_BY_PANTOGRAPHS = "needed by the comparison of pantographs of this suite"
"""Source of a criterion without a limit."""


def check_pantographs(dossier: Dossier) -> StepResult:
    """Compare the measured responses of every pantograph with its model.

    Every band up to the cut-off of the line tests needs a limit; a band without one is skipped.
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
    notes = ("A frequency response is unconfirmed: it has no second channel that could confirm it.",)
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
        "trust": "own",
        "source": source_text(own_source(row.source)),
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
    """Compare the declared simulation parameters with those of the runs of cases and pairs.

    Numbers bound the values of all runs. Texts, and runs that do not state a value, cannot be compared: a pass then
    counts as unconfirmed.
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
        unconfirmed=f"not confirmed by every run: {', '.join(open_names)}" if open_names else None,
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
        quantity=name, pantograph=LINE, unit=unit, lower=lower, upper=upper, trust="own", source=DECLARED
    )
    return build_criterion(requirement, value, missing, trust)


# Static check: elasticity and contact wire heights measured along a line against its model.
NEEDED_BY_STATIC_CHECK = "needed by the static check of this suite"
"""Source of a criterion without a tolerance."""


def check_statics(dossier: Dossier) -> StepResult:
    """Compare the measured static values of every line with its model.

    Elasticity and height both need a tolerance and measured values; a criterion without them is skipped.
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
            criteria += [_skip_static(name, item, reason) for name in _list_tolerances(entry.tolerance) or CRITERIA]
            continue
        try:
            statics.append(_compare_statics(dossier, entry, entry.statics))
        except InputError as error:
            return StepResult("static_check", "error", " ".join(str(error).split()), statics=tuple(statics))
        stated = {"item": item, "trust": "own", "source": source_text(own_source(entry.tolerance.source))}
        sizes = {values.name: max(map(abs, values.measured), default=None) for values in statics[-1].values}
        largest: dict[str, float | None] = {quantity: sizes.get(kind) for quantity, kind in CRITERIA.items()}
        criteria += [
            grade_again(row, stated, dossier.file.trust, largest[row.quantity]) for row in statics[-1].criteria
        ]
        criteria += _skip_ungraded(entry.tolerance, item)
    notes = ("A table of static values is unconfirmed: it has no second channel that could confirm it.",)
    return StepResult("static_check", criteria=tuple(criteria), statics=tuple(statics), notes=notes)


def _compare_statics(dossier: Dossier, entry: LineEntry, name: str) -> StaticComparison:
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
            yield _skip_static(quantity, item, "the dossier states no tolerance")


def _skip_static(quantity: StaticQuantity, item: int | None, reason: str) -> Criterion:
    return skip_unlimited(quantity, reason, NEEDED_BY_STATIC_CHECK, item=item, unit=unit_of_difference(quantity))


# Reference models: the system under test runs the cases of the dossier.
def run_reference_models(
    dossier: Dossier, system: System, participation: Participation, jobs: int, progress: Progress | None
) -> StepResult:
    """Run the reference models of a dossier on the system under test.

    Raises:
        StepInterrupted: The user ended the run.
    """
    if not dossier.cases:
        return StepResult("reference_models", "not done", "the dossier names no reference model (key reference.cases)")
    try:
        results = run_cases(dossier.cases, system, dossier.file.trust, jobs, progress, participation)
    except RunInterrupted as interruption:
        result = _build_result(dossier, interruption.results.cases)
        raise StepInterrupted(result, interruption.exit_code) from None
    return _build_result(dossier, results.cases)


def _build_result(dossier: Dossier, results: Sequence[CaseResult]) -> StepResult:
    by_id: dict[str, Case] = {case.id: case for case in dossier.cases}
    evidence = [describe_conditions(case.id, by_id[case.id], dossier) for case in results]
    others = [case.id for case in results if not is_reference(case)]
    return StepResult(
        "reference_models",
        cases=tuple(results),
        evidence=tuple(item for item in evidence if item is not None),
        notes=(f"No reference model of the library, for information: {', '.join(others)}.",) if others else (),
    )


# Limits of validity: the claims of a dossier. The runs that passed verify them.
def list_claims(dossier: Dossier) -> StepResult:
    """Claims of a dossier; their verdicts follow from those of the runs."""
    table = dossier.file.validity
    if table.claims_nothing:
        return StepResult("limits_of_validity", "not done", "the dossier claims no range of validity (table validity)")
    return StepResult("limits_of_validity", claims=tuple(_list_claims(table)))


def _list_claims(table: ValidityTable) -> Iterator[ValidityClaim]:
    for name in table.lines:
        yield ValidityClaim(kind="line", name=name, unit="", claimed=None)
    for name in table.pantographs:
        yield ValidityClaim(kind="pantograph", name=name, unit="", claimed=None)
    if table.speed_km_h is not None:
        yield ValidityClaim(kind="speed", name="", unit="km/h", claimed=table.speed_km_h)
    if table.spacing_m is not None:
        yield ValidityClaim(kind="spacing", name="", unit="m", claimed=table.spacing_m)
    for change in table.change:
        yield ValidityClaim(kind="change", name=change.key, unit="", claimed=change.range)
