"""Instrumented runs: the lines of the project that each test, and each of its shared fixtures, executes."""

import functools
import json
import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from verification.attacks.mutation_processes import run_child, run_pytest
from verification.attacks.mutation_project import NAMES, copy_tree

SUBPROCESS = """
import os, sys
if os.environ.get("MUTATION_CONTEXT"):
    import atexit, coverage
    tracer = coverage.Coverage(
        data_file=os.environ["MUTATION_DATA"], data_suffix=True, include=os.environ["MUTATION_FILES"].split(os.pathsep),
        context=os.environ["MUTATION_CONTEXT"], config_file=False,
    )
    tracer.set_option("run:disable_warnings", ["no-data-collected", "module-not-measured"])
    def save(*_):
        tracer.stop()
        tracer.save()
    atexit.register(save)
    if "--multiprocessing-fork" in sys.orig_argv:
        from multiprocessing import util
        util.register_after_fork(tracer, lambda tracer: util.Finalize(tracer, save, exitpriority=1000))
    tracer.start()
"""
"""sitecustomize.py of the Python programs that tests start."""


class _Tracer:
    """Pytest plugin: one coverage context and one time per test and per fixture that tests share."""

    def __init__(self, coverage: Any) -> None:
        self.coverage = coverage
        self.tests: dict[str, dict[str, Any]] = {}
        self.fixtures: dict[str, float] = {}
        self.contexts: list[str] = []
        self.lost = 0.0

    def enter(self, context: str) -> None:
        """Attribute the lines that follow to a test or fixture."""
        self.contexts.append(context)
        self.switch()

    def leave(self) -> None:
        """Attribute the lines that follow to the test or fixture before."""
        self.contexts.pop()
        self.switch()

    def switch(self) -> None:
        """Make the last context that of this process and of the programs that it starts."""
        context = self.contexts[-1] if self.contexts else ""
        self.coverage.switch_context(context)
        os.environ["MUTATION_CONTEXT"] = context or "outside tests"

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Trace a test; its time excludes the fixtures that tests share."""
        _clear_caches()
        definitions = item._fixtureinfo.name2fixturedefs if hasattr(item, "_fixtureinfo") else {}
        shared = [_fixture_name(found[-1]) for found in definitions.values() if found[-1].scope != "function"]
        self.tests[item.nodeid] = {"passed": False, "fixtures": shared, "seconds": 0.0}
        self.enter(item.nodeid)
        begin, self.lost = _processor_time(), 0.0
        try:
            return (yield)
        finally:
            self.leave()
            self.tests[item.nodeid]["seconds"] = round(_processor_time() - begin - self.lost, 4)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Iterator[Any]:
        """Trace the set-up of a fixture that tests share."""
        if fixturedef.scope == "function":
            return (yield)
        name = _fixture_name(fixturedef)
        begin, before = _processor_time(), self.lost
        self.enter(name)
        try:
            return (yield)
        finally:
            self.leave()
            seconds = _processor_time() - begin
            self.fixtures[name] = round(self.fixtures.get(name, 0.0) + seconds - (self.lost - before), 4)
            self.lost = before + seconds

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note whether a test has passed; a failed set-up or tear-down counts as a failure."""
        if report.when == "call":
            self.tests[report.nodeid]["passed"] = report.passed
        elif report.failed:
            self.tests[report.nodeid]["passed"] = False


def _processor_time() -> float:
    """Time of this process and of those that it has waited for [s]; a loaded machine does not lengthen it."""
    return sum(os.times()[:4])


def _fixture_name(fixture: Any) -> str:
    return f"fixture {fixture.argname} of {fixture.baseid}"


def _clear_caches() -> None:
    """Empty the caches of functions, which would give the lines of a computation to its first user alone."""
    for module in list(sys.modules.values()):
        if str(getattr(module, "__file__", "")).startswith(os.getcwd()):
            for value in list(vars(module).values()):
                if isinstance(value, functools._lru_cache_wrapper):
                    value.cache_clear()


def trace_tests(snapshot: Path, file: str, folders: list[str], slot: Path) -> dict[str, Any]:
    """Run one test file in a copy of the snapshot; its tests, fixtures and the lines that they execute.

    A run in which numba compiles a kernel is repeated, because the compilation is not part of the time of a test.
    """
    tree, answer = slot / "tree", slot / "traced.json"
    for _ in range(2):
        answer.unlink(missing_ok=True)
        copy_tree(snapshot, tree)
        run_child(tree, lambda: _trace(tree, file, folders, answer), limit=3600)
        if not adopt_compiled_files(tree, snapshot):
            break
    if not answer.is_file():
        log = (slot / "log").read_text(encoding="utf-8", errors="replace")
        return {"tests": {}, "fixtures": {}, "lines": {}, "problem": log[-2000:]}
    return json.loads(answer.read_text(encoding="utf-8"))


def _trace(tree: Path, file: str, folders: list[str], answer: Path) -> int:
    import coverage

    site, data = tree.parent / "site", Path(os.environ["TMPDIR"]) / "coverage"
    site.mkdir(exist_ok=True)
    (site / "sitecustomize.py").write_text(SUBPROCESS, encoding="utf-8")
    include = [f"{tree.resolve()}/{folder}/*" for folder in folders]
    os.environ["PYTHONPATH"] += os.pathsep + str(site)
    os.environ.update(
        MUTATION_DATA=str(data), MUTATION_FILES=os.pathsep.join(include), MUTATION_CONTEXT="outside tests"
    )
    measurement = coverage.Coverage(data_file=str(data), data_suffix=True, include=include, config_file=False)
    measurement.start()
    tracer = _Tracer(measurement)
    status = run_pytest([file], [tracer])
    measurement.stop()
    measurement.save()
    lines: dict[str, dict[str, set[int]]] = {}
    for path in data.parent.glob(f"{data.name}.*"):
        part = coverage.CoverageData(str(path))
        part.read()
        for measured in part.measured_files():
            contexts = lines.setdefault(str(Path(measured).relative_to(tree.resolve())), {})
            for line, names in part.contexts_by_lineno(measured).items():
                for name in names:
                    contexts.setdefault(name, set()).add(line)
    found = {
        "tests": tracer.tests,
        "fixtures": tracer.fixtures,
        "lines": {
            path: {name: sorted(numbers) for name, numbers in contexts.items()} for path, contexts in lines.items()
        },
    }
    answer.write_text(json.dumps(found), encoding="utf-8")
    return status


def adopt_compiled_files(tree: Path, snapshot: Path) -> bool:
    """Keep the files that a run has compiled; true if there is a new one of numba.

    For each function the larger set of files is kept. Two sets are never mixed, because their numbering differs.
    """
    adopted = False
    for folder in tree.rglob("__pycache__"):
        if folder.is_symlink() or NAMES in folder.parts:
            continue
        target = snapshot / folder.relative_to(tree)
        target.mkdir(exist_ok=True)
        for index in folder.glob("*.nbi"):
            pattern = f"{_literal(index.stem)}.*.nbc"
            new, old = list(folder.glob(pattern)), list(target.glob(pattern))
            if len(new) > len(old):
                adopted = True
                for path in (target / index.name, *old):
                    path.unlink(missing_ok=True)
                for path in (*new, index):
                    shutil.copy2(path, target / path.name)
        for path in folder.glob("*.pyc"):
            if not (target / path.name).exists():
                shutil.copy2(path, target / path.name)
    return adopted


def _literal(name: str) -> str:
    return "".join(f"[{character}]" if character in "[]*?" else character for character in name)
