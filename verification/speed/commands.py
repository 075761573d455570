"""Wall and processor time of the documented commands, in seconds and in turns of a reference loop; prints a table.

    python -m verification.speed.commands                                   the table
    python -m verification.speed.commands --check                           exit code 1 if a command exceeds its budget
    python -m verification.speed.commands --only verify --pythons old/bin/python new/bin/python --repeat 3

The loop is pure Python, so that a budget holds on a slower or faster machine, too. Processor time includes the
processes that a command starts, and does not depend on other work on the machine. The kernels are compiled before. With
several interpreters the commands alternate between them, and the smallest times are printed; `--only` begins the
commands that are printed, those before them prepare their files.
"""

import argparse
import os
import resource
import shlex
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
COMMANDS = Path(__file__).with_suffix(".toml")
MAIN = "from pantocheck.conformance.app.main import start; start()"
LOOP = "total = 0.0\nfor i in range(5_000_000):\n    total += i * 1e-3\n"
"""Reference loop: floating-point arithmetic of the interpreter, about 0.3 s."""

TIME_LIMIT = 3600.0
"""Longest time of one command [s]."""


def measure(call: list[str], folder: Path) -> tuple[float, float]:
    """Wall and processor time of a process in a folder [s]; every verdict is a valid end."""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(call, cwd=folder, capture_output=True, text=True, check=False, timeout=TIME_LIMIT)
    wall, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1, 3):
        raise SystemExit(f"{shlex.join(call)}: exit code {done.returncode}\n{done.stderr}{done.stdout}")
    return wall, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def build_call(python: str, words: str) -> list[str]:
    """Process of a command."""
    return [python, "-c", MAIN, *shlex.split(words.format(examples=ROOT / "examples"))]


def main() -> int:
    """Measure and print; exit code 1 if a command exceeds its budget."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare with the budgets")
    parser.add_argument("--only", default="", help="first words of the commands to be printed")
    parser.add_argument("--pythons", nargs="+", default=[sys.executable], help="interpreters with Pantocheck")
    parser.add_argument("--repeat", type=int, default=1, help="runs of every printed command")
    options = parser.parse_args()
    os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    rows = tomllib.loads(COMMANDS.read_text("utf-8"))["command"]
    exceeded = 0
    heads = "wall [s] | processor [s] | loops" + (" | budget" if options.check else "")
    print(f"| command | {' | '.join([heads] * len(options.pythons))} |")
    print("| :-- |" + " --: |" * (3 + options.check) * len(options.pythons))
    with tempfile.TemporaryDirectory() as parent:
        folders = {python: Path(parent, str(number)) for number, python in enumerate(options.pythons)}
        for python, folder in folders.items():
            folder.mkdir()
            measure(build_call(python, "simulate en50318-2002/250 --out compiled.csv"), folder)
        for row in rows:
            shown = row["words"].startswith(options.only)
            times: dict[str, list[tuple[float, float, float]]] = {python: [] for python in folders}
            for folder in folders.values() if "prepared_by" in row else ():
                subprocess.run(shlex.split(row["prepared_by"]), cwd=folder, check=True, capture_output=True)
            for _ in range(options.repeat if shown else 1):
                for python, folder in folders.items():
                    loop = measure([python, "-c", LOOP], folder)[1]
                    wall, processor = measure(build_call(python, row["words"]), folder)
                    times[python].append((wall, processor, processor / loop))
            best = [tuple(map(min, zip(*times[python], strict=True))) for python in folders]
            cells = [f"{wall:.2f} | {processor:.2f} | {loops:.1f}" for wall, processor, loops in best]
            if options.check:
                cells = [f"{cell} | {row['budget']}" for cell in cells]
                exceeded += any(loops > row["budget"] for _, _, loops in best)
            if shown:
                print(f"| `pantocheck {row['words'].replace('{examples}/', '')}` | {' | '.join(cells)} |", flush=True)
    return int(exceeded > 0)


if __name__ == "__main__":
    sys.exit(main())
