"""Mutation sample of the product with the operators of cosmic-ray: share of changed places that related tests detect.

    python -m verification.attacks.mutation OUT [--mutants 60] [--folders conformance/grading ...] [--jobs 2]

OUT is a folder outside the checkout; the same command continues an ended run. Method and settings: docs/mutation.md.
"""

import argparse
import contextlib
import filecmp
import json
import os
import queue
import re
import shutil
import signal
import subprocess
import sys
import threading
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from scipy.stats import binomtest

from verification.attacks.covering_tests import CoveringTests
from verification.attacks.mutants import Mutant, draw_sample, list_changes, list_folders

CHECKOUT = Path(__file__).parents[2]
TESTED = ("tests/model", "tests/conformance")
COPIED = ("conformance", "model", "pantocheck", "reference_cases", "templates", "tests", "verification", "docs")
COPIED += ("examples", "pyproject.toml", "pytest_pantocheck.py", "README.md", "CHANGELOG.md")
SERVER = Path(__file__).with_name("fork_server.py")
SUFFICIENT = 0.9
"""Share of killed mutants that every folder needs."""
COVERAGE_S = 7200.0
"""Largest processor time of the tests with their coverage [s]."""
SLOWER, EXTRA_S = 3.0, 30.0
"""A mutant whose tests need more than this multiple of their processor time, and this time [s], counts as killed."""
IDLE = 20.0
"""A mutant whose tests take this multiple of their largest processor time waits for ever, and counts as killed."""


@dataclass
class Worker:
    """Private copy of the checkout, importable as the installed packages are."""

    place: Path
    environment: dict[str, str] = field(default_factory=dict)
    server: "subprocess.Popen[str] | None" = None
    """Process that runs the tests (`fork_server.py`), once it is needed."""

    @classmethod
    def create(cls, snapshot: Path, place: Path) -> "Worker":
        """Copy the snapshot, and link its folders below the names of the packages."""
        if not place.exists():
            shutil.copytree(snapshot, place, symlinks=True)
        names = place / ".names"
        names.mkdir(exist_ok=True)
        folders = tomllib.loads((place / "pyproject.toml").read_text("utf-8"))["tool"]["setuptools"]["package-dir"]
        for package, folder in folders.items():
            link = names / package.replace(".", "/")
            link.parent.mkdir(exist_ok=True)
            if "." in package and not link.is_symlink():
                link.symlink_to(place / folder, target_is_directory=True)
        path = os.pathsep.join([str(names), str(place)])
        settings = {"PYTHONPATH": path, "HYPOTHESIS_STORAGE_DIRECTORY": str(place / ".hypothesis")}
        return cls(place, {**os.environ, **settings})

    def run_tests(self, tests: list[str], limit_s: float, record: Path | None = None) -> tuple[int | None, float]:
        """Exit code of pytest, and its processor time [s], which other programs hardly change.

        With a file for the coverage, all tests run; else the run ends with the first failure.

        The code is None if a process needs more time than the limit [s], or if the tests wait for ever.
        """
        if self.server is None or self.server.poll() is not None:
            program = [sys.executable, "-c", SERVER.read_text("utf-8")]
            pipe = subprocess.PIPE
            self.server = subprocess.Popen(
                program, cwd=self.place, env=self.environment, stdin=pipe, stdout=pipe, text=True
            )
        assert self.server.stdin is not None
        assert self.server.stdout is not None
        arguments = ["-x", *tests] if record is None else tests
        request = [arguments, limit_s, None if record is None else str(record)]
        print(json.dumps(request), file=self.server.stdin, flush=True)
        group = int(self.server.stdout.readline())
        clock = threading.Timer(IDLE * limit_s, os.kill, (group, signal.SIGKILL))
        clock.start()
        status, seconds = json.loads(self.server.stdout.readline())
        clock.cancel()
        with contextlib.suppress(ProcessLookupError):
            os.killpg(group, signal.SIGKILL)
        code = os.waitstatus_to_exitcode(status)
        return None if code in {-signal.SIGXCPU, -signal.SIGKILL} else code, seconds

    def close(self) -> None:
        """End the server."""
        if self.server is not None:
            self.server.communicate()

    def write(self, file: str, source: str) -> None:
        """Write a source, and remove its compiled files, which Python compares by the second only."""
        path = self.place / file
        path.write_text(source, "utf-8")
        for compiled in (path.parent / "__pycache__").glob(f"{path.stem}.*"):
            compiled.unlink()


@dataclass
class Run:
    """Mutation run: snapshot, coverage of the test files, and outcomes, all stored in OUT."""

    out: Path
    tests: int
    budget_s: float
    renewed: bool = False
    """Whether the checkout is copied anew; only mutants that were killed in files that are as before are kept."""

    def __post_init__(self) -> None:
        self.snapshot = self.out / "snapshot"
        if self.renewed:
            self._forget()
        if not self.snapshot.exists():
            partial = self.out / "snapshot.partial"
            shutil.rmtree(partial, ignore_errors=True)
            partial.mkdir(parents=True)
            skipped = shutil.ignore_patterns("__pycache__", ".*", "generated", "gallery")
            for name in COPIED:
                if (CHECKOUT / name).is_dir():
                    shutil.copytree(CHECKOUT / name, partial / name, ignore=skipped)
                else:
                    shutil.copyfile(CHECKOUT / name, partial / name)
            partial.rename(self.snapshot)
        self.lock = threading.Lock()
        self.outcomes = {row["order"]: row for row in _read_rows(self.out / "outcomes.jsonl")}

    def _forget(self) -> None:
        """Remove the copies of the checkout and the outcomes that new sources or tests may change."""
        rows = _read_rows(self.out / "outcomes.jsonl")
        same = filecmp.cmpfiles(self.snapshot, CHECKOUT, {row["file"] for row in rows}, shallow=False)[0]
        rows = [row for row in rows if row["outcome"] == "killed" and row["file"] in same]
        (self.out / "outcomes.jsonl").write_text("".join(f"{json.dumps(row)}\n" for row in rows), "utf-8")
        for record in self.out.glob("coverage-*.json"):
            record.unlink()
        for folder in (self.snapshot, *self.out.glob("worker-*")):
            shutil.rmtree(folder, ignore_errors=True)

    def measure_coverage(self, workers: "queue.SimpleQueue[Worker]", jobs: int) -> None:
        """Run all tests once, folder by folder; folders that were measured before stay."""
        folders: dict[str, list[str]] = {}
        for path in (path for name in TESTED for path in sorted((self.snapshot / name).rglob("test_*.py"))):
            test = path.relative_to(self.snapshot)
            folders.setdefault("-".join(test.parts[1:-1][:2]), []).append(test.as_posix())

        def measure(folder: str) -> dict[str, Any]:
            record = self.out / f"coverage-{folder}.json"
            if not record.exists():
                with _borrow(workers) as worker:
                    worker.run_tests(folders[folder], COVERAGE_S, record)
            tests: dict[str, Any] = json.loads(record.read_text("utf-8"))
            return tests

        with ThreadPoolExecutor(jobs) as pool:
            self.covering = CoveringTests(self.snapshot, pool.map(measure, folders))

    def judge(self, mutant: Mutant, worker: Worker) -> None:
        """Run the tests that execute the line of a mutant, and store its outcome."""
        source = (self.snapshot / mutant.file).read_text("utf-8")
        diff = list_changes(self.snapshot, mutant)
        tests: dict[str, float] = {}
        for test in self.covering.select(mutant.file, int(re.findall(r"\d+", diff[0])[0])):
            seconds = self.covering.seconds[test]
            if not tests or (sum(tests.values()) + seconds <= self.budget_s and len(tests) < self.tests):
                tests[test] = seconds
        # The first test of a file can stand for the time of its fixtures, which another one of it then needs.
        longest_s = sum(self.covering.file_seconds[file] for file in {test.partition("::")[0] for test in tests})
        limit_s = SLOWER * longest_s + EXTRA_S
        worker.write(mutant.file, mutant.mutate(source))
        try:
            code, _ = worker.run_tests([*tests], limit_s) if tests else (0, 0.0)
        finally:
            worker.write(mutant.file, source)
        outcome = "untested" if not tests else "timeout" if code is None else "survived" if code == 0 else "killed"
        if code != 0 and worker.run_tests([*tests], limit_s)[0] != 0:
            outcome = "failing without the change"
        row = {"order": mutant.order, **vars(mutant), "outcome": outcome, "diff": diff, "tests": list(tests)}
        with self.lock:
            self.outcomes[mutant.order] = row
            _append_row(self.out / "outcomes.jsonl", row)


@contextlib.contextmanager
def _borrow(workers: "queue.SimpleQueue[Worker]") -> Iterator[Worker]:
    worker = workers.get()
    try:
        yield worker
    finally:
        workers.put(worker)


def _read_rows(path: Path) -> list[dict[str, Any]]:
    """Whole lines of a file; a last line that an interruption cut is removed."""
    text = path.read_text("utf-8") if path.exists() else ""
    whole = text[: text.rfind("\n") + 1]
    path.write_text(whole, "utf-8")
    return [json.loads(line) for line in whole.splitlines()]


def _append_row(path: Path, row: dict[str, Any]) -> None:
    with path.open("a", encoding="utf-8") as file:
        file.write(f"{json.dumps(row)}\n")


def report(folder: str, rows: list[dict[str, Any]]) -> bool:
    """Print the share of a folder and its survivors; whether enough mutants are killed."""
    killed = sum(row["outcome"] in {"killed", "timeout"} for row in rows)
    low, high = binomtest(killed, len(rows)).proportion_ci(method="wilson")
    share = killed / len(rows)
    print(f"{folder}: {killed} of {len(rows)} killed, {share:.0%} (95 % interval {low:.0%} to {high:.0%})", flush=True)
    for row in rows:
        if row["outcome"] not in {"killed", "timeout"}:
            print(f"  {row['outcome']} {row['file']} {row['operator']} {row['occurrence']}")
            print("\n".join(f"    {line}" for line in row["diff"]), flush=True)
    return share >= SUFFICIENT


def main() -> int:
    """Run the open mutants of all folders; exit code 1 if a folder has too few killed ones."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--mutants", type=int, default=60, help="size of the sample of each folder")
    parser.add_argument("--folders", nargs="*", help="default: all")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--tests", type=int, default=100, help="largest number of tests of a mutant")
    parser.add_argument("--budget", type=float, default=30.0, help="largest processor time of these [s]")
    parser.add_argument("--renew", action="store_true", help="copy the checkout anew, and judge what it may change")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    run = Run(options.out.resolve(), options.tests, options.budget, options.renew)
    known = tomllib.loads(Path(__file__).with_name("equivalent_mutants.toml").read_text("utf-8"))["equivalent"]
    all_workers = [Worker.create(run.snapshot, run.out / f"worker-{number}") for number in range(options.jobs)]
    workers: queue.SimpleQueue[Worker] = queue.SimpleQueue()
    for worker in all_workers:
        workers.put(worker)
    run.measure_coverage(workers, options.jobs)

    def judge(mutant: Mutant) -> None:
        if mutant.order not in run.outcomes:
            with _borrow(workers) as worker:
                run.judge(mutant, worker)

    sufficient = True
    for folder, files in list_folders(run.snapshot).items():
        if options.folders and folder not in options.folders:
            continue
        sample = draw_sample(run.snapshot, files, options.mutants, known)
        with ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(judge, sample))
        rows = [run.outcomes[mutant.order] for mutant in sample if mutant.order in run.outcomes]
        sufficient = (not rows or report(folder, rows)) and sufficient
    for worker in all_workers:
        worker.close()
    return 0 if sufficient else 1


if __name__ == "__main__":
    sys.exit(main())
