"""Running cases on a system: side by side, in the order their requirements allow, one failure at a time."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from types import FrameType

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.grading.case_grading import build_ungraded, grade_case
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.results.results_building import build_results, utc_now
from pantocheck.conformance.results.results_format import CaseResult, Results, SystemIdentity
from pantocheck.conformance.studies.study_dispatch import run_study
from pantocheck.conformance.systems.system import System

Progress = Callable[[CaseResult], None]


class RunInterrupted(Exception):
    """The user stopped a run: what was finished is kept, or the minutes spent on it would be lost.

    Parameters
    ----------
    results
        Of all cases; those that were not finished are skipped with this reason.
    """

    def __init__(self, results: Results) -> None:
        super().__init__("interrupted")
        self.results = results


def run_cases(
    cases: Sequence[Case], system: System, trust: Trust = "secondary", jobs: int = 1, progress: Progress | None = None
) -> Results:
    """Run cases on a system and grade them.

    Parameters
    ----------
    cases : Sequence[Case]
        With unique ids.
    system : System
        Under test.
    trust : Trust
        Lowest trust of the limits that carry a verdict.
    jobs : int
        Processes at work side by side; with 1, all is done in this process.
    progress : Progress or None
        Called with each result as it is finished.

    Returns
    -------
    Results
        Results in the order of `cases`, whatever was finished first.

    Raises
    ------
    RunInterrupted
        On KeyboardInterrupt, with what was finished.
    """
    started = utc_now()
    finished: dict[str, CaseResult] = {}

    def keep(result: CaseResult) -> None:
        finished[result.id] = result
        if progress is not None:
            progress(result)

    try:
        if jobs == 1:
            for case in _ordered(cases):
                keep(run_when_ready(case, system, trust, finished, cases))
        else:
            _run_side_by_side(cases, system, trust, jobs, finished, keep)
    except KeyboardInterrupt:
        for case in cases:
            if case.id not in finished:
                finished[case.id] = build_ungraded(
                    case, "skip", "the run was interrupted before this case was finished"
                )
        raise RunInterrupted(_results(cases, system, trust, started, finished)) from None
    return _results(cases, system, trust, started, finished)


def run_case(case: Case, system: System, trust: Trust) -> CaseResult:
    """Run one case and grade it; what its system raises ends as `error` with one line, so that the others go on."""
    try:
        return grade_case(case, run_study(case, system), trust)
    except Exception as error:
        text = " ".join(str(error).split())[:300]
        return build_ungraded(case, "error", f"{type(error).__name__}: {text}" if text else type(error).__name__)


def run_when_ready(
    case: Case, system: System, trust: Trust, finished: dict[str, CaseResult], cases: Sequence[Case]
) -> CaseResult:
    """Run one of several cases if those it requires have not failed; else it is skipped."""
    return _after_requirements(case, finished, cases) or run_case(case, system, trust)


def _ordered(cases: Sequence[Case]) -> list[Case]:
    """Cases with those they require before them; the order asked otherwise."""
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


def _after_requirements(case: Case, finished: dict[str, CaseResult], cases: Sequence[Case]) -> CaseResult | None:
    """The result of a case whose requirements are not met; None if it can run.

    A requirement that the system under test does not offer is no obstacle: a record of a run says nothing of the line
    at rest, and is graded all the same.
    """
    by_id = {one.id: one for one in cases}
    seen: set[str] = set()
    waiting = list(case.file.requires)
    while waiting:
        required = waiting.pop(0)
        if required in seen:
            continue
        seen.add(required)
        if required not in finished:
            return build_ungraded(case, "skip", f"requires {required}, which was not run")
        if finished[required].verdict in {"fail", "error"}:
            return build_ungraded(case, "skip", f"requires {required}, which ended in {finished[required].verdict}")
        waiting += by_id[required].file.requires if required in by_id else ()
    return None


def _run_side_by_side(
    cases: Sequence[Case], system: System, trust: Trust, jobs: int, finished: dict[str, CaseResult], keep: Progress
) -> None:
    waiting = _ordered(cases)
    running: dict[Future[CaseResult], Case] = {}
    pool = _pool(jobs)
    try:
        while waiting or running:
            unfinished = {case.id for case in (*waiting, *running.values())}
            ready = [case for case in waiting if not unfinished & set(case.file.requires)]
            if not (ready or running):
                ready = waiting[:1]  # cases that require each other: none of them can run
            # No more cases than processes are handed over, so that a dying process takes only its neighbours along.
            for case in ready[: jobs - len(running)]:
                waiting.remove(case)
                if (blocked := _after_requirements(case, finished, cases)) is not None:
                    keep(blocked)
                else:
                    running[pool.submit(run_case, case, system, trust)] = case
            if running:
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                broken = [case for future in done for case in [running.pop(future)] if not _kept(future, keep)]
                if broken:
                    for case in (*broken, *running.values()):
                        keep(build_ungraded(case, "error", "the process of this case, or one beside it, died"))
                    running.clear()
                    pool.shutdown(wait=False)
                    pool = _pool(jobs)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _kept(future: Future[CaseResult], keep: Progress) -> bool:
    """Keep the result of a process; False if the process died."""
    try:
        keep(future.result())
    except BrokenProcessPool:
        return False
    return True


def _one_thread_each() -> None:
    """Processes side by side that each let linear algebra use every core slow each other down more than twofold.

    The libraries read this when they are loaded, so that it holds for the processes started from now on; what a user
    has set stays.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")


def _pool(jobs: int) -> Executor:
    # A fresh interpreter each: threads of a compiled kernel do not survive a fork.
    _one_thread_each()
    return ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _die_quietly)


def _die_quietly() -> None:
    """In a worker: Ctrl-C reaches all processes at once, and only the first of them has something to say."""
    signal.signal(signal.SIGINT, _leave)


def _leave(number: int, frame: FrameType | None) -> None:
    # An exception, so that a system can end what it started before this process ends.
    raise SystemExit(128 + number)


def _results(
    cases: Sequence[Case], system: System, trust: Trust, started: str, finished: dict[str, CaseResult]
) -> Results:
    identity = SystemIdentity(name=system.name, version=system.version, kind=system.kind)
    return build_results([finished[case.id] for case in cases], identity, trust, started)
