"""Server of test runs: it loads the packages of others once, and runs pytest in a copy of its process.

It reads a line of JSON from standard input, `[test files, limit of processor time [s]]`, and answers with the number of
the process, then with its status and its processor time [s].
"""

import importlib
import json
import math
import os
import resource
import sys

import pytest

LOADED = ("numba", "pydantic", "typer", "scipy.stats", "scipy.io", "scipy.linalg", "scipy.optimize", "scipy.signal")
"""Packages that most tests load, which takes longer than the median test."""


def run_tests(files: list[str], limit_s: float) -> int:
    """Run pytest without output in a session of its own, with a limit of processor time [s]."""
    os.setsid()
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(limit_s), math.ceil(limit_s) + 5))
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nothing, stream)
    importlib.invalidate_caches()
    return int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", *files]))


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
