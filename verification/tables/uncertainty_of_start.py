"""Calibration of the component `start` of a short run-in: any start from 2 m on, and four ramps."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.start_and_section import RunStart, list_other_starts
from pantocheck.conformance.grading.case_uncertainty import start_component
from pantocheck.conformance.quantities.evaluation import Evaluation
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.simulation.case_run import run_passage, run_starts
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.model import discretise
from verification.tables.calibration import Calibration, build_calibration

PLACES = np.arange(2.0, 121.0, 2.0)
"""Starts that the half-width should contain [m]."""

RAMPS = (0.25, 0.5, 1.0, 2.0)
"""Durations of the ramps that the half-width should contain [s]."""


def calibrate_start(case: Case) -> Calibration:
    """Compare the half-widths of a case with runs from other starts."""
    discretisation = case.file.discretisation
    line = discretise(build_catenary(case.line), discretisation.element_m)
    run = run_passage(case, line, discretisation)
    signals = RecordSignals(run.record, case.file.filter.low_pass, case.line.geometry.supports)

    def evaluate(starts: Iterable[RunStart]) -> list[Evaluation]:
        records = run_starts(starts, case, line, discretisation, run.uplift_forces)
        return [replace(signals, record=record).evaluation for record in records]

    component = start_component(case, signals, evaluate(list_other_starts(case)))
    found = evaluate(_list_tested_starts(case))
    return build_calibration(
        case.id, signals.evaluation.values, component.half_widths, [other.values for other in found]
    )


def _list_tested_starts(case: Case) -> Iterator[RunStart]:
    for place in PLACES:
        yield RunStart(replace(case, file=case.file.model_copy(update={"start_m": float(place)})))
    yield from (RunStart(case, ramp) for ramp in RAMPS)
