"""Signals that end a run: a signal after the last case waits until the reports are written."""

import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

import typer

from pantocheck.conformance.execution.runner import Progress
from pantocheck.conformance.results.results_format import CaseResult

SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")


REPEAT_S = 1.0
"""Time in which a signal is the same as the first [s]: `timeout` sends its signal to the program and to its group."""


WAITING = b"Interrupted: the reports are still written. A second signal ends the command at once.\n"


class Interruption:
    """Signals of a run. After its last case, a first signal does not end it, but sets `exit_code`."""

    def __init__(self, open_cases: int) -> None:
        self.exit_code = 0
        self._open_cases = open_cases
        self._first_s: float | None = None

    def follow(self, progress: Progress, cases: int) -> Progress:
        """Callback of the runner that counts the finished cases, and passes each result on."""
        self._open_cases = cases

        def keep(result: CaseResult) -> None:
            progress(result)
            self._open_cases -= 1

        return keep

    def receive(self, number: int, frame: FrameType | None) -> None:
        """Handler of the signals: KeyboardInterrupt if a case is open, or at the second signal."""
        now, first = time.monotonic(), self._first_s
        if first is None:
            self._first_s = now
            if not self._open_cases:
                self.exit_code = 128 + number
                os.write(2, WAITING)  # a handler must not use a buffered stream
                return
        elif now - first < REPEAT_S:
            return
        raise KeyboardInterrupt(number)


@contextmanager
def receive_signals(results: Path, open_cases: int) -> Iterator[Interruption]:
    """Receive the signals of a run; if it ends early, state whether the file of its results is written."""
    interruption, before = Interruption(open_cases), _identify(results)
    names = SIGNALS if threading.current_thread() is threading.main_thread() else ()
    numbers = [getattr(signal, name) for name in names if hasattr(signal, name)]
    # A parent such as nohup may ignore a signal.
    handlers = {number: handler for number in numbers if callable(handler := signal.getsignal(number))}
    try:
        for number in handlers:
            signal.signal(number, interruption.receive)
        yield interruption
    except KeyboardInterrupt:
        typer.echo(_describe_results(results, before), err=True)
        raise
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)


def _identify(file: Path) -> tuple[int, int] | None:
    """Number and time of a file; None if there is none."""
    if not file.is_file():
        return None
    status = file.stat()
    return status.st_ino, status.st_mtime_ns


def _describe_results(results: Path, before: tuple[int, int] | None) -> str:
    if (now := _identify(results)) is None:
        return "No results are written."
    if now == before:
        return f"No results are written; {results} is of an earlier run."
    return f"{results} has the results. Not all other files are written; those in the folder may be of an earlier run."
