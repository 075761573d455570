"""Campaign that is killed at random moments: its table equals that of an undisturbed one bit for bit.

    python -m verification.attacks.campaign_kills [KILLS] [SEED]

runs 240 short passages on a coarse mesh in two processes. The driver is killed at random moments and started again,
then one of its workers is killed at random moments while the driver goes on. The code must not change meanwhile.
"""

import os
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from contextlib import closing, suppress
from pathlib import Path

CAMPAIGN = (
    *("en50318-2002/250", "--vary", "speed_km_h=200:299:1.25", "--vary", "pantograph.uplift_force_N=100,120,140"),
    *("--set", "discretisation.element_m=1", "--set", "discretisation.time_step_s=0.002", "--workers", "2"),
)
LONGEST_WAIT_S = 4.0
"""Longest time between the first stored run of a driver and its kill [s]."""

RUNS_BETWEEN_KILLS = 4
"""Runs that are stored between two kills of a worker."""


def main(kills: int, seed: int) -> None:
    """Compare a campaign with kills of driver and workers with an undisturbed one."""
    chance = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        killed, undisturbed = Path(name, "killed"), Path(name, "undisturbed")
        for number in range(kills):
            with start(killed) as driver:
                wait_for_further_run(killed, driver)
                time.sleep(chance.uniform(0, LONGEST_WAIT_S))
                before = count_stored(killed)
                driver.send_signal(signal.SIGKILL)
            print(f"kill {number + 1} of the driver after {before} runs, {count_stored(killed)} are stored")
        with start(killed) as driver:
            for number in range(kills):
                for _ in range(RUNS_BETWEEN_KILLS):  # a run that is killed too often fails
                    wait_for_further_run(killed, driver)
                time.sleep(chance.uniform(0, LONGEST_WAIT_S / 4))
                with suppress(OSError, IndexError):
                    os.kill(chance.choice(list_workers(driver.pid)), signal.SIGKILL)
                    print(f"kill {number + 1} of a worker after {count_stored(killed)} runs")
        with start(undisturbed) as driver:
            driver.wait()
        equal = (killed / "campaign.csv").read_bytes() == (undisturbed / "campaign.csv").read_bytes()
        print(f"{count_stored(killed)} runs; tables {'equal bit for bit' if equal else 'DIFFER'}")
        sys.exit(not equal)


def start(folder: Path) -> "subprocess.Popen[bytes]":
    """Start or resume the campaign."""
    code = "from pantocheck.conformance.app.main import main; main()"
    command = [sys.executable, "-c", code, "campaign", *CAMPAIGN, "--out", str(folder)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def wait_for_further_run(folder: Path, driver: "subprocess.Popen[bytes]") -> None:
    """Wait until the driver has stored a run."""
    before = count_stored(folder)
    while count_stored(folder) == before and driver.poll() is None:
        time.sleep(0.02)


def count_stored(folder: Path) -> int:
    """Number of stored runs."""
    address = f"file:{folder / 'campaign.sqlite'}?mode=ro"
    with suppress(sqlite3.Error), closing(sqlite3.connect(address, uri=True)) as store:
        return int(store.execute("SELECT COUNT(*) FROM run").fetchone()[0])
    return 0


def list_workers(driver: int) -> list[int]:
    """Workers of a driver: its children but the first, which tracks their resources."""
    return sorted(map(int, Path(f"/proc/{driver}/task/{driver}/children").read_text().split()))[1:]


if __name__ == "__main__":
    arguments = [int(text) for text in sys.argv[1:]]
    main(*(arguments + [10, 1][len(arguments) :]))
