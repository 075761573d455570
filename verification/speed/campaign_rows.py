"""Cost of a campaign beside its runs: rows per second with runs that cost nothing, and real runs on workers of Dask.

python -m verification.speed.campaign_rows [--rows 6000] [--runs 200]

Without costs of the runs: scheduler, worker and driver are threads of one process, so that its processor time is that
of all three. The messages between them are not serialised then.

Real runs: two workers are processes, and scheduler and driver a third one. Each process first executes the first run,
which is its start: imports, line and tables. The same runs then alternate between this process and the workers.
"""

import argparse
import statistics
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from pantocheck.conformance.campaigns.campaign_design import PlannedRun
from pantocheck.conformance.campaigns.campaign_file import CampaignFile
from pantocheck.conformance.campaigns.campaign_preparation import prepare_campaign
from pantocheck.conformance.campaigns.campaign_run import RunRow
from pantocheck.conformance.campaigns.campaign_store import open_store
from pantocheck.conformance.campaigns.run_executors import CLUSTER_SETTINGS, DaskExecutor, Execute, call_execution
from pantocheck.conformance.core.processes import delay_garbage_searches

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

CASE, WORKERS, ROUNDS = "en50318-2002/250", 2, 2


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


def measure_processor(task: Callable[[], object], client: Any) -> tuple[float, float]:
    """Processor time of a task in this process and in all workers, and its wall time [s]."""
    before, wall = time.process_time() + sum(client.run(time.process_time).values()), time.perf_counter()
    task()
    wall = time.perf_counter() - wall
    return time.process_time() + sum(client.run(time.process_time).values()) - before, wall


def compare_real_runs(count: int) -> None:
    """Print the processor time of real runs on two workers over that of the same runs one after another."""
    import dask
    from distributed import Client, LocalCluster

    delay_garbage_searches()
    speeds = [240.0 + 20.0 * i / count for i in range(count)]
    file = CampaignFile.model_validate({"cases": [CASE], "vary": [{"key": "speed_km_h", "values": speeds}]})
    campaign = prepare_campaign(file, Path())
    first, *_ = runs = list(campaign.design.list_runs())
    execute: Execute = campaign.execute
    call_execution(execute, first)
    place = {"n_workers": WORKERS, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    print("| round | runs | one after another [s] | on two workers [s] | ratio | wall time [s] |")
    print("|--:|--:|--:|--:|--:|--:|")
    with dask.config.set(CLUSTER_SETTINGS), LocalCluster(**place) as cluster, Client(cluster) as client:
        client.run(call_execution, execute, first)
        start = statistics.mean(client.run(time.process_time).values())
        for number in range(ROUNDS):
            begin = time.process_time()
            deque(map(partial(call_execution, execute), runs), maxlen=0)
            single = time.process_time() - begin
            rows = DaskExecutor(client).execute_all(iter(runs), execute)
            shared, wall = measure_processor(lambda rows=rows: deque(rows, maxlen=0), client)
            print(
                f"| {number + 1} | {count} | {single:.2f} | {shared:.2f} | {shared / single:.3f} | {wall:.1f} |",
                flush=True,
            )
    print(f"start of a worker: {start:.2f} s of processor time")


def main() -> None:
    """Measure and print."""
    from distributed import Client, LocalCluster

    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rows", type=int, default=6000)
    parser.add_argument("--runs", type=int, default=200)
    options = parser.parse_args()
    count = options.rows
    print("| part | rows | rows/s of processor time | rows/s of wall time |\n|---|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as folder, open_store(Path(folder), {}) as store:
        rows = [replace(ROW, run=run) for run in list_runs(count)]
        measure("store", count, lambda: deque(map(store.add, rows), maxlen=0))
    place = {"n_workers": 1, "threads_per_worker": 8, "processes": False, "dashboard_address": None}
    with LocalCluster(**place) as cluster, Client(cluster) as client:
        runs = DaskExecutor(client).execute_all(list_runs(count), ImmediateRun())
        measure("Dask", count, lambda: deque(runs, maxlen=0))
    compare_real_runs(options.runs)


if __name__ == "__main__":
    main()
