"""Calibration of the component `discretisation`: values extrapolated from elements and time steps of a quarter."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.grading.case_uncertainty import discretisation_component
from pantocheck.conformance.quantities.evaluation import Evaluation, ValuesByOwner
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.simulation.case_run import run_passage
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.model import discretise
from verification.tables.calibration import Calibration, build_calibration


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
    evaluation = evaluate_record(run.record, case.file.filter.low_pass, case.line.geometry.supports)
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
