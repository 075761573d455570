"""Choice of the executor of a campaign: processes on this machine, a running scheduler, or jobs of a batch system."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

from pantocheck.conformance.campaigns.campaign_file import Execution
from pantocheck.conformance.campaigns.local_workers import LocalWorkers, RunExecutor


@contextmanager
def choose_executor(execution: Execution) -> Iterator[RunExecutor]:
    """Choose the executor of a campaign; a cluster that is started ends with the context.

    Raises:
        InputError: A cluster cannot be reached or started.
    """
    workers = execution.workers or os.cpu_count() or 1
    if execution.scheduler is not None:
        from pantocheck.conformance.campaigns.dask_executor import connect_scheduler

        with connect_scheduler(execution.scheduler) as executor:
            yield executor
    elif execution.cluster is not None:
        from pantocheck.conformance.campaigns.dask_executor import start_cluster

        with start_cluster(execution.cluster, workers, execution.cluster_options) as executor:
            yield executor
    else:
        yield LocalWorkers(workers, execution.run_time_limit_s)
