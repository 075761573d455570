"""Driver of a campaign: starts open runs, stores finished ones, reports progress, and stops early on request."""

import time
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass, field

from pantocheck.conformance.campaigns.campaign_design import CampaignDesign, PlannedRun
from pantocheck.conformance.campaigns.campaign_file import Execution
from pantocheck.conformance.campaigns.campaign_run import RunRow
from pantocheck.conformance.campaigns.campaign_store import CampaignStore
from pantocheck.conformance.campaigns.run_executors import Execute, RunExecutor
from pantocheck.conformance.results.campaign_format import CampaignEnding

FEWEST_JUDGED = 20
"""Fewest finished runs from which the share of failed runs is judged: one failure in them is a share of 5 %."""

RATED_RUNS = 50
"""Number of the latest runs whose rate gives the remaining time."""


@dataclass(frozen=True)
class CampaignProgress:
    """Progress of a campaign."""

    total: int
    """Number of the runs of the campaign."""
    finished: int
    failed: int
    """Number of the finished runs, earlier ones included, and of the failed ones among them."""
    rate: float | None
    """Runs per second, over the latest runs; None before two runs are finished."""

    @property
    def remaining_s(self) -> float | None:
        """Remaining time at this rate [s]."""
        return (self.total - self.finished) / self.rate if self.rate else None


@dataclass
class _Session:
    """Counts and times of this session of a campaign."""

    execution: Execution
    finished: int
    failed: int
    started: float = field(default_factory=time.monotonic)
    ends: deque[float] = field(default_factory=lambda: deque(maxlen=RATED_RUNS))
    ending: CampaignEnding = "complete"

    def add(self, failed: bool) -> None:
        """Count a finished run."""
        self.finished, self.failed = self.finished + 1, self.failed + failed
        self.ends.append(time.monotonic())

    def may_start(self) -> bool:
        """Whether a further run may be started; else `ending` has the reason."""
        share, budget = self.execution.max_failed_share, self.execution.time_budget_s
        if self.finished >= FEWEST_JUDGED and self.failed > share * self.finished:
            self.ending = "failure share"
        elif budget is not None and time.monotonic() - self.started >= budget:
            self.ending = "time budget"
        return self.ending == "complete"

    @property
    def rate(self) -> float | None:
        """Runs per second of the latest runs."""
        duration = self.ends[-1] - self.ends[0] if len(self.ends) > 1 else 0.0
        return (len(self.ends) - 1) / duration if duration > 0 else None


@dataclass(frozen=True)
class Pilots:
    """Runs whose rows the execution of the other runs uses."""

    numbers: Collection[int]
    """Their numbers."""
    learn: Callable[[Iterable[RunRow]], Execute]
    """Function that gives the execution of the other runs from their rows."""


def drive_campaign(
    design: CampaignDesign,
    execute: Execute,
    store: CampaignStore,
    executor: RunExecutor,
    execution: Execution,
    report: Callable[[CampaignProgress], None],
    pilots: Pilots | None = None,
) -> CampaignEnding:
    """Execute the runs of a design that its store does not hold.

    Args:
        design: Runs of the campaign.
        execute: Function that executes one run.
        store: Store of the finished runs.
        executor: Executor of the open runs.
        execution: Conditions of an early stop.
        report: Callback that receives the progress after every run.
        pilots: Runs that are executed before the others; None: none.

    Returns:
        Reason of the end.
    """
    total, session = design.count_runs(), _Session(execution, *store.count())
    report(CampaignProgress(total, session.finished, session.failed, None))
    for part in (None,) if pilots is None else (pilots.numbers, None):
        if part is None and pilots is not None and session.ending == "complete":
            execute = pilots.learn(row for row in store.rows() if row.run.number in pilots.numbers)
        with closing(executor.execute_all(_list_open_runs(design, store, session, part), execute)) as rows:
            for row in rows:
                store.add(row)
                session.add(row.is_failed)
                report(CampaignProgress(total, session.finished, session.failed, session.rate))
    return session.ending


def _list_open_runs(
    design: CampaignDesign, store: CampaignStore, session: _Session, part: Collection[int] | None
) -> Iterator[PlannedRun]:
    """Runs of a part that are not finished, until the session must stop; None: all runs."""
    for run in design.list_runs():
        if (part is None or run.number in part) and not store.holds(run.number):
            if not session.may_start():
                return
            yield run
