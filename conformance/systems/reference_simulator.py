"""The reference simulator as a system under test, in process."""

import time
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import Literal

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.records.evaluation import pantograph_signals
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_sidecar import RunTable
from pantocheck.conformance.results.outcome import Delivered
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.pantograph_model import build_pantograph, start_positions, watched_supports
from pantocheck.conformance.simulation.static_quantities import compute_static_quantities, sample_span
from pantocheck.conformance.simulation.uplift_tuning import tune_uplift
from pantocheck.model import DiscretisedLine, History, Passage, discretise, simulate_passage
from pantocheck.model.dynamics.active_window import causal_reach
from pantocheck.model.statics.elasticity import static_uplift


@dataclass(frozen=True)
class PassageRun:
    """One run of a case: its record, and what it took to make it.

    Parameters
    ----------
    record : Record
        Of the run.
    simulated_s, wall_s : float
        Time that was simulated, and that it took [s].
    """

    record: Record
    simulated_s: float
    wall_s: float


@dataclass(frozen=True)
class ReferenceSimulator:
    """Runs a case at its own discretisation and, for the discretisation error, with both steps halved."""

    name: str = "Pantocheck reference simulator"
    version: str = version("pantocheck")
    kind: Literal["builtin"] = "builtin"

    def run(self, case: Case) -> Delivered:
        """Run a case."""
        steps = case.file.discretisation
        coarse, uplift_forces = _outcome(case, steps.element_m, steps.time_step_s)
        fine, _ = _outcome(case, steps.element_m / 2, steps.time_step_s / 2, uplift_forces)
        return replace(coarse, refined=fine)

    def run_unrefined(self, case: Case) -> Delivered:
        """Run a case once, at its own discretisation."""
        steps = case.file.discretisation
        return _outcome(case, steps.element_m, steps.time_step_s)[0]


def _outcome(
    case: Case, element: float, step: float, uplift_forces: tuple[float, ...] | None = None
) -> tuple[Delivered, tuple[float, ...]]:
    return run_line(case, discretise(build_catenary(case.line), element), element, step, uplift_forces)


def run_line(
    case: Case, line: DiscretisedLine, element: float, step: float, uplift_forces: tuple[float, ...] | None = None
) -> tuple[Delivered, tuple[float, ...]]:
    """Run a case on a line that is discretised already.

    Parameters
    ----------
    case : Case
        To run.
    line : DiscretisedLine
        Its line.
    element, step : float
        Length of an element [m] and time step [s], as reported.
    uplift_forces : tuple[float, ...] or None
        Of the pantographs [N]; None: those of the case, tuned if it asks for a mean.

    Returns
    -------
    tuple[Delivered, tuple[float, ...]]
        Outcome, uplift forces.
    """
    static, run = compute_static_quantities(case, line), RunTable(dt_s=step, element_m=element)
    if case.is_static:
        return Delivered(static=static, run=run), ()
    uses = case.file.pantograph
    begin = uplift_forces or tuple(use.uplift_force_N or use.target_mean_force_N or 0.0 for use in uses)
    simulate_passage(
        line, replace(build_passage(case, line, step, begin), duration=0.0)
    )  # compiles the kernels, not part of the run
    made, forces = tune_uplift(
        lambda forces: _run(case, line, step, forces),
        lambda made: _means(case, made),
        begin,
        [None if uplift_forces else use.target_mean_force_N for use in uses],
    )
    run = run.model_copy(update={"simulated_s": made.simulated_s, "wall_s": made.wall_s})
    return Delivered(made.record, static, run), forces


def _run(case: Case, line: DiscretisedLine, step: float, uplift_forces: tuple[float, ...]) -> PassageRun:
    passage = build_passage(case, line, step, uplift_forces)
    begin = time.perf_counter()
    history = simulate_passage(line, passage)
    return PassageRun(record_passage(case, passage, history), passage.duration, time.perf_counter() - begin)


def _means(case: Case, made: PassageRun) -> RealArray:
    """Mean contact force of every pantograph over the samples that are graded [N]."""
    low_pass, numbers = case.file.filter.low_pass, range(1, made.record.pantographs + 1)
    return np.array([pantograph_signals(made.record, i, low_pass).delivered.mean() for i in numbers])


def build_passage(case: Case, line: DiscretisedLine, step: float, uplift_forces: tuple[float, ...]) -> Passage:
    """The passage of a case with given uplift forces, on a line that is discretised already."""
    first_span = (case.file.evaluated_spans or (1,))[0]
    positions = sample_span(*case.line.geometry.span(first_span))
    models = []
    for file, force in zip(case.pantographs, uplift_forces, strict=True):
        height = float(static_uplift(line, positions, force).mean()) + force / file.contact.stiffness_N_m
        models.append(build_pantograph(file, force, height))
    duration = (case.end - case.start) / case.speed
    wanted = case.file.discretisation.reach_m
    causal = causal_reach(line, case.speed, duration)
    return Passage(
        pantographs=tuple(models),
        start=start_positions(case),
        speed=case.speed,
        duration=duration,
        time_step=step,
        watched=watched_supports(case, line),
        reach=causal if wanted is None else min(wanted, causal),
    )


def record_passage(case: Case, passage: Passage, history: History) -> Record:
    """The record of a case's passage."""
    return Record(
        time=history.time,
        speed=passage.speed,
        position=history.position,
        force=history.force,
        evaluated=case.analysis_section,
        contact_height=history.height,
        support_position=np.array([position for _, position in passage.watched]),
        support_uplift=history.motion[:, :, 0],
    )
