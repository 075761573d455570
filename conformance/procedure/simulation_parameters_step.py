"""Simulation parameters: those that the dossier declares against those that the runs state."""

from collections.abc import Sequence

from pantocheck.conformance.grading.criterion_grading import Requirement, build_criterion
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.procedure.dossier import Dossier
from pantocheck.conformance.procedure.dossier_tables import ParameterTable
from pantocheck.conformance.procedure.step_result import StepResult
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.criterion_format import Criterion
from pantocheck.conformance.results.procedure_format import DeclaredParameter
from pantocheck.conformance.results.results_format import CaseResult

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
    requirement = Requirement(name, LINE, None, *bounds, "primary", DECLARED, unit=unit)
    return build_criterion(requirement, value, missing, trust)
