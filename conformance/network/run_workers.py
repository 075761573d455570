"""Runs of a collection in one process, in several processes of this machine, or on a cluster of Dask.

The results come in the order of the runs, so that the tables of all three are equal.
"""

import multiprocessing
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from typing import Any, Protocol, TypeVar

from pantocheck.conformance.core.dask_client import connect_client
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.processes import handle_worker_signals
from pantocheck.conformance.network.run_collection import StoredRun

T = TypeVar("T")


class MapRuns(Protocol):
    """Function that calls another one with every run, and yields the results in the order of the runs."""

    def __call__(self, function: Callable[[StoredRun], T], runs: Iterable[StoredRun], /) -> Iterator[T]:
        """Results in the order of the runs."""


@contextmanager
def open_workers(jobs: int, scheduler: str | None) -> Iterator[MapRuns]:
    """Map over runs, whose processes end with the context.

    Args:
        jobs: Number of processes on this machine.
        scheduler: Address of a scheduler of Dask; its workers share the folders of this machine. None: this machine.

    Raises:
        InputError: The scheduler cannot be reached, or a process ends unexpectedly.
    """
    if scheduler is not None:
        with connect_client(scheduler, "runs assess") as client:
            threads = max(1, sum(client.nthreads().values()))
            yield partial(_map_in_order, partial(client.submit, pure=False), 2 * threads)
    elif jobs > 1:
        # Fresh interpreters: threads of a compiled kernel do not survive a fork.
        with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), handle_worker_signals) as pool:
            yield partial(_map_in_order, pool.submit, 2 * jobs)
    else:
        yield map


def _map_in_order(
    submit: Callable[..., Any], most: int, function: Callable[[StoredRun], T], runs: Iterable[StoredRun]
) -> Iterator[T]:
    """Results in the order of the runs; `most` of them are in flight."""
    waiting = deque[tuple[StoredRun, Any]]()
    for run in runs:
        waiting.append((run, submit(function, run)))
        if len(waiting) >= most:
            yield _wait(*waiting.popleft())
    while waiting:
        yield _wait(*waiting.popleft())


def _wait(run: StoredRun, future: Any) -> Any:
    """Result of a run; the exceptions of a lost process become an error of the run."""
    try:
        return future.result()
    except InputError:
        raise
    except Exception as error:
        if not isinstance(error, BrokenProcessPool) and type(error).__name__ not in LOST:
            raise
        found = f"its process ended unexpectedly ({type(error).__name__})"
        raise InputError(f"run {run.facts.run}", found, "Give each process more memory, or use fewer.") from None


LOST = ("KilledWorker", "CancelledError", "FutureCancelledError")
"""Exceptions of Dask after the loss of a worker or of the scheduler."""
