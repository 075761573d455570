"""Times of the steps of a rig over an hour, against a simulated rig in a process of its own.

`python -m verification.rig.rig_hour [SECONDS] [CASE]`: after a stop by a limit, which is counted, the rig runs anew.
"""

import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import closing
from itertools import pairwise

from pantocheck.conformance.app.commands.options import choose_train_case
from pantocheck.conformance.runs.rig_control import RigControl, RigLimits
from pantocheck.conformance.runs.rig_link import UdpLink
from pantocheck.conformance.runs.rig_loop import RigLog, RigTimes, SystemClock, TimeHistogram, prefer_loop, run_loop
from pantocheck.conformance.runs.rig_run import build_stepped_passage, describe_times

CASE, PORT, STEP_S, DELAY_MS = "en50318-2018/ac-simple/275", 5319, 1e-3, 3.0
LIMITS = RigLimits(force=500.0, travel=0.2, speed=2.0, correction=200.0, watchdog=0.1, connection=30.0)
PASSAGES = 20
"""Passages of one run of the rig."""
EDGES_US = (0, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000)


def add_histogram(total: TimeHistogram, part: TimeHistogram) -> None:
    """Add the counts of a run to those of all."""
    total.counts += part.counts
    total.worst_s = max(total.worst_s, part.worst_s)


def measure(case_id: str, seconds: float) -> RigTimes:
    """Measure the times of all steps; a line after each run of the rig."""
    case, total, stops, done = choose_train_case(case_id, ()), RigTimes(), Counter[str](), 0
    line, steps = build_stepped_passage(case, STEP_S), round(seconds / STEP_S)
    while total.steps < steps:
        command = [sys.executable, "-m", "verification.rig.simulated_rig", case_id]
        with subprocess.Popen([*command, "--port", str(PORT), "--delay", str(DELAY_MS)], stdout=subprocess.DEVNULL):
            time.sleep(5.0)
            passages = max(1, min(PASSAGES, round((steps - total.steps) / line.steps)))
            control = RigControl(line, LIMITS, 50.0, passages)
            with (
                closing(UdpLink(f"127.0.0.1:{PORT}")) as link,
                tempfile.TemporaryFile(buffering=0) as file,
                prefer_loop() as preferred,
            ):
                times = run_loop(control, link, SystemClock(), RigLog(file))
        for name in ("work", "lateness", "delay"):
            add_histogram(getattr(total, name), getattr(times, name))
        total.steps, total.missed = total.steps + times.steps, total.missed + times.missed
        done += passages - control.left
        if control.reason:
            stops["".join(c for c in control.reason if not c.isdigit())] += 1
        facts = describe_times(total)
        print(f"{case_id}: {done} passages, real-time priority: {preferred}, {dict(stops)}, {facts}", file=sys.stderr)
    return total


def print_table(times: RigTimes) -> None:
    """Print the number of steps by their times."""
    print("| from [us] | to [us] | computing time of a step | lateness of its start |\n|--:|--:|--:|--:|")
    for first, end in pairwise((*EDGES_US, None)):
        counts = [int(part.counts[first:end].sum()) for part in (times.work, times.lateness)]
        print(f"| {first} | {'' if end is None else end} | {counts[0]} | {counts[1]} |")


if __name__ == "__main__":
    print_table(measure((*sys.argv[2:3], CASE)[0], float((*sys.argv[1:2], 3600)[0])))
