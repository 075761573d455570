"""Calibration of `start` after a long run-in, and of `section`: sections anywhere on a longer line of AC simple."""

from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.start_and_section import shift_section, span_length
from pantocheck.conformance.grading.case_uncertainty import start_component
from pantocheck.conformance.grading.record_uncertainty import shift_component
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.simulation.case_run import run_passage
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.model import discretise
from verification.speed.passage_lines import ac_simple
from verification.tables.calibration import Calibration, build_calibration

SPANS, RESERVE = 72, 10
"""Spans of the line, and those behind the last section, so that its end has no influence."""

PARTS = np.arange(-0.95, 1.0, 0.05)
"""Shifts of the section in spans."""


def calibrate_run_in(case: Case) -> Calibration:
    """Compare the half-widths from earlier sections with all later sections of a longer line."""
    signals, longer = _run_longer(case)
    first, last = case.file.evaluated_spans[0], case.file.evaluated_spans[-1]
    geometry = longer.line.geometry
    later = [geometry.section(first + k, last + k) for k in range(1, SPANS - RESERVE - last + 1)]
    component = start_component(longer, signals, [])
    others = [signals.evaluate_section(section).values for section in later]
    return build_calibration(case.id, signals.evaluation.values, component.half_widths, others)


def calibrate_section(case: Case) -> Calibration:
    """Compare the half-widths from shifts by quarters of a span with shifts by any part of a span."""
    signals, longer = _run_longer(case)
    (start, end), span = longer.analysis_section, span_length(longer)
    component = shift_component(signals, shift_section(longer.analysis_section, span))
    others = [signals.evaluate_section((start + part * span, end + part * span)).values for part in PARTS]
    return build_calibration(case.id, signals.evaluation.values, component.half_widths, others)


def _run_longer(case: Case) -> tuple[RecordSignals, Case]:
    """Signals of the passage on a longer line, recorded from span 11 on."""
    file = case.file.model_copy(update={"compared_spans": (11, SPANS - RESERVE)})
    longer = replace(ac_simple(SPANS, case=case.id), file=file)
    discretisation = file.discretisation
    run = run_passage(longer, discretise(build_catenary(longer.line), discretisation.element_m), discretisation)
    return RecordSignals(run.record, file.filter.low_pass, longer.line.geometry.supports), longer
