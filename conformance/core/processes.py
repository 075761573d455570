"""Control of child and worker processes on Linux: end with the parent, adoption and end of orphans, signals.

On other platforms the functions have no effect.
"""

import contextlib
import ctypes
import gc
import os
import signal
import sys
import threading
import time
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from multiprocessing.process import BaseProcess

_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER, _PR_GET_CHILD_SUBREAPER = 1, 36, 37  # linux/prctl.h
_LIBRARY = ctypes.CDLL(None) if sys.platform == "linux" else None

KILL = getattr(signal, "SIGKILL", signal.SIGTERM)
"""Signal that no process can ignore; Windows has none, and its functions end a process at once."""

ROUNDS, PAUSE = 100, 0.02  # [s]
"""Number of rounds that end orphans, and pause between two rounds; an orphan that ends can leave further orphans."""


def end_with_parent(number: int = KILL) -> None:
    """Let the kernel send a signal to this process when its parent ends, even if the parent is killed."""
    if _LIBRARY is not None:
        _LIBRARY.prctl(_PR_SET_PDEATHSIG, int(number), 0, 0, 0)


@contextmanager
def adopt_orphans() -> Iterator[None]:
    """Adopt every descendant whose parent ends; end the adopted processes at the end of the context.

    A descendant of a program can clear its environment and start its own session. It then has no mark. When its parent
    ends, it becomes a child of this process, which recognises it by its other session.
    """
    if _LIBRARY is None:
        yield
        return
    before = ctypes.c_int(0)
    _LIBRARY.prctl(_PR_GET_CHILD_SUBREAPER, ctypes.byref(before), 0, 0, 0)
    known = set(_list_foreign_children())
    _LIBRARY.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    try:
        yield
    finally:
        _end_foreign_children(known)
        _LIBRARY.prctl(_PR_SET_CHILD_SUBREAPER, before.value, 0, 0, 0)


def interruption_exit_code(interruption: KeyboardInterrupt) -> int:
    """Exit code after a signal: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP."""
    return 128 + int(interruption.args[0] if interruption.args else signal.SIGINT)


def _end_foreign_children(known: set[int]) -> None:
    for _ in range(ROUNDS):
        children = set(_list_foreign_children()) - known
        if not children:
            return
        for process in children:
            with contextlib.suppress(ProcessLookupError, PermissionError, ChildProcessError):
                os.kill(process, KILL)
                os.waitpid(process, os.WNOHANG)
        time.sleep(PAUSE)


def _list_foreign_children() -> list[int]:
    """Children of this process in other sessions; the workers of a pool are in the same session."""
    this_process, session, children = os.getpid(), os.getsid(0), []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError, ValueError):
            # The name of the program, in brackets, may contain spaces.
            _, parent, _, sid = path.read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()[:4]
            if int(parent) == this_process and int(sid) != session:
                children.append(int(path.parent.name))
    return children


# Worker processes that run cases: one thread each, signals, and their end.
GRACE = 2.0
"""Time of a process to end its program after a signal [s]."""


def count_processors() -> int:
    """Number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Variables of the environment that libraries of linear algebra read when they are loaded."""

_CHOSEN: set[str] = set()


def limit_threads() -> None:
    """Let linear algebra use one thread, here if its libraries are not loaded yet, and in processes that start later.

    On matrices of a few hundred unknowns, more threads wait for each other. A value set by the user is kept.
    """
    _CHOSEN.update(name for name in THREAD_VARIABLES if name not in os.environ)
    os.environ |= dict.fromkeys(_CHOSEN, "1")


def list_user_variables() -> dict[str, str]:
    """Environment without the variables that `limit_threads` has set: that of a program of the user."""
    return {name: value for name, value in os.environ.items() if name not in _CHOSEN}


GARBAGE_THRESHOLD = 300_000
"""New objects between two searches for cycles of unused objects; with 700, they take 8 % of an identification.

The classes of a command are 130,000 objects: no search begins before its work."""


def delay_garbage_searches() -> None:
    """Search this process for cycles of unused objects more rarely than Python does."""
    gc.set_threshold(GARBAGE_THRESHOLD)


ORPHAN_GRACE = 1.0
"""Time of a worker to end its program after its parent has ended [s]; two seconds later, no worker may be left."""


def handle_worker_signals() -> None:
    """Let a signal, or the end of the parent, end a worker and the program of its case; only the parent reports it."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _exit_on_signal)
    end_with_parent(signal.SIGTERM)
    threading.Thread(target=_follow_parent, daemon=True).start()


def _follow_parent() -> None:
    """End this process after its parent, which may have been killed before or during a compiled kernel.

    Python runs the handler of a signal between two of its own instructions only. A kernel lets other threads run.
    """
    from multiprocessing.process import parent_process  # its package takes 10 ms, which only workers need

    if (parent := parent_process()) is not None:
        parent.join()
        time.sleep(ORPHAN_GRACE)
        os._exit(128 + signal.SIGTERM)


def end_workers(workers: Collection["BaseProcess"]) -> None:
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
