"""Cheap campaign: an executed function without a simulation. Workers import it; `python -m` runs it as a driver."""

import os
import signal
import sys
import time
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from pathlib import Path

from pantocheck.conformance.campaigns.campaign_design import CampaignDesign, PlannedRun, RangeAxis
from pantocheck.conformance.campaigns.campaign_driver import drive_campaign
from pantocheck.conformance.campaigns.campaign_file import Execution, ValueRange
from pantocheck.conformance.campaigns.campaign_run import RunRow, build_failed_row
from pantocheck.conformance.campaigns.campaign_store import CampaignStore, open_store
from pantocheck.conformance.campaigns.campaign_table import write_campaign_table
from pantocheck.conformance.campaigns.run_executors import Execute, LocalWorkers


def speed_design(runs: int) -> CampaignDesign:
    """Design of some speeds from 200 km/h."""
    axis = RangeAxis("speed_km_h", ValueRange(start=200.0, stop=200.0 + 0.1 * (runs - 1), step=0.1))
    return CampaignDesign(("cheap",), (axis,), (), (), ("builtin",))


def compute_row(run: PlannedRun) -> RunRow:
    """Row with a number that depends on the speed alone."""
    value = 170 + run.inputs["speed_km_h"] / 7
    return RunRow(run, {"verdict": "pass", "criteria_verdict": "pass", "verification_verdict": None}, None, {
        "1.mean_force_N": value}, 0.02)  # fmt: skip


def compute_slowly(run: PlannedRun) -> RunRow:
    """Row after 20 ms, so that a campaign can be killed while it runs."""
    time.sleep(0.02)
    return compute_row(run)


GATED = 30
"""Number of runs that need no gate."""


def compute_at_the_gate(run: PlannedRun) -> RunRow:
    """Row after 20 ms; runs after the first thirty wait for the file that the environment names."""
    gate = Path(os.environ["CAMPAIGN_GATE"])
    while run.number > GATED and not gate.exists():
        time.sleep(0.02)
    return compute_slowly(run)


def fail_even(run: PlannedRun) -> RunRow:
    """Row of a failed run for even numbers."""
    return build_failed_row(run, "even", 0.0) if run.number % 2 == 0 else compute_row(run)


def end_first(run: PlannedRun) -> RunRow:
    """Row of a run; run 1 ends its process."""
    if run.number == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return compute_row(run)


def misbehave(run: PlannedRun) -> RunRow:
    """Run 1 ends its process, run 2 raises an exception, run 3 takes longer than the limit of its test."""
    if run.number == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    if run.number == 2:
        raise ZeroDivisionError("no mass")
    if run.number == 3:
        time.sleep(60)
    return compute_row(run)


@dataclass(frozen=True)
class OnOneLine:
    """Execution whose runs are on the same line."""

    execute: Execute

    def __call__(self, run: PlannedRun) -> RunRow:
        return self.execute(run)

    def find_line(self, run: PlannedRun) -> object:
        """The same line for all runs but the last."""
        return None if run.number == 5 else run.case_id


class ThisProcess:
    """Executor without other processes, the obvious one."""

    description = "this process"

    def execute_all(self, runs: Iterator[PlannedRun], execute: Execute) -> Generator[RunRow, None, None]:
        for run in runs:
            yield execute(run)


def fill_store(store: CampaignStore, design: CampaignDesign, execute: Execute = compute_row) -> None:
    """Execute a campaign in this process."""
    drive_campaign(design, execute, store, ThisProcess(), Execution(), lambda _: None)


def build_table(folder: Path, runs: int) -> bytes:
    """Table of an undisturbed cheap campaign in this process."""
    with open_store(folder, {"runs": runs}) as store:
        fill_store(store, speed_design(runs))
        write_campaign_table(store, folder / "campaign.csv")
    return (folder / "campaign.csv").read_bytes()


def main(folder: Path, runs: int) -> None:
    """Run the cheap campaign in two processes."""
    with open_store(folder, {"runs": runs}) as store:
        drive_campaign(speed_design(runs), compute_at_the_gate, store, LocalWorkers(2), Execution(), lambda _: None)
        write_campaign_table(store, folder / "campaign.csv")


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
