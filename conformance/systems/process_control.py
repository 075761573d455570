"""Processes on Linux: adoption and end of orphans, and an end with the parent. Elsewhere, nothing is done."""

import contextlib
import ctypes
import os
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER, _PR_GET_CHILD_SUBREAPER = 1, 36, 37  # linux/prctl.h
_LIBRARY = ctypes.CDLL(None) if sys.platform == "linux" else None

ROUNDS, PAUSE = 100, 0.02  # [s]
"""Rounds of ending orphans, each of which may leave children of its own."""


def die_with_parent(number: int = signal.SIGKILL) -> None:
    """Let the kernel send a signal to this process when its parent ends, even if the parent is killed."""
    if _LIBRARY is not None:
        _LIBRARY.prctl(_PR_SET_PDEATHSIG, int(number), 0, 0, 0)


@contextmanager
def adopt_orphans() -> Iterator[None]:
    """Become the parent of the orphans among all descendants, and end them with the context.

    A program of a system starts a session. A descendant that clears its environment and starts a further session has
    no mark any more, but when its parent ends, it becomes a child of this process in a session of its own.
    """
    if _LIBRARY is None:
        yield
        return
    before = ctypes.c_int(0)
    _LIBRARY.prctl(_PR_GET_CHILD_SUBREAPER, ctypes.byref(before), 0, 0, 0)
    known = set(_find_strangers())
    _LIBRARY.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    try:
        yield
    finally:
        _end_strangers(known)
        _LIBRARY.prctl(_PR_SET_CHILD_SUBREAPER, before.value, 0, 0, 0)


def interruption_exit_code(interruption: KeyboardInterrupt) -> int:
    """Exit code after a signal: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP; its handler adds the number."""
    return 128 + int(interruption.args[0] if interruption.args else signal.SIGINT)


def _end_strangers(known: set[int]) -> None:
    for _ in range(ROUNDS):
        strangers = set(_find_strangers()) - known
        if not strangers:
            return
        for process in strangers:
            with contextlib.suppress(ProcessLookupError, PermissionError, ChildProcessError):
                os.kill(process, signal.SIGKILL)
                os.waitpid(process, os.WNOHANG)
        time.sleep(PAUSE)


def _find_strangers() -> list[int]:
    """Children of this process in other sessions; the processes of a pool share its session."""
    own, session, strangers = os.getpid(), os.getsid(0), []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError, ValueError):
            # The name of the program, in brackets, may contain spaces.
            _, parent, _, sid = path.read_text(errors="replace").rpartition(")")[2].split()[:4]
            if int(parent) == own and int(sid) != session:
                strangers.append(int(path.parent.name))
    return strangers
