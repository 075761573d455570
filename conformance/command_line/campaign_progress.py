"""Progress of a campaign: a live line on a terminal, a line a minute in a log."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta

from rich.console import Console
from rich.live import Live
from rich.text import Text

from pantocheck.conformance.campaigns.campaign_driver import CampaignProgress

LOG_INTERVAL_S = 60.0
"""Time between two lines of a log [s]."""

REDRAWS_PER_S = 4.0


@contextmanager
def report_campaign() -> Iterator[Callable[[CampaignProgress], None]]:
    """Show the progress of a campaign on standard error; yields the callback of the driver."""
    errors = Console(stderr=True, highlight=False)
    if errors.is_terminal:
        with Live(console=errors, refresh_per_second=REDRAWS_PER_S, transient=True) as live:
            yield lambda progress: live.update(Text(describe_progress(progress)))
    else:
        yield _ProgressLog(errors)


def describe_progress(progress: CampaignProgress) -> str:
    """Progress in one line: finished and failed runs, rate and remaining time."""
    counts = f"{progress.finished} of {progress.total} runs finished, {progress.failed} failed"
    if progress.rate is None or progress.remaining_s is None:
        return counts
    remaining = timedelta(seconds=round(progress.remaining_s))
    rate = f"{progress.rate:.1f} per second" if progress.rate >= 1 else f"{60 * progress.rate:.1f} per minute"
    return f"{counts}, {rate}, {remaining} remaining"


class _ProgressLog:
    """Callback that prints the first and the last state, and one state per interval between them."""

    def __init__(self, output: Console) -> None:
        self._output = output
        self._next = 0.0

    def __call__(self, progress: CampaignProgress) -> None:
        if time.monotonic() >= self._next or progress.finished == progress.total:
            self._next = time.monotonic() + LOG_INTERVAL_S
            stamp = time.strftime("%Y-%m-%d %H:%M:%S")
            self._output.print(Text(f"{stamp} {describe_progress(progress)}"), soft_wrap=True)
