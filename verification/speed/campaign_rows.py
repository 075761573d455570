"""Rows per second of processor time of the store and of the executors of a campaign, with runs that cost nothing.

python -m verification.speed.campaign_rows [--rows 6000]

Scheduler, worker and driver of Dask are threads of one process, so that its processor time is that of all three. The
messages between them are not serialised then.
"""

import argparse
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from pantocheck.conformance.campaigns.campaign_design import PlannedRun
from pantocheck.conformance.campaigns.campaign_run import RunRow
from pantocheck.conformance.campaigns.campaign_store import open_store
from pantocheck.conformance.campaigns.run_executors import DaskExecutor

QUANTITIES = {f"1.quantity_number_{i}_N": 1.23456789012345 + i for i in range(90)}
ROW = RunRow(
    PlannedRun(0, 0, "case", "builtin", {}),
    {"verdict": "pass", "criteria_verdict": "pass", "verification_verdict": None},
    None,
    QUANTITIES,
    1.0,
    dict(list(QUANTITIES.items())[:50]),
)
"""Row with 140 numbers, as a case with two pantographs has."""


@dataclass(frozen=True)
class ImmediateRun:
    """Function that executes a run without a simulation."""

    def __call__(self, run: PlannedRun) -> RunRow:
        """Row of a run."""
        return replace(ROW, run=run)


def list_runs(count: int) -> Iterator[PlannedRun]:
    """Runs of a campaign."""
    return (PlannedRun(i, i, "case", "builtin", {"speed_km_h": float(i)}) for i in range(count))


def measure(name: str, rows: int, task: Callable[[], object]) -> None:
    """Print the rows per second of a task."""
    processor, wall = time.process_time(), time.perf_counter()
    task()
    processor, wall = time.process_time() - processor, time.perf_counter() - wall
    print(f"| {name} | {rows} | {rows / processor:.0f} | {rows / wall:.0f} |", flush=True)


def main() -> None:
    """Measure and print."""
    from distributed import Client, LocalCluster

    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rows", type=int, default=6000)
    count = parser.parse_args().rows
    print("| part | rows | rows/s of processor time | rows/s of wall time |\n|---|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as folder, open_store(Path(folder), {}) as store:
        rows = [replace(ROW, run=run) for run in list_runs(count)]
        measure("store", count, lambda: deque(map(store.add, rows), maxlen=0))
    place = {"n_workers": 1, "threads_per_worker": 8, "processes": False, "dashboard_address": None}
    with LocalCluster(**place) as cluster, Client(cluster) as client:
        runs = DaskExecutor(client).execute_all(list_runs(count), ImmediateRun())
        measure("Dask", count, lambda: deque(runs, maxlen=0))


if __name__ == "__main__":
    main()
