"""Execution of a campaign: failures, early stops, and resuming after the kill of a driver or a worker."""

import os
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path

import pytest

from helpers.cheap_campaign import (
    GATED,
    OnOneLine,
    ThisProcess,
    build_table,
    compute_row,
    compute_slowly,
    end_first,
    fail_even,
    fill_store,
    misbehave,
    speed_design,
)
from pantocheck.conformance.campaigns.campaign_driver import CampaignProgress, drive_campaign
from pantocheck.conformance.campaigns.campaign_file import CampaignFile, Execution
from pantocheck.conformance.campaigns.campaign_preparation import prepare_campaign
from pantocheck.conformance.campaigns.campaign_store import STORE_NAME, open_store
from pantocheck.conformance.campaigns.run_executors import (
    PROCESS_ENDED,
    LocalWorkers,
    execute_batch,
    execute_together,
    split_runs,
)
from pantocheck.conformance.core.input_error import InputError
from pantocheck.model.dynamics import recording

RUNS = 60
"""Runs in two processes: some are finished at every kill, and half of them wait for a gate."""

GATE = "gate"

END_S, LOAD = 2.0, 5.0
"""Time after which no worker of a killed driver may be left, and its factor: other tests load the machine meanwhile."""


def start_driver(folder: Path, errors: int | None = None) -> subprocess.Popen[bytes]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "CAMPAIGN_GATE": str(folder / GATE)}
    command = [sys.executable, "-m", "helpers.cheap_campaign", str(folder), str(RUNS)]
    return subprocess.Popen(command, env=environment, stderr=errors)


def count_stored(folder: Path) -> int:
    address = f"file:{folder / STORE_NAME}?mode=ro"
    with suppress(sqlite3.Error), closing(sqlite3.connect(address, uri=True)) as store:
        return int(store.execute("SELECT COUNT(*) FROM run").fetchone()[0])
    return 0


def wait_for_runs(folder: Path, driver: subprocess.Popen[bytes], number: int) -> None:
    """Wait until workers are running, and further runs are stored, or all those that need no gate."""
    enough = min(count_stored(folder) + number, GATED)
    while (count_stored(folder) < enough or len(list_children(driver.pid)) < 2) and driver.poll() is None:
        time.sleep(0.02)
    assert count_stored(folder) < RUNS


def list_children(process: int) -> list[int]:
    return [int(text) for text in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


@pytest.mark.skipif(sys.platform != "linux", reason="the children of a process are listed in /proc")
def test_killed_campaign_resumes_to_the_table_of_an_undisturbed_one(tmp_path: Path) -> None:
    """The driver is killed first, then a worker of the driver that resumes.

    The workers of the killed driver wait at the gate, so that no run of theirs ends by itself; they end without a word.
    """
    killed = tmp_path / "killed"
    with start_driver(killed, subprocess.PIPE) as driver:
        wait_for_runs(killed, driver, GATED)
        children = list_children(driver.pid)
        driver.send_signal(signal.SIGKILL)
        assert wait_for_ends(children, LOAD * END_S) == []
        assert driver.stderr is not None
        assert driver.stderr.read() == b""
    with start_driver(killed) as driver:
        wait_for_runs(killed, driver, 10)
        os.kill(list_children(driver.pid)[-1], signal.SIGKILL)
        (killed / GATE).touch()
        assert driver.wait(timeout=600) == 0
    assert (killed / "campaign.csv").read_bytes() == build_table(tmp_path / "undisturbed", RUNS)


def wait_for_ends(processes: list[int], longest_s: float) -> list[int]:
    """Processes that still run after a time; those that only wait for their parent have ended."""
    end = time.monotonic() + longest_s
    while (running := [process for process in processes if is_running(process)]) and time.monotonic() < end:
        time.sleep(0.02)
    return running


def is_running(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z"


CAMPAIGN = ("en50318-2002/250", "--vary", "speed_km_h=200:299:1")


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform != "linux", reason="the children of a process are listed in /proc")
def test_workers_end_inside_a_kernel(tmp_path: Path) -> None:
    """Each run of the case needs several passages, which compute in compiled code."""
    command = [sys.executable, "-m", "pantocheck", "campaign", *CAMPAIGN, "--workers", "2", "--out", str(tmp_path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL) as driver:
        while len(list_children(driver.pid)) < 3 or not count_stored(tmp_path):
            assert driver.poll() is None
            time.sleep(0.1)
        children = list_children(driver.pid)
        driver.send_signal(signal.SIGKILL)
        assert wait_for_ends(children, LOAD * END_S) == []
        assert driver.stderr is not None
        assert b"Traceback" not in driver.stderr.read()


def test_compiled_functions_of_a_time_step_let_other_threads_run() -> None:
    """Otherwise no thread of a worker notices the end of its parent during a passage."""
    assert recording._advance.targetoptions["nogil"]


def test_failing_runs_become_rows_with_their_reason(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pantocheck.conformance.campaigns.run_executors.MOST_ATTEMPTS", 2)
    design = speed_design(5)
    with open_store(tmp_path, {}) as store:
        drive_campaign(design, misbehave, store, LocalWorkers(2, 2.0), Execution(), lambda _: None)
        reasons = {row.run.number: row.reason for row in store.rows()}
        ended = "the process of this run ended unexpectedly at every attempt"
        assert reasons == {1: ended, 2: "ZeroDivisionError: no mass", 3: "longer than 2 s", 4: None, 5: None}
        assert {row.run.number: row.wall_s < 60 for row in store.rows()} == dict.fromkeys(range(1, 6), True)
        store.forget_failed()
        assert store.count() == (2, 0)
        fill_store(store, design)
        assert store.count() == (5, 0)


def test_runs_on_one_line_are_executed_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that ends its process is repeated alone, and so are those that were executed together with it."""
    monkeypatch.setattr("pantocheck.conformance.campaigns.run_executors.MOST_ATTEMPTS", 2)
    runs, execute = list(speed_design(9).list_runs()), OnOneLine(misbehave)
    for most, workers, sizes in ((4, 2, [4, 1, 3, 1]), (8, 2, [4, 1, 4]), (1, 2, [1] * 9), (8, 9, [1] * 9)):
        batches = list(split_runs(iter(runs), execute, most, workers))
        assert [len(batch) for batch in batches] == sizes
        assert [run for batch in batches for run in batch] == runs
    with open_store(tmp_path, {}) as store:
        executor = LocalWorkers(1, runs_together=4)
        drive_campaign(speed_design(4), OnOneLine(end_first), store, executor, Execution(), lambda _: None)
        reasons = {row.run.number: row.reason for row in store.rows()}
    assert reasons == {1: PROCESS_ENDED, 2: None, 3: None, 4: None}
    rows, duration = execute_batch(OnOneLine(compute_row), runs)
    assert [row.quantities for row in rows] == [compute_row(run).quantities for run in runs]
    assert duration > 0


def test_rows_of_runs_on_one_line_are_those_of_each_alone() -> None:
    """Speeds share the line, tensions do not; the rows differ in their computing time only."""
    vary = [
        {"key": "line.contact_wire.tension_N", "values": [20e3, 21e3]},
        {"key": "speed_km_h", "values": [240.0, 250.0]},
    ]
    campaign = prepare_campaign(CampaignFile.model_validate({"cases": ["en50318-2002/250"], "vary": vary}), Path())
    runs = list(campaign.design.list_runs())
    lines = [campaign.execute.find_line(run) for run in runs]
    assert lines[0] == lines[1] != lines[2] == lines[3]
    assert campaign.execute.find_line(replace(runs[0], system="record:folder")) is None
    assert campaign.execute.find_line(replace(runs[0], inputs={"discretisation.element_m": 1.0})) != lines[0]
    alone = [replace(campaign.execute(run), wall_s=0.0) for run in runs]
    together = execute_together(campaign.execute, runs)
    assert all(row.wall_s > 0 for row in together)
    assert [replace(row, wall_s=0.0) for row in together] == alone
    assert not any(row.is_failed for row in alone)


def test_campaign_stops_at_a_share_of_failed_runs_and_goes_on_with_a_larger_one(tmp_path: Path) -> None:
    """Half of the runs fail: the campaign stops as soon as 20 are finished, but not if half of them may fail."""
    design, states = speed_design(50), list[CampaignProgress]()
    with open_store(tmp_path, {}) as store:
        execution = Execution(max_failed_share=0.4)
        ending = drive_campaign(design, fail_even, store, ThisProcess(), execution, states.append)
        assert ending == "failure share"
        assert store.count() == (20, 10)
        assert {state.finished for state in states if state.rate is None} <= {0, 1}
        assert (states[-1].total, states[-1].finished, states[-1].failed) == (50, 20, 10)
        half = Execution(max_failed_share=0.5)
        ending = drive_campaign(speed_design(50), fail_even, store, ThisProcess(), half, states.append)
        assert ending == "complete"
        assert store.count() == (50, 25)


def test_campaign_stops_after_its_time_budget_and_estimates_the_rest(tmp_path: Path) -> None:
    """Runs of 20 ms: after 0.1 s about five are finished, and the 50 runs of the campaign would need 1 s."""
    with open_store(tmp_path, {}) as store:
        limits = Execution(time_budget_s=0.1)
        ending = drive_campaign(speed_design(50), compute_slowly, store, ThisProcess(), limits, lambda _: None)
        assert ending == "time budget"
        assert 1 <= store.count()[0] <= 6
    assert CampaignProgress(100, 40, 0, 2.0).remaining_s == 30.0
    assert CampaignProgress(100, 1, 0, None).remaining_s is None


def test_store_refuses_another_campaign_a_second_process_and_damage(tmp_path: Path) -> None:
    first = {"cases": "a", "suite": 1}
    running = pytest.raises(InputError, match="another process runs this campaign")
    with open_store(tmp_path, first), running, open_store(tmp_path, first):
        pass
    changed = pytest.raises(InputError, match=r"another campaign \(changed: cases\)")
    with changed, open_store(tmp_path, {**first, "cases": "b"}):
        pass
    (tmp_path / STORE_NAME).write_bytes(b"no database" * 100)
    with pytest.raises(InputError, match="cannot be used"), open_store(tmp_path, first):
        pass
