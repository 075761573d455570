"""Wall and process time of whole commands; prints a table of one or several installations.

    python -m verification.speed.commands
    python -m verification.speed.commands before=/path/to/old now=/path/to/new
    python -m verification.speed.commands --commands cases,first-run --drop-record T1.h5 --load

An installation is LABEL=PLACE. PLACE is a Python interpreter with Pantocheck, or a folder for PYTHONPATH. The
installations take turns at every command, so that other work on the machine has a similar influence on all of them; the
smallest of the times is printed. Process time includes that of processes that a command starts.

With --load the commands `identify` and `run-short` are timed once more beside as many busy processes as the machine has
cores; each should take at most three times its time on an idle machine.
"""

import argparse
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

MAIN = "from pantocheck.conformance.app.main import main; raise SystemExit(main())"
BUSY = "while True: pass"
TIME_LIMIT = 1800.0
"""Longest time of one command [s]."""

COMMANDS = {
    "help": ("--help",),
    "import": (),
    "cases": ("cases",),
    "identify": ("identify", "RECORD", "--out", "OUT"),
    "run-short": ("run", "en50318-2002/250", "--out", "OUT"),
    "run-default": ("run", "--out", "OUT"),
    "run-ac-simple": ("run", "en50318-2018/ac-simple/*", "--out", "OUT"),
    "first-run": ("simulate", "en50318-2002/250", "--out", "OUT/record.csv"),
}
"""Arguments by name of the command; `import` imports the model only, `first-run` compiles the kernels."""

REPETITIONS = {"help": 5, "import": 5, "cases": 5}
"""Runs of a command, one for the others."""

LOADED = ("identify", "run-short")
"""Commands that are timed on a loaded machine."""


@dataclass(frozen=True)
class Installation:
    """Interpreter and environment of one installation, with its label in the table."""

    label: str
    python: str
    environment: dict[str, str]


def read_installation(text: str) -> Installation:
    """Installation LABEL=PLACE."""
    label, _, place = text.partition("=")
    path = Path(place)
    if path.is_dir():
        return Installation(label, sys.executable, {**os.environ, "PYTHONPATH": str(path.resolve())})
    if not path.is_file():
        raise SystemExit(f"installation {text!r}: {place!r} is neither an interpreter nor a folder for PYTHONPATH")
    return Installation(label, str(path), dict(os.environ))


def measure(installation: Installation, command: str, record: str) -> tuple[float, float]:
    """Wall and process time of a command in a fresh folder [s]; every verdict is a valid end."""
    with tempfile.TemporaryDirectory() as folder:
        words = {"RECORD": record, "OUT": folder, "OUT/record.csv": f"{folder}/record.csv"}
        code = ["import pantocheck.model"] if command == "import" else [MAIN]
        call = [installation.python, "-c", *code, *(words.get(word, word) for word in COMMANDS[command])]
        environment = dict(installation.environment)
        if command == "first-run":
            environment["NUMBA_CACHE_DIR"] = f"{folder}/kernels"
        before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        done = subprocess.run(
            call, env=environment, cwd=folder, capture_output=True, text=True, check=False, timeout=TIME_LIMIT
        )
        wall, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):
        raise SystemExit(f"{installation.label}, {command}: exit code {done.returncode}\n{done.stderr}{done.stdout}")
    return wall, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def measure_in_turns(installations: list[Installation], command: str, record: str) -> list[tuple[float, float]]:
    """Smallest wall time and smallest process time of a command, one pair per installation [s]."""
    best = [(math.inf, math.inf)] * len(installations)
    for _ in range(REPETITIONS.get(command, 1)):
        for n, installation in enumerate(installations):
            wall, process = measure(installation, command, record)
            best[n] = (min(best[n][0], wall), min(best[n][1], process))
    return best


@contextmanager
def busy_machine() -> Iterator[None]:
    """Keep every core busy with a process of its own."""
    processes = [subprocess.Popen([sys.executable, "-c", BUSY]) for _ in range(os.cpu_count() or 1)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def print_row(name: str, times: list[tuple[float, float]]) -> None:
    """Print wall and process time of every installation."""
    cells = " | ".join(f"{wall:.2f} | {process:.2f}" for wall, process in times)
    print(f"| {name} | {cells} |", flush=True)


def print_loaded(installations: list[Installation], command: str, record: str, idle: list[tuple[float, float]]) -> None:
    """Print the times of a command beside busy processes, and their ratio to those before."""
    with busy_machine():
        loaded = measure_in_turns(installations, command, record)
    print_row(f"{command}, all cores busy", loaded)
    ratios = [f"{high[0] / low[0]:.1f}" for high, low in zip(loaded, idle, strict=True)]
    print(f"| {command}, wall time busy / idle | {' | | '.join(ratios)} | |", flush=True)


def main() -> None:
    """Measure and print."""
    known = ", ".join(COMMANDS)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("installation", nargs="*", help="LABEL=PLACE; default: this interpreter")
    parser.add_argument("--commands", default=",".join(COMMANDS), help=f"names, separated by commas: {known}")
    parser.add_argument("--drop-record", default="", help="mass-drop record; without it `identify` is left out")
    parser.add_argument("--load", action="store_true", help="time some commands on a loaded machine, too")
    options = parser.parse_args()
    if unknown := set(options.commands.split(",")) - set(COMMANDS):
        parser.error(f"unknown commands {', '.join(sorted(unknown))}; known are {known}")
    installations = [read_installation(text) for text in options.installation or [f"now={sys.executable}"]]
    record = str(Path(options.drop_record).resolve()) if options.drop_record else ""
    heads = " | ".join(f"{installation.label}: wall [s] | process [s]" for installation in installations)
    print(f"| command | {heads} |\n| :-- |{' --: |' * 2 * len(installations)}")
    for command in options.commands.split(","):
        if command != "identify" or record:
            times = measure_in_turns(installations, command, record)
            print_row(command, times)
            if options.load and command in LOADED:
                print_loaded(installations, command, record, times)


if __name__ == "__main__":
    main()
