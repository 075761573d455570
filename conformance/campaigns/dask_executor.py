"""Executor on a cluster of Dask: workers on many machines, which can come and go during a campaign."""

from collections.abc import Generator, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any

from pantocheck.conformance.campaigns.campaign_design import PlannedRun
from pantocheck.conformance.campaigns.campaign_file import ClusterKind
from pantocheck.conformance.campaigns.campaign_run import RunRow, build_failed_row
from pantocheck.conformance.campaigns.local_workers import MOST_ATTEMPTS, PROCESS_ENDED, Execute
from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.input_error import InputError

RUNS_PER_THREAD = 2
"""Runs in flight per thread of the cluster: one is computed while the next one waits at the worker."""

CONNECTION_TIMEOUT_S = 30

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
    """Executor on a cluster of Dask.

    Args:
        client: Client of the cluster (distributed.Client).
    """

    def __init__(self, client: Any) -> None:
        self._client = client

    @property
    def description(self) -> str:
        """Cluster, and the address of the page that shows it."""
        return f"cluster of Dask at {self._client.scheduler.address}, dashboard {self._client.dashboard_link}"

    def execute_all(self, runs: Iterator[PlannedRun], execute: Execute) -> Generator[RunRow, None, None]:
        """Execute runs as in `RunExecutor`; the scheduler repeats a run whose worker ends unexpectedly.

        Raises:
            InputError: The connection to the scheduler is lost.
        """
        from distributed import CancelledError, KilledWorker, as_completed

        finished, in_flight = as_completed([]), dict[str, tuple[Any, PlannedRun]]()
        try:
            while True:
                while len(in_flight) < self._capacity and (run := next(runs, None)) is not None:
                    future = self._client.submit(call_execution, execute, run, pure=False)
                    in_flight[future.key] = future, run
                    finished.add(future)
                if not in_flight:
                    return
                future, run = in_flight.pop(next(finished).key)
                try:
                    row: RunRow = future.result()
                except KilledWorker:
                    row = build_failed_row(run, PROCESS_ENDED, 0.0)
                yield row
        except (CancelledError, OSError) as error:
            found = f"the connection to the scheduler is lost ({type(error).__name__})"
            raise InputError("campaign", found, "Start the scheduler; the same command resumes the campaign.") from None
        finally:
            with suppress(OSError):
                self._client.cancel([future for future, _ in in_flight.values()])

    @property
    def _capacity(self) -> int:
        """Largest number of runs in flight; workers may have come or gone."""
        threads: dict[str, int] = self._client.nthreads()
        return RUNS_PER_THREAD * max(1, sum(threads.values()))


def call_execution(execute: Execute, run: PlannedRun) -> RunRow:
    """Execute a run on a worker; an exception becomes the reason of a failed run."""
    try:
        return execute(run)
    except Exception as error:
        return build_failed_row(run, f"{type(error).__name__}: {error}", 0.0)


@contextmanager
def connect_scheduler(address: str) -> Iterator[DaskExecutor]:
    """Connect to a running scheduler, such as `tcp://host:8786`.

    Raises:
        InputError: Dask is not installed, or there is no scheduler at this address.
    """
    with refuse_missing_package("campaign"):
        import distributed
    try:
        client = distributed.Client(address, timeout=CONNECTION_TIMEOUT_S)
    except (OSError, ValueError) as error:
        found = f"cannot be reached ({' '.join(str(error).split())[:200]})"
        raise InputError(f"scheduler '{address}'", found, "Start one with `dask scheduler`.") from None
    with client:
        yield DaskExecutor(client)


@contextmanager
def start_cluster(kind: ClusterKind, jobs: int, options: Mapping[str, Any]) -> Iterator[DaskExecutor]:
    """Submit jobs to a batch system; each job is a worker with one thread, and ends with the campaign.

    Args:
        kind: Batch system.
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
    limit = {"distributed.scheduler.allowed-failures": MOST_ATTEMPTS - 1}
    with dask.config.set(limit), cluster, distributed.Client(cluster) as client:
        cluster.scale(jobs=jobs)
        yield DaskExecutor(client)
