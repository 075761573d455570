"""Runs of both formulations of a case at given uplift forces, kept in a file so that a stopped run continues."""

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.statistics import statistical_extremes
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.conformance.runs.command_system import build_case_message
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.static_quantities import SMALL_LOAD, sample_span
from pantocheck.model import discretise
from pantocheck.model.statics.elasticity import non_uniformity, static_uplift
from verification.formulations.difference_arrays import build_model
from verification.formulations.difference_line import build_line
from verification.formulations.difference_passage import difference_quantities
from verification.formulations.finite_differences import uplift_forces

FORCES = (
    "mean_force_N",
    "std_force_N",
    "rms_0_5_N",
    "rms_5_20_N",
    "rms_20_50_N",
    "statistical_max_N",
    "statistical_min_N",
    "max_force_N",
    "min_force_N",
)
"""Quantities of every pantograph."""
UPLIFT = "max_uplift_at_support_mm"
ELASTICITY = ("elasticity_mm_N", "elasticity_non_uniformity_pct")
MESHES = ((1.0, 2e-3), (0.5, 1e-3), (0.25, 5e-4))
"""Element lengths [m] and time steps [s] of the reference simulator."""
SPACINGS = (0.25, 0.125)
"""Distances of the points of the second formulation [m]."""
Runs = dict[str, Any]
"""Uplift forces of a case, quantities by formulation and mesh, and their change with the start.

A quantity is named `pantograph|name`."""


def complete_runs(case: Case, store: Path, report: Callable[[str], None]) -> Runs:
    """Runs of a case from a file, completed by those that are missing.

    Args:
        case: Case of the library.
        store: File of finished runs; it is written after every run.
        report: Function that receives a line before every run.
    """
    known = json.loads(store.read_text(encoding="utf-8")) if store.is_file() else {}
    runs: Runs = known.setdefault(case.id, {"reference": {}, "second": {}})
    if "uplift_forces" not in runs:
        forces = () if case.is_static else uplift_forces(case)
        runs["uplift_forces"] = [round(force, 3) for force in forces]
    missing: list[tuple[str, str, Callable[[], dict[str, float]]]] = []
    for mesh in MESHES:
        missing.append(
            ("reference", f"{mesh[0]:g}", lambda mesh=mesh: run_reference(case, *mesh, runs["uplift_forces"]))
        )
    for spacing in SPACINGS:
        missing.append(("second", f"{spacing:g}", partial(run_second, case, spacing, runs["uplift_forces"])))
    for formulation, mesh_name, run in missing:
        if mesh_name not in runs[formulation]:
            report(f"{case.id}: {formulation} formulation, {mesh_name} m")
            runs[formulation][mesh_name] = run()
            store.write_text(json.dumps(known, indent=1), encoding="utf-8")
    if "start" not in runs:
        report(f"{case.id}: change with the start")
        runs["start"] = run_other_starts(case)
        store.write_text(json.dumps(known, indent=1), encoding="utf-8")
    return runs


def run_reference(case: Case, element: float, step: float, forces: list[float]) -> dict[str, float]:
    """Quantities of a case on the reference simulator."""
    line = discretise(build_catenary(case.line), element)
    positions = sample_span(*case.line.geometry.span(case.line.geometry.middle_span))
    values = _name_elasticity(static_uplift(line, positions, SMALL_LOAD) / SMALL_LOAD)
    if case.is_static:
        return values
    discretisation = case.file.discretisation.model_copy(update={"element_m": element, "time_step_s": step})
    record = run_passage(case, line, discretisation, tuple(forces)).record
    found = evaluate_record(record, case.file.filter, case.line.geometry.supports).values
    values |= {f"{k}|{name}": float(found[k][name]) for k in range(1, len(forces) + 1) for name in FORCES}
    return values | {f"0|{UPLIFT}": float(found[0][UPLIFT])}


def run_other_starts(case: Case) -> dict[str, float]:
    """Half-widths of the quantities from the start and the run-in, on the reference simulator."""
    if case.is_static:
        return {}
    component = CaseEvaluation(case, ReferenceSimulator().run(case)).uncertainty.components["start"]
    widths = {
        f"{owner}|{name}": width for owner, names in component.half_widths.items() for name, width in names.items()
    }
    return {key: float(width) for key, width in widths.items() if key.split("|")[1] in (*FORCES, UPLIFT)}


def run_second(case: Case, spacing: float, forces: list[float]) -> dict[str, float]:
    """Quantities of a case in the second formulation."""
    message = build_case_message(case)
    model = build_model(build_line(message), spacing)
    positions = sample_span(*case.line.geometry.span(case.line.geometry.middle_span))
    values = _name_elasticity(np.array([model.static_uplift(x, SMALL_LOAD) for x in positions]) / SMALL_LOAD)
    if case.is_static:
        return values
    found = difference_quantities(message, spacing, tuple(forces))
    values |= {f"{owner}|{name}": value for (owner, name), value in found.items() if name in (*FORCES, UPLIFT)}
    for k in range(1, len(forces) + 1):
        low, high = statistical_extremes(found[k, "mean_force_N"], found[k, "std_force_N"])
        values |= {f"{k}|statistical_min_N": low, f"{k}|statistical_max_N": high}
    return values


def _name_elasticity(uplift_m_N: np.ndarray) -> dict[str, float]:
    values = (1e3 * float(uplift_m_N.max()), 100 * float(non_uniformity(uplift_m_N)))
    return {f"0|{name}": value for name, value in zip(ELASTICITY, values, strict=True)}
