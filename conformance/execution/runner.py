"""Runner: runs cases on a system, in sequence or in parallel. An exception ends only the case that raised it."""

import logging
import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.decision import SIMPLE, DecisionRule
from pantocheck.conformance.core.figure_data import Traces
from pantocheck.conformance.core.processes import (
    adopt_orphans,
    end_workers,
    handle_worker_signals,
    interruption_exit_code,
    limit_threads,
)
from pantocheck.conformance.core.step_log import report_remote
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.execution.study_dispatch import run_study
from pantocheck.conformance.grading.case_grading import build_ungraded, grade_case
from pantocheck.conformance.grading.case_verdict import EVERY_CASE, Participation
from pantocheck.conformance.grading.results_building import build_results, utc_now
from pantocheck.conformance.records.traces import round_series
from pantocheck.conformance.results.case_facts_format import ReferenceValues
from pantocheck.conformance.results.results_format import CaseResult, Results, SystemIdentity
from pantocheck.conformance.runs.core_requirement import announce_compilation
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import System

_LOGGER = logging.getLogger(__name__)

PROCESS_DIED = "the process of this case, or of a parallel case, ended unexpectedly"
"""Reason of a case that was running when a process died."""

Progress = Callable[[CaseResult], None]
"""Callback that receives each result as soon as its case is finished."""


class RunInterrupted(Exception):
    """The user stopped a run; the results hold the finished cases, and skip the others with this reason.

    `exit_code` is 128 and the number of the signal.
    """

    def __init__(self, results: Results, exit_code: int) -> None:
        super().__init__("interrupted")
        self.results, self.exit_code = results, exit_code


def run_cases(
    cases: Sequence[Case],
    system: System,
    trust: Trust = "secondary",
    jobs: int = 1,
    progress: Progress | None = None,
    participation: Participation = EVERY_CASE,
) -> Results:
    """Run cases with unique ids on a system and grade them.

    Args:
        cases: Cases with unique ids.
        system: System under test.
        trust: Lowest trust of the limits that count.
        jobs: Number of parallel processes; 1 runs all cases in this process.
        progress: Callback for each result.
        participation: Cases shown for information, and accepted unconfirmed records.

    Raises:
        RunInterrupted: Ctrl-C, SIGTERM or SIGHUP ended the run; the exception holds the results.
    """
    started = utc_now()
    finished: dict[str, CaseResult] = {}

    def keep(result: CaseResult) -> None:
        finished[result.id] = result
        _LOGGER.info("%s: %s", result.id, result.verdict)
        if progress is not None:
            progress(result)

    def combine() -> Results:
        identity = identify_system(system)
        return build_results([finished[case.id] for case in cases], identity, trust, started, participation)

    try:
        if jobs == 1:
            for case in _order_cases(cases):
                keep(run_when_ready(case, system, trust, finished, cases, participation.decision))
        else:
            with adopt_orphans():
                _run_in_parallel(cases, system, trust, jobs, finished, keep, participation.decision)
    except KeyboardInterrupt as interruption:
        for case in cases:
            if case.id not in finished:
                reason = "the run was interrupted before this case was finished"
                finished[case.id] = build_ungraded(case, "skip", reason)
        raise RunInterrupted(combine(), interruption_exit_code(interruption)) from None
    return combine()


def identify_system(system: System) -> SystemIdentity:
    """Identity of a system in results."""
    return SystemIdentity(name=system.name, version=system.version, kind=system.kind)


def run_case(case: Case, system: System, trust: Trust, rule: DecisionRule = SIMPLE) -> CaseResult:
    """Run one case and grade it; an exception in the system becomes the verdict `error` of this case only."""
    try:
        return grade_case(case, run_study(case, system), trust, rule)
    except Exception as error:
        text = " ".join(str(error).split())[:300]
        return build_ungraded(case, "error", f"{type(error).__name__}: {text}" if text else type(error).__name__)


def run_when_ready(
    case: Case,
    system: System,
    trust: Trust,
    finished: dict[str, CaseResult],
    cases: Sequence[Case],
    rule: DecisionRule = SIMPLE,
) -> CaseResult:
    """Run one of several cases; skip it if a case that it requires failed or was not run."""
    return _check_requirements(case, finished, cases) or run_case(case, system, trust, rule)


def _order_cases(cases: Sequence[Case]) -> list[Case]:
    """Cases in the given order, except that a required case precedes the cases that require it."""
    by_id = {case.id: case for case in cases}
    ordered: dict[str, Case] = {}

    def add(case: Case, above: frozenset[str]) -> None:
        for required in case.file.requires:
            if required in by_id and required not in above:
                add(by_id[required], above | {case.id})
        ordered.setdefault(case.id, case)

    for case in cases:
        add(case, frozenset({case.id}))
    return list(ordered.values())


def _check_requirements(case: Case, finished: dict[str, CaseResult], cases: Sequence[Case]) -> CaseResult | None:
    """Result of a case whose requirements are not met; None if it can run.

    A required case that the system skips does not block: a record of a run has no quantities of the line at rest.
    """
    by_id = {other.id: other for other in cases}
    required = list(case.file.requires)
    for name in required:  # grows by the requirements of the required cases
        if name not in finished:
            return build_ungraded(case, "skip", f"requires {name}, which was not run")
        if finished[name].verdict in {"fail", "error"}:
            return build_ungraded(case, "skip", f"requires {name}, whose verdict is {finished[name].verdict}")
        if name in by_id:
            required += [other for other in by_id[name].file.requires if other not in required]
    return None


def _run_in_parallel(
    cases: Sequence[Case],
    system: System,
    trust: Trust,
    jobs: int,
    finished: dict[str, CaseResult],
    keep: Progress,
    rule: DecisionRule,
) -> None:
    if system.kind == "builtin":
        announce_compilation()
    waiting = _order_cases(cases)
    running: dict[Future[CaseResult], Case] = {}
    others = set(multiprocessing.active_children())
    pool, broken = _start_pool(jobs), False
    try:
        while waiting or running:
            unfinished = {case.id for case in (*waiting, *running.values())}
            ready = [case for case in waiting if not unfinished & set(case.file.requires)]
            if not (ready or running):
                ready = waiting[:1]  # cases that require each other: none of them can run
            # At most one case per process is submitted: a process that dies loses only the cases that are running.
            for case in ready[: jobs - len(running)]:
                if (skipped := _check_requirements(case, finished, cases)) is not None:
                    keep(skipped)
                elif (future := _submit(pool, case, system, trust, rule)) is None:
                    broken = True
                    break
                else:
                    running[future] = case
                    report_remote(_LOGGER, case.id)
                waiting.remove(case)
            lost = _keep_finished(running, keep) if running else []
            if lost or broken:
                for case in (*lost, *running.values()):
                    keep(build_ungraded(case, "error", PROCESS_DIED))
                running.clear()
                pool.shutdown(wait=False)
                pool, broken = _start_pool(jobs), False
    except KeyboardInterrupt:
        end_workers(set(multiprocessing.active_children()) - others)
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _submit(pool: Executor, case: Case, system: System, trust: Trust, rule: DecisionRule) -> Future[CaseResult] | None:
    """Submit a case to a process; None if a process has died since the last result, so that a new pool is needed."""
    try:
        return pool.submit(run_case, case, system, trust, rule)
    except BrokenProcessPool:
        return None


def _keep_finished(running: dict[Future[CaseResult], Case], keep: Progress) -> list[Case]:
    """Wait for a result and keep every finished one; returns the cases whose process died."""
    lost = []
    for future in wait(running, return_when=FIRST_COMPLETED).done:
        case = running.pop(future)
        try:
            keep(future.result())
        except BrokenProcessPool:
            lost.append(case)
    return lost


def _start_pool(jobs: int) -> Executor:
    """Start processes with one thread of linear algebra each."""
    limit_threads()
    # Fresh interpreters: threads of a compiled kernel do not survive a fork.
    return ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), handle_worker_signals)


# Merging of the values of the reference simulator into the results of another system.
def merge_reference(results: Results, reference: Results) -> Results:
    """Results with the values of the reference simulator under the key `reference`; no verdict changes.

    A case that the reference simulator did not run keeps its content.
    """
    by_id = {case.id: case for case in reference.cases}
    cases = [
        case.model_copy(update={"reference": _select_values(case, by_id[case.id], reference)})
        if case.id in by_id
        else case
        for case in results.cases
    ]
    return results.model_copy(update={"cases": cases})


def _select_values(case: CaseResult, run: CaseResult, reference: Results) -> ReferenceValues:
    """Values of the reference for one case."""
    return ReferenceValues(
        name=reference.system.name,
        version=reference.system.version,
        reason=None if run.quantities else run.reason or "the reference simulator has no values of this case",
        quantities=run.quantities,
        uncertainty=run.uncertainty,
        force_20_N={
            owner: force
            for owner, trace in case.traces.items()
            if owner in run.traces and (force := _place_force(trace, run.traces[owner]))
        },
    )


def _place_force(trace: Traces, reference: Traces) -> list[float]:
    """Filtered force of the reference at the positions of a trace [N]; empty where the sections differ."""
    x, known = np.array(trace.position_m), np.array(reference.position_m)
    if reference.force_20_N is None or not x.size or not known.size or x[0] >= known[-1] or x[-1] <= known[0]:
        return []
    return round_series(np.interp(x, known, np.array(reference.force_20_N)))


# Run of the reference simulator beside a system under test, for information.
def add_reference(results: Results, cases: Sequence[Case], jobs: int, progress: Progress | None = None) -> Results:
    """Run the cases on the reference simulator, and add its values to the results of another system.

    Raises:
        RunInterrupted: The user stopped the run; the exception holds the results of the system, with the values of the
            finished cases.
    """
    try:
        reference = run_cases(cases, ReferenceSimulator(), results.trust, jobs, progress)
    except RunInterrupted as interruption:
        raise RunInterrupted(merge_reference(results, interruption.results), interruption.exit_code) from None
    return merge_reference(results, reference)
