"""Calibration of the uncertainty: how often each component contains the true change (docs/uncertainty.md).

python -m verification.tables.uncertainty_coverage start            other starts and ramps of the 2002 model
python -m verification.tables.uncertainty_coverage run-in           sections after a longer run-in on AC simple
python -m verification.tables.uncertainty_coverage section          shifts of the analysis section by any part of a span
python -m verification.tables.uncertainty_coverage discretisation [CASE ...]   elements and steps of a quarter
"""

import argparse
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.start_and_section import RunStart, list_other_starts, shift_section, span_length
from pantocheck.conformance.grading.case_evaluation import discretisation_component, start_component
from pantocheck.conformance.grading.record_uncertainty import shift_component
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.evaluation import Evaluation, ValuesByOwner
from pantocheck.conformance.records.record_signals import RecordSignals, evaluate_record
from pantocheck.conformance.runs.case_run import run_passage, run_starts
from pantocheck.model import discretise
from verification.formulations.library_passages import PASSAGES
from verification.speed.passage_lines import ac_simple
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
    signals = RecordSignals(run.record, case.file.filter, case.line.geometry.supports)

    def evaluate(starts: Iterable[RunStart]) -> list[Evaluation]:
        records = run_starts(tuple(starts), line, discretisation, run.uplift_forces)
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
    return RecordSignals(run.record, file.filter, longer.line.geometry.supports), longer


def calibrate_discretisation(case: Case) -> Calibration:
    """Compare the half-widths of a case with its converged values."""
    value, forces = _evaluate(case, 1.0, None)
    coarse, fine, finest = (_evaluate(case, factor, forces)[0] for factor in (2.0, 0.5, 0.25))
    component = discretisation_component(coarse, value, fine)
    return build_calibration(case.id, value.values, component.half_widths, [extrapolate(fine.values, finest.values)])


def _evaluate(case: Case, factor: float, forces: tuple[float, ...] | None) -> tuple[Evaluation, tuple[float, ...]]:
    """Quantities with element length and time step times a factor, and the uplift forces [N]."""
    discretisation = case.file.discretisation.scale(factor)
    line = discretise(build_catenary(case.line), discretisation.element_m)
    run = run_passage(case, line, discretisation, forces)
    evaluation = evaluate_record(run.record, case.file.filter, case.line.geometry.supports)
    return evaluation, run.uplift_forces


def extrapolate(fine: ValuesByOwner, finest: ValuesByOwner) -> dict[int, dict[str, float]]:
    """Richardson extrapolation of second order from values with steps of a half and of a quarter."""
    return {
        owner: {
            name: number + (number - fine[owner][name]) / 3
            for name, number in quantities.items()
            if isinstance(number, float) and isinstance(fine[owner].get(name), float)
        }
        for owner, quantities in finest.items()
    }


SHORT, LONG = PASSAGES[:2], PASSAGES[2:4]
CALIBRATIONS: dict[str, tuple[Callable[[Case], Calibration], Sequence[str]]] = {
    "start": (calibrate_start, SHORT),
    "run-in": (calibrate_run_in, LONG),
    "section": (calibrate_section, LONG),
    "discretisation": (calibrate_discretisation, PASSAGES),
}
"""Calibration of each component, and its cases."""


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("component", choices=CALIBRATIONS)
    parser.add_argument("cases", nargs="*", metavar="CASE", help="default: all cases of the component")
    options = parser.parse_args()
    calibrate, default = CALIBRATIONS[options.component]
    begin, total = time.process_time(), Calibration({})
    for name in options.cases or default:
        (case,) = (case for case in select_cases([name]) if case.id == name)
        found = calibrate(case)
        found.print_table()
        total = total.join(found)
    total.print_summary()
    print(f"\n{time.process_time() - begin:.0f} s of process time.")


if __name__ == "__main__":
    main()
