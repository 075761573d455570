"""Cases of the library on a short line."""

from dataclasses import replace
from typing import Any

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator

COARSE = (2.0, 0.004)
"""Element length [m] and time step [s] of short passages."""


def run_unrefined(case: Case) -> CaseResult:
    """Result of a case on the reference simulator, without a finer mesh."""
    return grade_case(case, UnrefinedSimulator().run(case), "secondary")


def shorten_case(case: Case, speed_km_h: float, mass_coefficient: float, pantographs: int) -> Case:
    """Pantographs of the first kind of a case, 60 m apart, on ten damped spans with elements of 2 m.

    The coefficient [1/s] of both wires lets waves decay within a few spans, so that the train of a short line is
    settled; the last spans keep reflections away from the analysis section.
    """
    damping = case.line.damping
    wires = {
        key: getattr(damping, key).model_copy(update={"mass_coefficient_1_s": mass_coefficient})
        for key in ("contact_wire", "messenger_wire")
    }
    line = {"damping": damping.model_copy(update=wires), "geometry": case.line.geometry.shorten(10)}
    coarse = case.file.discretisation.model_copy(update={"element_m": 2.0, "time_step_s": 0.004})
    file = {
        "speed_km_h": speed_km_h, "evaluated_spans": (5, 8), "compared_spans": None, "discretisation": coarse,
        "pantograph": case.file.pantograph[:1] * pantographs, "spacing_m": (60.0,) * (pantographs - 1) or None,
    }  # fmt: skip
    return replace(
        case,
        file=case.file.model_copy(update=file),
        line=case.line.model_copy(update=line),
        pantographs=case.pantographs[:1] * pantographs,
    )


def change_case(case: Case, spans: int | None = None, mesh: tuple[float, float] | None = None, **keys: Any) -> Case:
    """Case with changed keys of its file, on its first spans, with another element length [m] and time step [s]."""
    if mesh is not None:
        steps = {"element_m": mesh[0], "time_step_s": mesh[1]}
        keys["discretisation"] = case.file.discretisation.model_copy(update=steps)
    line = case.line
    if spans is not None:
        line = line.model_copy(update={"geometry": line.geometry.shorten(spans)})
    return replace(case, file=case.file.model_copy(update=keys), line=line)
