"""The reference simulator as a system under test, in process."""

import time
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import Literal

import numpy as np
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.evaluation import Value
from pantocheck.conformance.record import Record
from pantocheck.conformance.systems import Outcome
from pantocheck.conformance.systems.line_model import catenary
from pantocheck.conformance.systems.passage import pantograph, starts, watched_supports
from pantocheck.model import Discretised, History, Passage, discretise, run
from pantocheck.model.beam import wave_speed
from pantocheck.model.simulation import causal_reach
from pantocheck.model.statics import non_uniformity, static_uplift

SAMPLES_PER_SPAN = 24
"""Places along a span at which static quantities are taken."""
MEAN_FORCE_TOLERANCE = 0.02
"""The tuned mean contact force is this close to its target [N]."""
MOST_TUNING_RUNS = 12


class NotTuned(ArithmeticError):
    """The uplift force that gives the target mean was not found; grading another mean would compare the wrong run."""


@dataclass(frozen=True)
class ReferenceSimulator:
    """Runs a case at its own discretisation and, for the discretisation error, with both steps halved."""

    name: str = "Pantocheck reference simulator"
    version: str = version("pantocheck")
    kind: Literal["builtin"] = "builtin"

    def run(self, case: Case) -> Outcome:
        """Run a case."""
        steps = case.file.discretisation
        coarse, uplift_forces = self._run_once(case, steps.element_m, steps.time_step_s, None)
        fine, _ = self._run_once(case, steps.element_m / 2, steps.time_step_s / 2, uplift_forces)
        return replace(coarse, refined=fine)

    def run_unrefined(self, case: Case) -> Outcome:
        """Run a case once, at its own discretisation."""
        steps = case.file.discretisation
        return self._run_once(case, steps.element_m, steps.time_step_s, None)[0]

    def _run_once(
        self, case: Case, element: float, step: float, uplift_forces: tuple[float, ...] | None
    ) -> tuple[Outcome, tuple[float, ...]]:
        line = discretise(catenary(case.line), element)
        outcome = Outcome(static=_static_quantities(case, line), dt_s=step, element_m=element)
        if case.is_static:
            return outcome, ()
        forces = uplift_forces or _tuned(case, line, step)
        passage = passage_of(case, line, step, forces)
        run(line, replace(passage, duration=0.0))  # compiles the kernels, which is not part of the run
        begin = time.perf_counter()
        history = run(line, passage)
        wall = time.perf_counter() - begin
        return replace(
            outcome, record=record_of(case, passage, history), simulated_s=passage.duration, wall_s=wall
        ), forces


def passage_of(case: Case, line: Discretised, step: float, uplift_forces: tuple[float, ...]) -> Passage:
    """The passage of a case with given uplift forces, on a line that is discretised already."""
    models = []
    for file, force in zip(case.pantographs, uplift_forces, strict=True):
        height = float(static_uplift(line, _along_span(case), force).mean()) + force / file.contact.stiffness_N_m
        models.append(pantograph(file, force, height))
    duration = (case.end - case.start) / case.speed
    return Passage(
        pantographs=tuple(models),
        start=starts(case),
        speed=case.speed,
        duration=duration,
        time_step=step,
        watched=watched_supports(case, line),
        reach=causal_reach(line, case.speed, duration),
    )


def _along_span(case: Case) -> np.ndarray:
    """Places along the first evaluated span."""
    start, span = case.evaluated[0], case.line.geometry.span_m
    return start + span * np.arange(SAMPLES_PER_SPAN) / SAMPLES_PER_SPAN


def _tuned(case: Case, line: Discretised, step: float) -> tuple[float, ...]:
    """Uplift forces with which every mean over the evaluated spans meets its target, if it has one."""
    uses = case.file.pantograph
    forces = np.array([use.uplift_force_N or use.target_mean_force_N or 0.0 for use in uses])
    if not any(use.target_mean_force_N for use in uses):
        return tuple(map(float, forces))
    for _ in range(MOST_TUNING_RUNS):
        passage = passage_of(case, line, step, tuple(map(float, forces)))
        record = record_of(case, passage, run(line, passage))
        inside = (record.position >= record.evaluated[0]) & (record.position <= record.evaluated[1])
        means = [force[here].mean() for force, here in zip(record.force, inside, strict=True)]
        # The mean follows the uplift force nearly one to one: what is missing is added.
        missing = np.array([(u.target_mean_force_N or m) - m for u, m in zip(uses, means, strict=True)])
        if np.abs(missing).max() < MEAN_FORCE_TOLERANCE:
            return tuple(map(float, forces))
        forces = forces + missing
    raise NotTuned(f"the mean contact force is still {np.abs(missing).max():.2f} N off its target")


def record_of(case: Case, passage: Passage, history: History) -> Record:
    """The record of a case's passage."""
    return Record(
        time=history.time,
        speed=passage.speed,
        position=history.position,
        force=history.force,
        evaluated=case.evaluated,
        contact_height=history.height,
        support_position=np.array([position for _, position in passage.watched]),
        support_uplift=history.motion[:, :, 0],
    )


def _static_quantities(case: Case, line: Discretised) -> dict[str, Value]:
    geometry, wire = case.line.geometry, case.line.contact_wire
    middle = geometry.spans // 2
    droppers = [i for i, d in enumerate(line.catenary.droppers) if d.position // geometry.span_m == middle]
    elasticity = static_uplift(line, middle * geometry.span_m + _fractions(geometry.span_m), 1.0)
    return {
        "presag_mm": tuple(0.0 - 1e3 * (line.catenary.droppers[i].contact_wire_height or 0.0) for i in droppers),
        "dropper_length_m": tuple(float(line.state.dropper_length[i]) for i in droppers),
        "elasticity_mm_N": float(1e3 * elasticity.max()),
        "elasticity_non_uniformity_pct": 100 * non_uniformity(elasticity),
        "wave_speed_m_s": wave_speed(wire.tension_N, wire.mass_kg_m),
    }


def _fractions(span: float) -> np.ndarray:
    return span * np.arange(SAMPLES_PER_SPAN) / SAMPLES_PER_SPAN
