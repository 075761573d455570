"""Worker processes that run cases: one thread each, signals, and their end."""

import os
import signal
import time
from collections.abc import Collection
from multiprocessing.process import BaseProcess
from types import FrameType

from pantocheck.conformance.systems.process_control import end_with_parent

GRACE = 2.0
"""Time of a process to end its program after a signal [s]."""


def limit_threads() -> None:
    """Let processes that start later use one thread of linear algebra; more would slow them down more than twofold.

    The libraries read these variables when they are loaded. A value set by the user is kept.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")


def handle_worker_signals() -> None:
    """Let a signal end a worker and the program of its case; only the parent process reports the signal."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _exit_on_signal)
    end_with_parent(signal.SIGTERM)


def end_workers(workers: Collection[BaseProcess]) -> None:
    """End worker processes: a signal lets each worker end its program; a worker that still runs is killed."""
    for worker in workers:
        worker.terminate()
    limit = time.monotonic() + GRACE
    for worker in workers:
        worker.join(max(0.0, limit - time.monotonic()))
        worker.kill()


def _exit_on_signal(number: int, frame: FrameType | None) -> None:
    # The exception lets a system end its processes first. A pool would keep this process alive; the alarm ends it.
    if hasattr(signal, "alarm"):
        signal.alarm(int(GRACE))
    raise SystemExit(128 + number)
