"""Evaluation of a campaign with many runs: seconds and peak memory of its tables, statistics and report.

    python -m verification.speed.evaluation_speed [RUNS] [DESIGN]

stores RUNS rows (100,000) with the numbers of a formula, and evaluates them as `pantocheck campaign` does after the
last run. DESIGN is `grid` (speeds, starts and uplift forces) or `random` (the same as random inputs).
"""

import resource
import sqlite3
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from pantocheck.conformance.campaigns.campaign_design import PlannedRun
from pantocheck.conformance.campaigns.campaign_evaluation import evaluate_campaign
from pantocheck.conformance.campaigns.campaign_file import CampaignFile
from pantocheck.conformance.campaigns.campaign_preparation import PreparedCampaign, prepare_campaign
from pantocheck.conformance.campaigns.campaign_run import RunRow
from pantocheck.conformance.campaigns.campaign_store import STORE_NAME, CampaignStore, open_store
from pantocheck.conformance.campaigns.campaign_table import write_campaign_table, write_parquet
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.pages.campaign_page import build_campaign_report
from pantocheck.conformance.pages.report_writers import write_report

SPEED, START, FORCE = "speed_km_h", "start_m", "pantograph.uplift_force_N"

BOUNDS = {FORCE: (100.0, 110.0), START: (50.0, 60.0), SPEED: (200.0, 320.0)}
"""Smallest and largest value of each input."""

SIDE = 10
"""Number of uplift forces and of starts of the grid; the other runs differ in speed."""

OTHER_VALUES = 100
"""Number of values of a run that are not evaluated, such as those of single droppers."""


def main(runs: int, kind: str) -> None:
    """Print seconds and peak memory of each step."""
    prepared = prepare(runs, kind)
    with tempfile.TemporaryDirectory() as name, open_store(Path(name), prepared.identity) as store:
        folder = Path(name)
        connect = sqlite3.connect(folder / STORE_NAME, isolation_level=None)
        connect.execute("PRAGMA synchronous = OFF")
        fast = CampaignStore(connect)  # no row needs to survive this benchmark
        measure(f"{runs} rows", lambda: [fast.add(compute_row(run)) for run in prepared.design.list_runs()])
        connect.close()
        measure("campaign.csv", lambda: write_campaign_table(store, folder / "campaign.csv"))
        measure("campaign.parquet", lambda: write_parquet(folder / "campaign.csv"))
        results = measure("evaluation", lambda: evaluate_campaign(prepared, store, "complete"))
        measure("campaign.json", lambda: write_model(folder / "campaign.json", results))
        page = measure("figures", lambda: build_campaign_report(results))
        for form in ("html", "pdf"):
            measure(f"campaign.{form}", lambda form=form: write_report(page, folder / f"campaign.{form}"))
        for path in sorted(folder.glob("campaign.*")):
            print(f"{path.name:20s} {path.stat().st_size / 1e6:8.1f} MB")


def prepare(runs: int, kind: str) -> PreparedCampaign:
    """Campaign with a number of runs over three inputs."""
    if kind == "random":
        inputs = [
            {"key": key, "distribution": {"kind": "uniform", "lower": low, "upper": high}}
            for key, (low, high) in BOUNDS.items()
        ]
        content: dict[str, Any] = {"sampling": {"method": "random", "runs": runs, "input": inputs}}
    else:
        numbers = {FORCE: SIDE, START: SIDE, SPEED: runs // SIDE**2}
        vary = [
            {"key": key, "values": [low + (high - low) * i / numbers[key] for i in range(numbers[key])]}
            for key, (low, high) in BOUNDS.items()
        ]
        content = {"vary": vary}
    return prepare_campaign(CampaignFile.model_validate({"cases": ["en50318-2002/250"], **content}), Path())


def compute_row(run: PlannedRun) -> RunRow:
    """Row of a run, with smooth values of a formula."""
    speed, start, force = (run.inputs[key] for key in (SPEED, START, FORCE))
    deviation = speed / 10 + start / 7
    values = {
        "1.mean_force_N": force,
        "1.std_force_N": deviation,
        "1.statistical_max_N": force + 3 * deviation,
        "1.statistical_min_N": force - 3 * deviation,
        "0.max_uplift_at_support_mm": force / 2 + speed / 7,
    }
    values |= {f"0.dropper_length_m[{i}]": 1 + i / 7 for i in range(1, OTHER_VALUES + 1)}
    return RunRow(run, {"verdict": "info", "criteria_verdict": "info", "verification_verdict": None}, None, values, 0.0)


def measure(name: str, step: Callable[[], Any]) -> Any:
    """Result of a step; prints its seconds and the peak memory of this process so far."""
    start = time.perf_counter()
    result = step()
    seconds, peak = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{name:20s} {seconds:8.1f} s   peak memory {peak:7.0f} MB", flush=True)
    return result


if __name__ == "__main__":
    arguments = sys.argv[1:]
    main(int(arguments[0]) if arguments else 100_000, arguments[1] if len(arguments) > 1 else "grid")
