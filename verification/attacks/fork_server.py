"""Server of test runs: it loads the packages of others once, and runs pytest in a copy of its process.

It reads a line of JSON from standard input: arguments of pytest, limit of processor time [s], and a file for the
coverage or null. It answers with the number of the process, then with its status and its processor time [s].
"""

import importlib
import json
import math
import os
import resource
import sys
import time
from collections import defaultdict
from pathlib import Path

import coverage
import pytest

LOADED = ("numba", "pydantic", "typer", "scipy.stats", "scipy.io", "scipy.linalg", "scipy.optimize", "scipy.signal")
"""Packages that most tests load, which takes longer than the median test."""


class CoverageRecorder:
    """Plug-in of pytest: lines of the product that each test executes, and its processor time."""

    def __init__(self, folder: Path) -> None:
        sources = [str(folder / name / "*") for name in ("model", "conformance")]
        self.folder, self.test, self.begin = folder, "", time.process_time()
        self.seconds: defaultdict[str, float] = defaultdict(float)
        self.coverage = coverage.Coverage(data_file=None, config_file=False, include=sources)
        self.coverage.start()

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """Begin a test."""
        now = time.process_time()
        self.seconds[self.test] += now - self.begin
        self.test, self.begin = nodeid, now
        self.coverage.switch_context(nodeid)

    def write(self, path: Path) -> None:
        """Write the seconds of every test, and the tests of every line as the bits of a hexadecimal number."""
        self.pytest_runtest_logstart("")
        self.coverage.stop()
        del self.seconds[""]  # the loading of the tests
        bits = {test: 1 << number for number, test in enumerate(self.seconds)} | {"": 0}
        data, lines = self.coverage.get_data(), {}
        for name in data.measured_files():
            tests = {
                line: hex(sum(bits[test] for test in set(found)))
                for line, found in data.contexts_by_lineno(name).items()
            }
            lines[Path(name).relative_to(self.folder.resolve()).as_posix()] = tests
        path.write_text(json.dumps({"lines": lines, "seconds": self.seconds}), "utf-8")


def run_tests(arguments: list[str], limit_s: float, record: str | None) -> int:
    """Run pytest without output in a session of its own, with a limit of processor time [s]."""
    os.setsid()
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(limit_s), math.ceil(limit_s) + 5))
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nothing, stream)
    importlib.invalidate_caches()
    options = ["-q", "-p", "no:cacheprovider", *arguments]
    if record is None:
        return int(pytest.main(options))
    recorder = CoverageRecorder(Path.cwd())
    code = int(pytest.main(options, plugins=[recorder]))
    recorder.write(Path(record))
    return code


def main() -> None:
    """Answer the requests until standard input ends."""
    for name in LOADED:
        importlib.import_module(name)
    for line in sys.stdin:
        request = json.loads(line)
        process = os.fork()
        if process == 0:
            os._exit(run_tests(*request))
        print(process, flush=True)
        _, status, usage = os.wait4(process, 0)
        print(json.dumps([status, usage.ru_utime + usage.ru_stime]), flush=True)


if __name__ == "__main__":
    main()
