"""Run of a case on the reference simulator: passage, simulation and record."""

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from itertools import count
from typing import TypeVar

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.cases.start_and_section import RunStart
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.step_log import ShareCallback, ignore_progress
from pantocheck.conformance.quantities.line_signals import UPLIFT_STRETCH_M
from pantocheck.conformance.records.record import Record, name_outputs
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.case_facts_format import FmuRun
from pantocheck.conformance.runs.core_requirement import announce_compilation, require_core
from pantocheck.conformance.runs.fmu_process import describe_coupling, open_fmu
from pantocheck.conformance.runs.passages_together import GATE
from pantocheck.conformance.runs.uplift_tuning import (
    TuningFailed,
    build_pantographs,
    compute_working_height,
    estimate_uplift_forces,
    tune_uplift,
)
from pantocheck.model import Pantograph
from pantocheck.model.description.catenary import Catenary
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.drop_values import FreeDecay, MassDropSetup
from pantocheck.model.dynamics.passage import ForeignPantograph, FrameRequest, Frames, History, Passage
from pantocheck.model.statics.contact_wires import touched_wires

Item = TypeVar("Item")

KEPT_SPANS = 1.5
"""Smallest distance behind the train with known uplift at the end of a run [spans]: the check of the support passing
shifts the pantographs by 1.2 spans."""


@dataclass(frozen=True)
class PassageRun:
    """Simulated passage of a case."""

    record: Record
    """Record of the passage."""
    run: RunTable
    """Simulated time, computing time, time step and element length."""
    uplift_forces: tuple[float, ...]
    """Uplift force of every pantograph [N]."""
    fmus: tuple[FmuRun, ...] = ()
    """FMUs that moved pantographs."""
    outputs: Mapping[str, RealArray] = field(default_factory=dict)
    """Recorded outputs of FMUs, (n,) each, by their names in a record."""
    frames: Frames | None = None
    """Requested frames of a moving picture."""


def run_passage(
    case: Case,
    line: DiscretisedLine,
    discretisation: Discretisation,
    uplift_forces: tuple[float, ...] | None = None,
    progress: ShareCallback = ignore_progress,
    start_forces: tuple[float, ...] = (),
    frames: FrameRequest | None = None,
) -> PassageRun:
    """Simulate the passage of a case on a discretised line.

    Args:
        case: Case with a speed.
        line: Line of the case, discretised with the element length of `discretisation`.
        discretisation: Element length and time step.
        uplift_forces: Uplift force of every pantograph [N]; default: forces of the case, tuned if a mean contact force
            is required.
        progress: Called from time to time with the completed share, 0 to 1. The number of runs of a tuning is not
            known: each is half of the rest.
        start_forces: Uplift force of every pantograph at the start of its tuning [N]; empty: that of the case.
        frames: Request of the frames of a moving picture.

    Returns:
        Record, run facts and uplift forces.

    Raises:
        TuningFailed: No uplift force gives the mean contact force that the case requires.
    """
    predicted = zip(start_forces, case.lift_forces, strict=False)
    start = uplift_forces or tuple(
        force if lift.target_mean_force is not None else lift.uplift_force for force, lift in predicted
    )
    start = start or estimate_uplift_forces(case, line)
    # The computing time must not include the compilation of the kernels: one time step compiles all of them.
    first_step = replace(build_passage(case, line, discretisation, start), duration=discretisation.time_step_s)
    integrate_passage(line, first_step)
    targets = [None if uplift_forces else lift.target_mean_force for lift in case.lift_forces]
    for table, target in zip((file.fmu for file in case.pantographs), targets, strict=True):
        if table is not None and table.uplift_force_N is None and target is not None:
            raise TuningFailed(f"FMU '{table.file}' names no variable of the uplift force, which the case tunes")
    shares = _halve_rest(progress) if any(targets) else iter([progress])
    return tune_uplift(
        lambda forces: _run_once(case, line, discretisation, forces, next(shares), frames),
        lambda passage_run: _mean_forces(case, passage_run.record),
        start,
        targets,
    )


def _halve_rest(progress: ShareCallback) -> Iterator[ShareCallback]:
    """Progress of the runs of a tuning: the first covers half of the whole, each further one half of the rest."""

    def follow(run: int) -> ShareCallback:
        return lambda share: progress(1 - 0.5**run * (1 - 0.5 * share))

    return map(follow, count())


def run_starts(
    starts: Sequence[RunStart],
    line: DiscretisedLine,
    discretisation: Discretisation,
    uplift_forces: tuple[float, ...],
    progress: ShareCallback = ignore_progress,
) -> list[Record]:
    """Simulate the passages of a case from other starts, together if it has no FMU; parameters as in `run_passage`."""
    passages = [
        replace(build_passage(start.case, line, discretisation, uplift_forces), ramp=start.ramp_s) for start in starts
    ]
    if starts and starts[0].case.fmus:
        histories = [
            _integrate(start.case, line, passage, uplift_forces, progress)[0]
            for start, passage in zip(starts, passages, strict=True)
        ]
    else:
        histories = integrate_passages(line, passages, progress)
    return [
        record_passage(start.case, passage, history)
        for start, passage, history in zip(starts, passages, histories, strict=True)
    ]


def _run_once(
    case: Case,
    line: DiscretisedLine,
    discretisation: Discretisation,
    uplift_forces: tuple[float, ...],
    progress: ShareCallback,
    frames: FrameRequest | None,
) -> PassageRun:
    passage = replace(build_passage(case, line, discretisation, uplift_forces), frames=frames)
    begin = time.perf_counter()
    history, fmus, outputs = _integrate(case, line, passage, uplift_forces, progress)
    record = record_passage(case, passage, history)
    table = build_run_table(discretisation, passage.duration, begin)
    return PassageRun(record, table, uplift_forces, fmus, outputs, history.frames)


def _integrate(
    case: Case, line: DiscretisedLine, passage: Passage, uplift_forces: tuple[float, ...], progress: ShareCallback
) -> tuple[History, tuple[FmuRun, ...], dict[str, RealArray]]:
    """Simulate the passage of a case with its FMUs, each in a process of its own; outputs by their names in a record.

    Raises:
        FmuFailed: An FMU failed, or its coupling made energy.
    """
    with ExitStack() as processes:
        programs = [
            None
            if file.fmu is None
            else processes.enter_context(
                open_fmu(
                    file.fmu,
                    {"uplift_force_N": force, "train_speed_km_h": 3.6 * case.speed, "base_height_m": 0.0},
                    passage.time_step,
                    compute_working_height(case, line, file, force) - file.fmu.working_height_m,
                )
            )
            for file, force in zip(case.pantographs, uplift_forces, strict=True)
        ]
        history = integrate_passage(line, passage, progress, programs)
    moved, steps = [(number, fmu) for number, fmu in enumerate(programs, 1) if fmu is not None], history.time.size
    pairs = zip(moved, history.coupling, strict=True)
    runs = tuple(describe_coupling(number, fmu, coupling, steps) for (number, fmu), coupling in pairs)
    return history, runs, name_outputs((number, fmu.list_outputs(steps)) for number, fmu in moved)


def build_run_table(discretisation: Discretisation, simulated_s: float, begin: float) -> RunTable:
    """Run facts of a simulation that began at `begin` on the clock `time.perf_counter` [s] and ends now."""
    wall_s = time.perf_counter() - begin
    return RunTable(
        simulated_s=simulated_s, wall_s=wall_s, dt_s=discretisation.time_step_s, element_m=discretisation.element_m
    )


def _mean_forces(case: Case, record: Record) -> RealArray:
    """Mean contact force of every pantograph over the analysis section [N]."""
    signals = RecordSignals(record, case.file.filter)
    return np.array([pantograph.delivered.mean() for pantograph in signals.pantographs.values()])


def build_passage(
    case: Case, line: DiscretisedLine, discretisation: Discretisation, uplift_forces: tuple[float, ...]
) -> Passage:
    """Passage of a case on a discretised line, with given uplift forces [N]."""
    return _place_train(case, line, discretisation, build_pantographs(case, line, uplift_forces))


def _place_train(
    case: Case, line: DiscretisedLine, discretisation: Discretisation, pantographs: tuple[Pantograph, ...]
) -> Passage:
    """Passage of given pantographs from the start of a case to its end."""
    duration = (case.end - case.start) / case.speed
    return Passage(
        pantographs=pantographs,
        start=case.start_positions,
        speed=case.speed,
        duration=duration,
        time_step=discretisation.time_step_s,
        watched=_watched_supports(case, line),
        kept_behind=max(KEPT_SPANS * case.line.geometry.longest_span, UPLIFT_STRETCH_M),
        reach=math.inf if discretisation.reach_m is None else discretisation.reach_m,
    )


def list_start_forces(case: Case) -> tuple[float, ...]:
    """Uplift force of every pantograph, or start value of its tuning [N]."""
    return tuple(lift.uplift_force for lift in case.lift_forces)


def _watched_supports(case: Case, line: DiscretisedLine) -> tuple[tuple[str, float], ...]:
    """Watched supports of the recorded section, its ends included."""
    first, last = case.recorded_section
    return watch_supports([x for x in case.line.geometry.supports if first - 1e-6 <= x <= last + 1e-6], line)


def watch_supports(supports: Iterable[float], line: DiscretisedLine) -> tuple[tuple[str, float], ...]:
    """Contact wire and position of supports [m].

    It is the first one of parallel wires; in an overlap it is the lowest wire, which the pantograph lifts.
    """
    wires = line.catenary.contact_wires
    return tuple((wires[touched_wires(line, x)[0]].name, x) for x in supports)


def record_passage(case: Case, passage: Passage, history: History) -> Record:
    """Record of the passage of a case."""
    front, rear = _strip_forces(passage, history)
    return Record(
        time=history.time,
        speed=passage.speed,
        position=history.position,
        force=history.force,
        evaluated=case.analysis_section,
        contact_height=history.height,
        front_strip=front,
        rear_strip=rear,
        support_position=np.array([position for _, position in passage.watched]),
        support_uplift=history.motion[:, :, 0],
    )


def _strip_forces(passage: Passage, history: History) -> tuple[RealArray, RealArray] | tuple[None, None]:
    """Forces of front and rear strip; none if no pantograph has two strips. A single strip is the front one."""
    counts = [len(pantograph.strips) for pantograph in passage.pantographs]
    if max(counts) == 1:
        return None, None
    front = history.strip_force[np.cumsum([0, *counts[:-1]])]
    return front, history.force - front


# Compiled simulations of the model. They need the core in C or the extra `simulator`; the first simulation loads them.
def integrate_passage(
    line: DiscretisedLine,
    passage: Passage,
    progress: Callable[[float], None] | None = None,
    programs: Sequence[ForeignPantograph | None] = (),
) -> History:
    """Simulate a passage; parameters and errors as in `model.simulate_passage`.

    Raises:
        InputError: There is no core.
    """
    require_core("passage simulation")
    from pantocheck.model.dynamics.simulation import simulate_passage

    gate = GATE.get()
    if gate is not None and passage.frames is None and not any(programs):
        return gate.simulate(line, passage)
    return simulate_passage(line, passage, progress, programs)


def integrate_passages(
    line: DiscretisedLine, passages: Sequence[Passage], progress: ShareCallback = ignore_progress
) -> list[History]:
    """Simulate passages on one line together; parameters and errors as in `model.dynamics.lanes.simulate_passages`."""
    require_core("passage simulation")
    from pantocheck.model.dynamics.lanes import simulate_passages

    return simulate_passages(line, passages, progress)


def split_passages(line: DiscretisedLine, items: Sequence[Item]) -> list[Sequence[Item]]:
    """Split items, each with one passage on a line, into groups that are simulated together."""
    from pantocheck.model.dynamics.lanes import split_into_lanes

    return split_into_lanes(line, items)


def integrate_mass_drop(
    catenary: Catenary, element_length: float, test: MassDropSetup, progress: Callable[[float], None] | None = None
) -> FreeDecay:
    """Simulate a mass drop; parameters and errors as in `model.dynamics.mass_drop.simulate_mass_drop`.

    Raises:
        InputError: There is no core.
    """
    require_core("drop simulation")
    announce_compilation()
    from pantocheck.model.dynamics.mass_drop import simulate_mass_drop

    return simulate_mass_drop(catenary, element_length, test, progress)
