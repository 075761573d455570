"""Progress of a campaign: finished and failed runs, rate and remaining time."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta

from pantocheck.conformance.app.commands.progress_display import show_line
from pantocheck.conformance.campaigns.campaign_driver import CampaignProgress


@contextmanager
def report_campaign() -> Iterator[Callable[[CampaignProgress], None]]:
    """Show the progress of a campaign on standard error; yields the callback of the driver."""
    latest: list[CampaignProgress] = []

    def keep(progress: CampaignProgress) -> None:
        latest[:] = [progress]

    with show_line(lambda: describe_progress(latest[0]) if latest else ""):
        yield keep


def describe_progress(progress: CampaignProgress) -> str:
    """Progress in one line: finished and failed runs, rate and remaining time."""
    counts = f"{progress.finished} of {progress.total} runs finished, {progress.failed} failed"
    if progress.rate is None or progress.remaining_s is None:
        return counts
    remaining = timedelta(seconds=round(progress.remaining_s))
    rate = f"{progress.rate:.1f} per second" if progress.rate >= 1 else f"{60 * progress.rate:.1f} per minute"
    return f"{counts}, {rate}, {remaining} remaining"
