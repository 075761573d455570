"""Interface of the executors of a campaign."""

from collections.abc import Callable, Generator, Iterator
from typing import Protocol

from pantocheck.conformance.campaigns.campaign_design import PlannedRun
from pantocheck.conformance.campaigns.campaign_run import RunRow

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

        Runs are taken from the iterator one at a time, when a process is free. A run whose process ends unexpectedly is
        repeated. Closing the generator ends all processes.
        """
