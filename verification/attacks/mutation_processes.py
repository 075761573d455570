"""Runs of pytest in forked processes: other projects are imported once, the mutated project in each child."""

import ctypes
import fcntl
import importlib.util
import json
import math
import os
import resource
import select
import shutil
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

import pytest

from verification.attacks.mutation_project import NAMES

MEMORY_BYTES = 8 * 2**30
FILE_BYTES = 2**28
WAITING = (4.0, 120.0)
"""Limit of the elapsed time of a run: a multiple of the limit of its processor time, and a constant [s]."""
SET_PARENT_DEATH_SIGNAL, SET_CHILD_SUBREAPER = 1, 36
"""Options of prctl(2)."""


@dataclass(frozen=True)
class Run:
    """End of a run of pytest: `passed`, `failed`, `timeout` or `no tests`; the test that failed or was running."""

    outcome: str
    test: str | None
    tests_run: int
    seconds: float


class _Selection:
    """Pytest plugin: runs the given tests in their order and notes each in a file, which outlives a killed process."""

    def __init__(self, tests: Sequence[str], journal: Path) -> None:
        self.order = {test: number for number, test in enumerate(tests)}
        self.journal = journal.open("w", encoding="utf-8", buffering=1)

    def note(self, event: str, test: str) -> None:
        self.journal.write(json.dumps([event, test]) + "\n")

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items[:] = sorted(
            (item for item in items if item.nodeid in self.order), key=lambda item: self.order[item.nodeid]
        )

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed:
            self.note("failed", report.nodeid)

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        self.note("started", nodeid)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self.note("failed", report.nodeid)


def run_tests(tree: Path, tests: Sequence[str], limit: float) -> Run:
    """Run tests of a tree in their order up to the first that fails, in a child; its descendants are ended with it."""
    journal = tree.parent / "journal"
    plugin = _Selection(tests, journal)
    files = list(dict.fromkeys(test.partition("::")[0] for test in tests))
    begin = time.monotonic()
    status = run_child(tree, lambda: run_pytest(["-x", *files], [plugin]), limit)
    plugin.journal.close()
    events = [json.loads(line) for line in journal.read_text(encoding="utf-8").splitlines()]
    started = [test for event, test in events if event == "started"]
    failed = [test for event, test in events if event == "failed"]
    seconds = time.monotonic() - begin
    if status == 0 and not failed:
        return Run("passed", None, len(started), seconds)
    if status == pytest.ExitCode.NO_TESTS_COLLECTED:
        return Run("no tests", None, 0, seconds)
    last = failed[0] if failed else started[-1] if started else "start of pytest"
    return Run("timeout" if status is None else "failed", last, len(started), seconds)


def run_pytest(arguments: list[str], plugins: list[object]) -> int:
    """Run pytest in this process, the same way every time."""
    options = ["-q", "--tb=short", "-p", "no:cacheprovider", f"--basetemp={os.environ['TMPDIR']}/pytest"]
    if importlib.util.find_spec("xdist"):
        options += ["-p", "no:xdist"]
    if importlib.util.find_spec("hypothesis"):
        options.append("--hypothesis-seed=0")
    return int(pytest.main([*options, *arguments], plugins=plugins))


def run_child(tree: Path, work: Callable[[], int], limit: float) -> int | None:
    """Exit status of work done in a child whose project is the tree; None if it exceeds the processor time [s]."""
    child = os.fork()
    if child == 0:
        _do(tree, work, math.ceil(limit))
    watch = os.pidfd_open(child)
    ended, _, _ = select.select([watch], [], [], WAITING[0] * limit + WAITING[1])
    os.close(watch)
    if not ended:
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    end_descendants()
    code = os.waitstatus_to_exitcode(status)
    return code if ended and code != -signal.SIGXCPU else None


def _do(tree: Path, work: Callable[[], int], limit: int) -> NoReturn:
    status = 70
    try:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        names, temporary = str(tree / NAMES), tree.parent / "tmp"
        shutil.rmtree(temporary, ignore_errors=True)
        temporary.mkdir()
        log = os.open(tree.parent / "log", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        null = os.open(os.devnull, os.O_RDONLY)
        for source, target in ((null, 0), (log, 1), (log, 2)):
            os.dup2(source, target)
        os.chdir(tree)
        path = [name for name in os.environ.get("PYTHONPATH", "").split(os.pathsep) if name]
        os.environ.update(PYTHONPATH=os.pathsep.join([names, *path]), TMPDIR=str(temporary), COLUMNS="120")
        scripts = Path(__file__).resolve().parent
        sys.path[:] = [names, *(name for name in sys.path if name and Path(name).resolve() != scripts)]
        sys.argv = ["pytest"]
        vars(sys.modules["__main__"]).pop("__file__", None)  # or a worker that a test spawns would import this program
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
        resource.setrlimit(resource.RLIMIT_FSIZE, (FILE_BYTES, FILE_BYTES))
        status = work()
        sys.stdout.flush()
        sys.stderr.flush()
    except BaseException:
        with suppress(BaseException):
            import traceback

            traceback.print_exc()
            sys.stderr.flush()
    finally:
        os._exit(status)


def start_keeper(work: Callable[[], Any], answer: Path) -> int:
    """Start a child that does work and writes its result as JSON. It ends its descendants when this process dies."""
    parent = os.getpid()
    child = os.fork()
    if child:
        return child
    status = 1
    try:
        prctl = ctypes.CDLL(None, use_errno=True).prctl
        prctl(SET_CHILD_SUBREAPER, 1, 0, 0, 0)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, _end)
        prctl(SET_PARENT_DEATH_SIGNAL, signal.SIGTERM, 0, 0, 0)
        if os.getppid() == parent:
            write_json(answer, work())
            status = 0
    except BaseException:
        import traceback

        traceback.print_exc()
    finally:
        end_descendants()
        os._exit(status)


def run_jobs(jobs: Iterable[tuple[str, Callable[[Path], Any]]], folder: Path, number: int) -> Iterator[tuple[str, Any]]:
    """Do jobs in `number` keepers at a time; each gets a folder of its keeper. Yields names and results as they end."""
    free = [folder / f"slot-{slot}" for slot in range(number)]
    running: dict[int, tuple[str, Path]] = {}
    queue = iter(jobs)
    while True:
        while free and (job := next(queue, None)) is not None:
            slot = free.pop()
            slot.mkdir(parents=True, exist_ok=True)
            (slot / "answer.json").unlink(missing_ok=True)
            name, work = job
            running[start_keeper(partial(work, slot), slot / "answer.json")] = name, slot
        if not running:
            return
        keeper, _ = os.wait()
        name, slot = running.pop(keeper)
        free.append(slot)
        answer = slot / "answer.json"
        if not answer.is_file():
            sys.exit(f"{name}: the driver failed, see the message above")
        yield name, json.loads(answer.read_text(encoding="utf-8"))


def _end(*_: object) -> NoReturn:
    end_descendants()
    os._exit(1)


def end_descendants() -> None:
    """End every descendant of this process, orphans included: this process is a subreaper, so they are its children."""
    while descendants := _descendants(os.getpid()):
        for process in descendants:
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        with suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG) != (0, 0):
                pass
        time.sleep(0.01)


def _descendants(process: int) -> list[int]:
    children: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            # The name of a program, in parentheses, may hold anything.
            parent = int(stat.read_text(errors="replace").rpartition(")")[2].split()[1])
            children.setdefault(parent, []).append(int(stat.parent.name))
    found = list(children.get(process, []))
    for descendant in found:
        found.extend(children.get(descendant, []))
    return found


def preload(modules: Iterable[str]) -> None:
    """Import modules of other projects once for all forked processes; skip modules that are not installed."""
    for library in ("OMP", "OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    for module in modules:
        with suppress(ImportError):
            importlib.import_module(module)


def write_json(path: Path, value: Any) -> None:
    """Write a file that is complete at any moment."""
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    with unfinished.open("w", encoding="utf-8") as file:
        json.dump(value, file, indent=1)
        file.write("\n")
        file.flush()
        os.fsync(file.fileno())
    unfinished.replace(path)


def lock(folder: Path) -> int:
    """Lock a folder of results against a second run; the lock ends with the process."""
    file = os.open(folder / ".lock", os.O_RDWR | os.O_CREAT, 0o600)
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        sys.exit(f"{folder}: another run uses this folder")
    return file
