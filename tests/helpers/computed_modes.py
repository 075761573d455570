"""Computed modes in place of identified modes, like the result of an identification without errors."""

from dataclasses import replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.results.identified_modes import Mode, SensorShape
from pantocheck.conformance.runs.system import Delivered, StudyResult
from pantocheck.conformance.studies.vovan2015.line_damping import computed_damping_ratios
from pantocheck.model import Catenary, discretise
from pantocheck.model.modal.modes import compute_modes_below

ELEMENT = 1.5
"""Length of the elements [m]."""


def computed_modes(line: Catenary, spans: int, highest: float) -> list[Mode]:
    """Modes of a line below a frequency [Hz]; each group holds one mode per span."""
    mesh = discretise(line, ELEMENT)
    shapes = compute_modes_below(mesh, highest)
    return [
        Mode(
            frequency_Hz=float(f),
            frequency_std_Hz=1e-5,
            damping_ratio=float(z),
            damping_ratio_std=1e-6,
            sensor_shape=(SensorShape(sensor=1, re=1.0, im=0.0, std=0.0),),
            error=0.0,
            record="computed",
            group=1 + i // spans,
        )
        for i, (f, z) in enumerate(zip(shapes.frequency, computed_damping_ratios(mesh, shapes, line), strict=True))
    ]


def grade_findings(case: Case, findings: dict) -> dict[tuple[str, int | None], Criterion]:
    """Criteria of a case for findings, by quantity and by item or pantograph."""
    result = grade_case(
        replace(case, file=case.file.model_copy(update={"speed_km_h": None})),
        Delivered(study=StudyResult(findings)),
        "primary",
    )
    return {(row.quantity, row.item or row.pantograph or None): row for row in result.criteria}
