"""Reference simulator as a system under test, in the same process."""

import logging
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from functools import partial
from importlib.metadata import version
from itertools import islice
from threading import Event
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.cases.start_and_section import RunStart, list_other_starts
from pantocheck.conformance.core.step_log import ShareCallback, StepSequence, ignore_progress
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.line.line_parameters import list_tolerance_lines
from pantocheck.conformance.line.line_shape import build_line_shape
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.runs.case_run import run_passage, run_starts, split_passages
from pantocheck.conformance.runs.core_requirement import COMPILATION, announce_compilation, require_core
from pantocheck.conformance.runs.passage_motion import code_frames, plan_frames
from pantocheck.conformance.runs.resolution import (
    list_mesh_frequencies,
    list_model_uncertainty,
    resolution_warnings,
    window_warnings,
)
from pantocheck.conformance.runs.static_quantities import compute_quantities_along_line, compute_static_quantities
from pantocheck.conformance.runs.system import Delivered
from pantocheck.model import Catenary, discretise
from pantocheck.model.description.failures import SimulationError
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.passage import FrameRequest, Frames

_LOGGER = logging.getLogger(__name__)

OWN_MESH, FINE_MESH, COARSE_MESH = "mesh of the case", "mesh halved", "mesh doubled"
"""Steps of a case."""
OTHER_RUNS = "other meshes and starts"
"""Name of the steps after the first one together, on several threads."""
AT_REST_S = 4.0
"""Simulated time that takes as long as the static quantities of a line [s]."""

Task = Callable[[ShareCallback], Sequence[Delivered]]
"""Runs of a case on another mesh, or from other starts together."""
StepNames = tuple[str, ...]
"""Names of the steps of a task."""


@dataclass(frozen=True)
class ReferenceSimulator:
    """System that runs a case and, for its uncertainty, the case on two other meshes and from other starts."""

    name: str = "Pantocheck reference simulator"
    version: str = version("pantocheck")
    kind: Literal["builtin"] = "builtin"
    threads: int = 1
    """Number of threads on which the other meshes and starts of a case run; the results do not depend on it."""
    start_forces: tuple[float, ...] = ()
    """Uplift force of every pantograph at the start of its tuning in a run alone [N]; empty: that of the case."""

    def __post_init__(self) -> None:
        """Require the core of the time steps at once: later, each case would end as `error`."""
        require_core("reference simulator")

    def run(self, case: Case) -> Delivered:
        """Run a case, with element length and time step halved and doubled, and from other starts."""
        discretisation, steps = case.file.discretisation, _plan_steps(case)
        delivered, uplift_forces = self._run_drawn(case, steps)
        line = discretise_line(case.line, discretisation.element_m)
        tasks: dict[StepNames, Task] = {
            (FINE_MESH,): partial(_deliver_again, case, discretisation.scale(1 / 2), uplift_forces),
            (COARSE_MESH,): partial(_deliver_coarse, case, discretisation.scale(2), uplift_forces),
        }
        if uplift_forces is not None:
            named = [(name_start(number), start) for number, start in enumerate(list_other_starts(case), 1)]
            groups = [[start] for start in named] if case.fmus else split_passages(line, named)
            tasks |= {
                tuple(name for name, _ in group): partial(
                    _deliver_starts, [start for _, start in group], line, discretisation, uplift_forces
                )
                for group in groups
            }
            tasks |= {
                (name_line(number),): partial(_deliver_line, case, catenary, uplift_forces)
                for number, catenary in enumerate(list_tolerance_lines(case.line), 1)
            }
        threads = 1 if case.fmus else self.threads  # the end of a process ends those that began after it
        found = dict(zip(tasks, _run_tasks(tasks, steps, threads), strict=True))
        starts, lines = (
            tuple(run for names, runs in found.items() if names[0].startswith(kind) for run in runs)
            for kind in ("start", "line")
        )
        (refined,), coarse = found[FINE_MESH,], next(iter(found[COARSE_MESH,]), None)
        return replace(delivered, refined=refined, coarse=coarse, starts=starts, changed_lines=lines)

    def _run_drawn(self, case: Case, steps: StepSequence) -> tuple[Delivered, tuple[float, ...] | None]:
        """Run a case once; result with shape and motion of the line, and uplift forces of its passage [N]."""
        discretisation = case.file.discretisation
        line = discretise_line(case.line, discretisation.element_m)
        shape = build_line_shape(case.line, case.analysed_spans, line)
        stretch = None if case.is_static else plan_frames(case, line, shape, discretisation)
        request = None if stretch is None else stretch.request
        progress = _begin_run(case, steps)
        delivered, uplift_forces, frames = _deliver(case, discretisation, None, progress, self.start_forces, request)
        motion = None
        if stretch is not None and frames is not None and delivered.record is not None:
            motion = code_frames(case, line, stretch, frames, delivered.record)
        return replace(delivered, line_shape=shape, motion=motion), uplift_forces

    def run_unrefined(self, case: Case, follow: ShareCallback = ignore_progress) -> Delivered:
        """Run a case once, with the discretisation of the case.

        Args:
            case: Case to run.
            follow: Also receives the completed share; its exception ends the run.
        """
        progress = _begin_run(case, StepSequence(_LOGGER, case.id, {COMPILATION: 0.0, OWN_MESH: 1.0}))

        def report(share: float) -> None:
            follow(share)
            progress(share)

        return _deliver(case, case.file.discretisation, progress=report, start_forces=self.start_forces)[0]


@dataclass(frozen=True)
class UnrefinedSimulator(ReferenceSimulator):
    """Reference simulator that runs a case once: the uncertainty of discretisation stays unknown."""

    def run(self, case: Case) -> Delivered:
        """Run a case once, with the discretisation of the case."""
        return self.run_unrefined(case)


@dataclass(frozen=True)
class SimulatorWithMotion(ReferenceSimulator):
    """Reference simulator that runs a case once, with its moving picture."""

    def run(self, case: Case) -> Delivered:
        """Run a case once, with the discretisation of the case."""
        return self._run_drawn(case, StepSequence(_LOGGER, case.id, {COMPILATION: 0.0, OWN_MESH: 1.0}))[0]


def _plan_steps(case: Case) -> StepSequence:
    """Steps of a case, with their estimated durations in passages on the mesh of the case."""
    other_starts = () if case.is_static else list_other_starts(case)
    starts = {name_start(number): 1.0 for number, _ in enumerate(other_starts, 1)}
    lines = [] if case.is_static else list_tolerance_lines(case.line)
    starts |= {name_line(number): 1.0 for number, _ in enumerate(lines, 1)}
    tuned = any(lift.target_mean_force is not None for lift in case.lift_forces)
    return StepSequence(
        _LOGGER,
        case.id,
        {COMPILATION: 0.0, OWN_MESH: 4.0 if tuned else 2.0, FINE_MESH: 4.0, COARSE_MESH: 0.25, **starts},
    )


def estimate_work(case: Case) -> float:
    """Work of a case and of its further runs: time steps x elements x pantographs x meshes and starts, 1e6 of them.

    A coarse mesh counts less, a fine one more. A line at rest counts like a short passage.
    """
    discretisation = case.file.discretisation
    simulated = AT_REST_S if case.is_static else (case.end - case.start) / case.speed
    cells = simulated / discretisation.time_step_s * case.line.geometry.length / discretisation.element_m
    return cells * max(len(case.pantographs), 1) * sum(_plan_steps(case).weights.values()) / 1e6


def _begin_run(case: Case, steps: StepSequence) -> ShareCallback:
    """Begin the run on the mesh of the case; the first run of all shows its compilation until its time steps begin."""
    progress = steps.begin(OWN_MESH)
    if not case.is_static and announce_compilation():
        steps.begin(COMPILATION)
    return progress


def name_start(number: int) -> str:
    """Name of the step of another start."""
    return f"start {number}"


def name_line(number: int) -> str:
    """Name of the step of a changed line."""
    return f"line {number}"


def _run_tasks(tasks: Mapping[StepNames, Task], steps: StepSequence, threads: int) -> list[Sequence[Delivered]]:
    """Results of independent tasks in their order; the time steps let other threads run."""
    if threads == 1:
        return [task(partial(_follow, steps.begin_together(names[0], names))) for names, task in tasks.items()]
    stopped = Event()

    def follow(callbacks: Sequence[ShareCallback], share: float) -> None:
        if stopped.is_set():
            raise SimulationError("another run of the case has failed, or the user has stopped the run")
        _follow(callbacks, share)

    callbacks = iter(steps.begin_together(OTHER_RUNS, [name for names in tasks for name in names]))
    with ThreadPoolExecutor(threads) as pool:
        try:
            futures = [
                pool.submit(task, partial(follow, list(islice(callbacks, len(names))))) for names, task in tasks.items()
            ]
            for future in wait(futures, return_when=FIRST_EXCEPTION).done:
                future.result()
            return [future.result() for future in futures]
        except BaseException:
            stopped.set()
            pool.shutdown(cancel_futures=True)
            raise


def _follow(callbacks: Sequence[ShareCallback], share: float) -> None:
    """Report the completed share of a task for each of its steps."""
    for callback in callbacks:
        callback(share)


def _deliver_line(
    case: Case, catenary: Catenary, uplift_forces: tuple[float, ...], progress: ShareCallback
) -> Sequence[Delivered]:
    """Run of a case on a changed line, at the uplift forces of the line as stated."""
    discretisation = case.file.discretisation
    line = discretise(catenary, discretisation.element_m)
    return (Delivered(run_passage(case, line, discretisation, uplift_forces, progress).record),)


def _deliver_again(
    case: Case, discretisation: Discretisation, uplift_forces: tuple[float, ...] | None, progress: ShareCallback
) -> Sequence[Delivered]:
    return (_deliver(case, discretisation, uplift_forces, progress)[0],)


def _deliver_coarse(
    case: Case, discretisation: Discretisation, uplift_forces: tuple[float, ...] | None, progress: ShareCallback
) -> Sequence[Delivered]:
    """Result on a coarse mesh; none if it is too coarse to converge: the uncertainty follows from two meshes."""
    try:
        return _deliver_again(case, discretisation, uplift_forces, progress)
    except SimulationError:
        return ()


def _deliver_starts(
    starts: Sequence[RunStart],
    line: DiscretisedLine,
    discretisation: Discretisation,
    uplift_forces: tuple[float, ...],
    progress: ShareCallback,
) -> Sequence[Delivered]:
    return [Delivered(record) for record in run_starts(starts, line, discretisation, uplift_forces, progress)]


def _deliver(
    case: Case,
    discretisation: Discretisation,
    uplift_forces: tuple[float, ...] | None = None,
    progress: ShareCallback = ignore_progress,
    start_forces: tuple[float, ...] = (),
    request: FrameRequest | None = None,
) -> tuple[Delivered, tuple[float, ...] | None, Frames | None]:
    """Simulate a case; result, uplift forces of its passage [N], and requested frames."""
    line = discretise_line(case.line, discretisation.element_m)
    static = compute_static_quantities(case, line)
    if case.is_static:
        static |= compute_quantities_along_line(case.line, line)
        return (
            Delivered(static=static, run=RunTable(dt_s=discretisation.time_step_s, element_m=discretisation.element_m)),
            None,
            None,
        )
    passage = run_passage(case, line, discretisation, uplift_forces, progress, start_forces, request)
    delivered = Delivered(
        passage.record,
        static,
        passage.run,
        warnings=(*resolution_warnings(case, discretisation), *window_warnings(case, line, discretisation)),
        model_uncertainty=list_model_uncertainty(case),
        supported=list_mesh_frequencies(case, discretisation),
        start=case.start_table,
        uplift_forces=passage.uplift_forces,
        fmus=passage.fmus,
        fmu_outputs=passage.outputs,
    )
    return delivered, passage.uplift_forces, passage.frames
