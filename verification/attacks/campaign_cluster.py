"""Campaign on a Dask cluster: its table equals that of local processes bit for bit, with a worker lost and one added.

    python -m verification.attacks.campaign_cluster

starts a scheduler and two workers of Dask as separate processes on this machine, and runs 48 short passages of two
pantographs on them. A worker is killed after 10 runs, and another one is added after 20. The same campaign then runs in
two local processes. The code must not change meanwhile.
"""

import re
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from verification.attacks.campaign_kills import count_stored

CAMPAIGN = (
    *("en50318-2018/ac-simple/320-twin", "--vary", "speed_km_h=200:341:3", "--set", "line.geometry.spans=16"),
    *("--set", "evaluated_spans=[10,12]", "--set", "compared_spans=[10,12]", "--set", "discretisation.element_m=1"),
    *("--set", "discretisation.time_step_s=0.002"),
)
PYTHON = [sys.executable, "-c"]
SUITE = "from pantocheck.conformance.app.main import main; main()"
LONGEST_START_S = 120.0
"""Longest time until the scheduler states its address [s]."""


def main() -> None:
    """Run the campaign on the cluster and in local processes, and compare the tables."""
    with tempfile.TemporaryDirectory() as name, ExitStack() as stack:
        cluster, local = Path(name, "cluster"), Path(name, "local")
        scheduler = start(stack, Path(name, "scheduler.log"), "dask_scheduler", "--port", "0", "--no-dashboard")
        address = read_address(Path(name, "scheduler.log"), scheduler)
        workers = [start_worker(stack, Path(name), address, number) for number in (1, 2)]
        driver = subprocess.Popen([*PYTHON, SUITE, "campaign", *CAMPAIGN, "--scheduler", address, "--out", cluster])
        wait_for_runs(cluster, driver, 10)
        workers[0].send_signal(signal.SIGKILL)
        print(f"a worker is killed after {count_stored(cluster)} runs")
        wait_for_runs(cluster, driver, 20)
        workers.append(start_worker(stack, Path(name), address, 3))
        print(f"a worker is added after {count_stored(cluster)} runs")
        driver.wait()
        subprocess.run([*PYTHON, SUITE, "campaign", *CAMPAIGN, "--workers", "2", "--out", local], check=False)
        equal = (cluster / "campaign.csv").read_bytes() == (local / "campaign.csv").read_bytes()
        print(f"{count_stored(cluster)} runs; tables {'equal bit for bit' if equal else 'DIFFER'}")
        sys.exit(not equal)


def start(stack: ExitStack, log: Path, module: str, *arguments: str) -> "subprocess.Popen[bytes]":
    """Start a process of Dask that ends with the stack; its output goes to a file."""
    code = f"from distributed.cli.{module} import main; main()"
    output = stack.enter_context(log.open("wb"))
    process = subprocess.Popen([*PYTHON, code, *arguments], stdout=output, stderr=output)
    stack.callback(process.kill)
    return process


def start_worker(stack: ExitStack, folder: Path, address: str, number: int) -> "subprocess.Popen[bytes]":
    """Start a worker with one thread and without a guardian process, so that a kill ends it."""
    options = (address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory", str(folder))
    return start(stack, folder / f"worker{number}.log", "dask_worker", *options)


def read_address(log: Path, scheduler: "subprocess.Popen[bytes]") -> str:
    """Address of the scheduler, from its log."""
    end = time.monotonic() + LONGEST_START_S
    while time.monotonic() < end and scheduler.poll() is None:
        if found := re.search(r"Scheduler at:\s*(tcp://\S+)", log.read_text("utf-8", "replace")):
            return found[1]
        time.sleep(0.1)
    sys.exit(f"the scheduler did not start: {log.read_text('utf-8', 'replace')[-500:]}")


def wait_for_runs(folder: Path, driver: "subprocess.Popen[bytes]", runs: int) -> None:
    """Wait until a number of runs is stored."""
    while driver.poll() is None and count_stored(folder) < runs:
        time.sleep(0.05)


if __name__ == "__main__":
    main()
