"""Installed size, import time and time of the first commands, per extra, each in a fresh virtual environment.

python -m verification.speed.installation [EXTRA ...]      # default: the installations of docs/installation.md

Prints the table of docs/installation.md. Each environment is built by pip from this checkout, and removed afterwards.
Sizes are those of the files on disk, compiled Python files and pip included. Times are processor times, the shortest of
several runs, so that other work on the machine counts as little as possible.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[2]
INSTALLATIONS = (
    *("", "simulator", "pdf", "massdrop", "simulator,pdf"),
    *("sign", "tdms", "mdf", "cluster", "parquet", "all"),
)
REPETITIONS = 6


def main() -> None:
    """Build, measure and print one row per installation."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("extras", nargs="*", default=INSTALLATIONS, help="extras of one installation, with commas")
    extras = parser.parse_args().extras
    print("| installation | size [MB] | `--help` [s] | `cases` [s] | `open_run` [s] | `simulate_passage` [s] |")
    print("|---|--:|--:|--:|--:|--:|")
    for names in extras:
        with tempfile.TemporaryDirectory() as folder:
            print(measure(names, Path(folder)), flush=True)


def measure(extras: str, folder: Path) -> str:
    """Row of the table for an installation with some extras."""
    environment = folder / "venv"
    subprocess.run([sys.executable, "-m", "venv", environment], check=True)
    python, command = environment / "bin" / "python", environment / "bin" / "pantocheck"
    source = f"{CHECKOUT}[{extras}]" if extras else str(CHECKOUT)
    subprocess.run([python, "-m", "pip", "install", "--quiet", source], check=True)
    subprocess.run([python, "-m", "compileall", "-q", environment / "lib"], check=False, stdout=subprocess.DEVNULL)
    simulator = "simulator" in extras or extras == "all"
    cells = (
        ", ".join(f"`{name}`" for name in extras.split(",")) if extras else "core",
        f"{size(environment) / 1e6:.0f}",
        f"{shortest_time([command, '--help'], folder):.2f}",
        f"{shortest_time([command, 'cases'], folder):.2f}",
        f"{shortest_time([python, '-c', 'from pantocheck.conformance import open_run'], folder):.2f}",
        f"{shortest_time([python, '-c', 'from pantocheck.model import simulate_passage'], folder):.2f}"
        if simulator
        else "-",
    )
    return f"| {' | '.join(cells)} |"


def size(folder: Path) -> int:
    """Size of all files of a folder, links not followed [bytes]."""
    return sum((Path(root) / name).lstat().st_size for root, _, names in os.walk(folder) for name in names)


def shortest_time(command: Sequence[str | Path], folder: Path) -> float:
    """Shortest processor time of several runs of a command [s]."""
    times = []
    for _ in range(REPETITIONS):
        before = _processor_time()
        subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
        times.append(_processor_time() - before)
    return min(times)


def _processor_time() -> float:
    """Processor time of all ended child processes [s]."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main()
