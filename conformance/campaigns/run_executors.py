"""Executors of the runs of a campaign: processes on this machine, or a cluster of Dask."""

import multiprocessing
import os
import time
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby, islice
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Protocol

from pantocheck.conformance.campaigns.campaign_design import PlannedRun
from pantocheck.conformance.campaigns.campaign_file import ClusterKind, Execution
from pantocheck.conformance.campaigns.campaign_run import RunRow, build_failed_row
from pantocheck.conformance.core.dask_client import connect_client
from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.processes import (
    adopt_orphans,
    delay_garbage_searches,
    end_workers,
    handle_worker_signals,
    limit_threads,
)
from pantocheck.conformance.runs.passages_together import most_together, run_together

Execute = Callable[[PlannedRun], RunRow]
"""Function that executes one run; it can be sent to other processes."""

MOST_ATTEMPTS = 5
"""Largest number of times that a run is started whose process ends unexpectedly, by itself or from outside."""

PROCESS_ENDED = "the process of this run ended unexpectedly at every attempt"
"""Reason of a run whose process, by itself or from outside, always ended before the run was finished."""


class RunExecutor(Protocol):
    """Executor of runs, on this machine or on others."""

    @property
    def description(self) -> str:
        """Place of the runs in words."""

    def execute_all(self, runs: Iterator[PlannedRun], execute: Execute) -> Generator[RunRow, None, None]:
        """Execute runs, and yield each row as soon as its run is finished.

        Runs are taken from the iterator when a process is free. A run whose process ends unexpectedly is
        repeated. Closing the generator ends all processes.
        """


_STARTED = "started"
"""Sign of a worker that it starts a run: the start of its process does not count for the time limit of the run."""


@dataclass(frozen=True)
class LocalWorkers:
    """Worker processes on this machine."""

    workers: int
    """Number of processes."""
    run_time_limit_s: float | None = None
    """Time after which a single run fails and its process is ended [s]; a process then executes one run at a time."""
    runs_together: int = 1
    """Largest number of runs on one line that a process executes together."""

    @property
    def description(self) -> str:
        """Number of the processes."""
        return f"{self.workers} process{'es' if self.workers > 1 else ''} on this machine"

    def execute_all(self, runs: Iterator[PlannedRun], execute: Execute) -> Generator[RunRow, None, None]:
        """Execute runs as in `RunExecutor`."""
        limit_threads()
        again, deaths = deque[PlannedRun](), Counter[int]()
        busy: dict[Connection, _Worker] = {}
        idle: list[_Worker] = []
        together = 1 if self.run_time_limit_s is not None else self.runs_together
        batches = split_runs(runs, execute, together, self.workers)
        with adopt_orphans(), _end_children():
            while True:
                while len(busy) < self.workers and (batch := [again.popleft()] if again else next(batches, [])):
                    worker = _give(batch, idle, execute)
                    busy[worker.connection] = worker
                if not busy:
                    return
                for worker in self._wait(busy):
                    answer = worker.receive()
                    if answer == _STARTED:
                        worker.started = time.monotonic()
                        busy[worker.connection] = worker
                    elif isinstance(answer, list):
                        idle.append(worker)
                        yield from answer
                    else:
                        end_workers([worker.process])
                        for run in worker.runs:
                            deaths[run.number] += 1
                            if self._is_late(worker):
                                yield build_failed_row(run, f"longer than {self.run_time_limit_s:g} s", worker.age)
                            elif deaths[run.number] < MOST_ATTEMPTS:
                                again.append(run)
                            else:
                                yield build_failed_row(run, PROCESS_ENDED, worker.age)

    def _wait(self, busy: "dict[Connection, _Worker]") -> "list[_Worker]":
        """Wait for workers that answer, end or are late, and take them out of the busy ones."""
        limit = self.run_time_limit_s
        timeout = None if limit is None else max(0.0, limit - max(worker.age for worker in busy.values()))
        ready = {connection for connection in wait(list(busy), timeout) if isinstance(connection, Connection)}
        late = {connection for connection, worker in busy.items() if self._is_late(worker)}
        return [busy.pop(connection) for connection in [*busy] if connection in ready | late]

    def _is_late(self, worker: "_Worker") -> bool:
        return self.run_time_limit_s is not None and worker.age >= self.run_time_limit_s


@dataclass
class _Worker:
    """Worker process with the runs that it executes together."""

    process: BaseProcess
    connection: Connection
    runs: list[PlannedRun]
    started: float | None = None

    @property
    def age(self) -> float:
        """Time since the start of the run [s]; 0 while the process is starting."""
        return 0.0 if self.started is None else time.monotonic() - self.started

    def receive(self) -> list[RunRow] | str | None:
        """Rows of the finished runs, or sign of their start; None if the process has ended or is late."""
        with suppress(EOFError, OSError):
            if self.connection.poll():
                answer: list[RunRow] | str = self.connection.recv()
                return answer
        return None


@contextmanager
def _end_children() -> Iterator[None]:
    """End all processes that this process starts in the context."""
    others = set(multiprocessing.active_children())
    try:
        yield
    finally:
        end_workers(set(multiprocessing.active_children()) - others)


def _give(runs: list[PlannedRun], idle: list[_Worker], execute: Execute) -> _Worker:
    """Give runs to an idle worker, or to a new one; an idle worker that has ended is forgotten."""
    while idle:
        worker = idle.pop()
        with suppress(OSError):
            worker.connection.send(runs)
            worker.runs, worker.started = runs, None
            return worker
    # Fresh interpreters: threads of a compiled kernel do not survive a fork.
    context = multiprocessing.get_context("spawn")
    connection, far_end = context.Pipe()
    process = context.Process(target=_work, args=(far_end, execute), daemon=True)
    process.start()
    far_end.close()  # the connection then ends with the worker
    with suppress(OSError):  # a worker that has ended already is noticed when its answer is awaited
        connection.send(runs)
    return _Worker(process, connection, runs)


def _work(connection: Connection, execute: Execute) -> None:
    """Execute runs until the connection ends; an exception becomes the reason of a failed run."""
    handle_worker_signals()
    delay_garbage_searches()
    with suppress(EOFError, OSError):  # of the connection: the parent has ended
        while True:
            runs: list[PlannedRun] = connection.recv()
            connection.send(_STARTED)
            connection.send(execute_together(execute, runs))


# Cluster of Dask: workers on many machines, which can come and go during a campaign.
TASKS_PER_THREAD = 2
"""Tasks in flight per thread of the cluster: one is computed while the next one waits at the worker."""

TASK_S, MOST_RUNS = 5.0, 200
"""Duration of a task that its number of runs aims at [s], and largest number: messages cost more than short runs."""

CAPACITY_S = 1.0
"""Time after which the threads of the cluster are counted again [s]; each count is a message and its answer."""

CLUSTER_SETTINGS = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.interval": "5s",
}
"""Configuration of Dask: observing itself at its own intervals takes two thirds of the time of an idle cluster."""

_CLASSES: dict[ClusterKind, str] = {
    "slurm": "SLURMCluster",
    "pbs": "PBSCluster",
    "sge": "SGECluster",
    "lsf": "LSFCluster",
    "htcondor": "HTCondorCluster",
    "oar": "OARCluster",
    "moab": "MoabCluster",
}


class DaskExecutor:
    """Executor on a cluster of Dask, by its client (distributed.Client)."""

    def __init__(self, client: Any) -> None:
        self._client = client

    @property
    def description(self) -> str:
        """Cluster, and the address of the page that shows it."""
        return f"cluster of Dask at {self._client.scheduler.address}, dashboard {self._client.dashboard_link}"

    def execute_all(self, runs: Iterator[PlannedRun], execute: Execute) -> Generator[RunRow, None, None]:
        """Execute runs as in `RunExecutor`; the scheduler repeats a run whose worker ends unexpectedly."""
        from distributed import CancelledError, KilledWorker, as_completed

        # The execution is the result of a task: a worker that comes later gets it from another one, or computes it.
        sent = self._client.submit(_keep, execute, pure=False)
        finished = as_completed([], with_results=True, raise_errors=False)
        in_flight, again = dict[str, tuple[Any, list[PlannedRun]]](), deque[PlannedRun]()
        capacity, counted, size = 0, -CAPACITY_S, 1
        try:
            while True:
                if time.monotonic() - counted >= CAPACITY_S:
                    capacity, counted = self._count_tasks(), time.monotonic()
                while len(in_flight) < capacity:
                    batch = [again.popleft()] if again else list(islice(runs, size))
                    if not batch:
                        break
                    future = self._client.submit(execute_batch, sent, batch, pure=False)
                    in_flight[future.key] = future, batch
                    finished.add(future)
                if not in_flight:
                    return
                done, result = next(finished)
                _, batch = in_flight.pop(done.key)
                if done.status == "finished":
                    rows, duration = result
                    size = min(MOST_RUNS, max(1, int(TASK_S * len(rows) / max(duration, 1e-9))))
                    yield from rows
                elif not isinstance(error := done.exception(), KilledWorker):
                    raise error
                elif len(batch) > 1:
                    again.extend(batch)  # one of them ends its worker: each is a task of its own now
                else:
                    yield build_failed_row(batch[0], PROCESS_ENDED, 0.0)
        except (CancelledError, OSError) as error:
            found = f"the connection to the scheduler is lost ({type(error).__name__})"
            raise InputError("campaign", found, "Start the scheduler; the same command resumes the campaign.") from None
        finally:
            with suppress(OSError):
                self._client.cancel([future for future, _ in in_flight.values()])

    def _count_tasks(self) -> int:
        """Largest number of tasks in flight; workers may have come or gone."""
        threads: dict[str, int] = self._client.nthreads()
        return TASKS_PER_THREAD * max(1, sum(threads.values()))


def _keep(execute: Execute) -> Execute:
    return execute


def execute_batch(execute: Execute, runs: Sequence[PlannedRun]) -> tuple[list[RunRow], float]:
    """Execute runs on a worker; an exception becomes the reason of a failed run. Returns the duration, too [s]."""
    delay_garbage_searches()
    start = time.perf_counter()
    batches = split_runs(iter(runs), execute, most_together(), 1)
    rows = [row for batch in batches for row in execute_together(execute, batch)]
    return rows, time.perf_counter() - start


def execute_together(execute: Execute, runs: Sequence[PlannedRun]) -> list[RunRow]:
    """Execute runs whose passages are simulated together; each takes an equal share of the computing time."""
    if len(runs) == 1:
        return [call_execution(execute, run) for run in runs]
    rows = run_together([partial(call_execution, execute, run) for run in runs])
    return [replace(row, wall_s=row.wall_s / len(rows)) for row in rows]


def split_runs(runs: Iterator[PlannedRun], execute: Execute, most: int, workers: int) -> Iterator[list[PlannedRun]]:
    """Split runs into batches of consecutive runs on one line, which are executed together.

    Args:
        runs: Runs; at most `most` for each worker are taken ahead, and shared among the workers.
        execute: Execution that knows the line of a run (`RunExecution.find_line`); other ones have batches of one run.
        most: Largest number of runs in a batch.
        workers: Number of workers.
    """
    find_line: Callable[[PlannedRun], object] | None = getattr(execute, "find_line", None)
    if find_line is None or most == 1:
        yield from ([run] for run in runs)
        return
    while taken := list(islice(runs, most * workers)):
        for line, group in groupby(taken, find_line):
            on_line, size = list(group), 1 if line is None else -(-len(taken) // workers)
            yield from (on_line[first : first + size] for first in range(0, len(on_line), size))


def call_execution(execute: Execute, run: PlannedRun) -> RunRow:
    """Execute a run on a worker; an exception becomes the reason of a failed run."""
    start = time.perf_counter()
    try:
        return execute(run)
    except Exception as error:
        return build_failed_row(run, f"{type(error).__name__}: {error}", time.perf_counter() - start)


@contextmanager
def connect_scheduler(address: str) -> Iterator[DaskExecutor]:
    """Connect to a running scheduler, such as `tcp://host:8786`."""
    with connect_client(address, "campaign") as client:
        yield DaskExecutor(client)


@contextmanager
def start_cluster(kind: ClusterKind, jobs: int, options: Mapping[str, Any]) -> Iterator[DaskExecutor]:
    """Submit jobs to a batch system; each job is a worker with one thread, and ends with the campaign.

    Args:
        kind: Kind of the batch system.
        jobs: Number of jobs.
        options: Options of the jobs as in dask-jobqueue, such as `queue`, `walltime` and `memory`; others are those of
            the configuration of Dask.

    Raises:
        InputError: Dask is not installed, an option is wrong, or no job can be submitted.
    """
    with refuse_missing_package("campaign"):
        import dask
        import dask_jobqueue
        import distributed
    where = f"cluster '{kind}'"
    try:
        cluster = getattr(dask_jobqueue, _CLASSES[kind])(**{"cores": 1, "processes": 1, "memory": "4GB", **options})
    except (TypeError, ValueError) as error:
        found = f"cannot be used ({error})"
        raise InputError(where, found, "See the options of dask-jobqueue for [execution.cluster_options].") from None
    settings = {"distributed.scheduler.allowed-failures": MOST_ATTEMPTS - 1, **CLUSTER_SETTINGS}
    with dask.config.set(settings), cluster, distributed.Client(cluster) as client:
        cluster.scale(jobs=jobs)
        yield DaskExecutor(client)


@contextmanager
def choose_executor(execution: Execution) -> Iterator[RunExecutor]:
    """Executor of a campaign; a cluster that is started ends with the context."""
    workers = execution.workers or os.cpu_count() or 1
    if execution.scheduler is not None:
        with connect_scheduler(execution.scheduler) as executor:
            yield executor
    elif execution.cluster is not None:
        with start_cluster(execution.cluster, workers, execution.cluster_options) as executor:
            yield executor
    else:
        yield LocalWorkers(workers, execution.run_time_limit_s, most_together())
