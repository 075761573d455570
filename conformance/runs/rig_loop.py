"""Loop of a rig in real time: one step per tick of a clock, its times, and its log."""

import gc
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Protocol

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.runs.rig_control import RigControl, RigRow
from pantocheck.conformance.runs.rig_link import RigLink

LOG_BLOCK = 256
"""Rows of the log that are written at once."""
BINS = 20_000
"""Bins of a histogram of times, each of 1 us; the last one holds all longer times."""
LOOP_PRIORITY = 10
"""Priority of the loop among the processes in real time of Linux."""


class LoopClock(Protocol):
    """Clock of a loop."""

    def now(self) -> float:
        """Time [s]."""

    def wait(self, until: float) -> None:
        """Wait until a time [s]."""


class SystemClock:
    """Steady clock of the system."""

    def now(self) -> float:
        """Time [s]."""
        return time.perf_counter()

    def wait(self, until: float) -> None:
        """Sleep until a time [s]."""
        if (left := until - time.perf_counter()) > 0:
            time.sleep(left)


@dataclass
class TimeHistogram:
    """Distribution of a time of all steps."""

    counts: RealArray = field(default_factory=lambda: np.zeros(BINS))
    """Steps by their time in whole microseconds."""
    worst_s: float = 0.0

    def add(self, seconds: float) -> None:
        """Count a step."""
        self.counts[min(int(1e6 * seconds), BINS - 1)] += 1
        self.worst_s = max(self.worst_s, seconds)

    def quantile_us(self, share: float) -> float:
        """Time that a share of the steps does not exceed, rounded up to whole microseconds."""
        return float(np.searchsorted(np.cumsum(self.counts), share * self.counts.sum()) + 1)


@dataclass
class RigTimes:
    """Times of the steps of a run."""

    work: TimeHistogram = field(default_factory=TimeHistogram)
    """From the start of a step until its command has left."""
    lateness: TimeHistogram = field(default_factory=TimeHistogram)
    """From the tick to the start of its step."""
    delay: TimeHistogram = field(default_factory=TimeHistogram)
    """Age of the command that acted at the last sample."""
    steps: int = 0
    missed: int = 0
    """Steps whose command left after the next tick."""


class RigLog:
    """Log of a run as a file of rows of 64-bit numbers, which is written while the loop runs."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file, self._rows = file, np.zeros((LOG_BLOCK, len(RigRow._fields)))
        self._filled = 0

    def add(self, row: RigRow) -> None:
        """Add a row."""
        self._rows[self._filled] = row
        self._filled += 1
        if self._filled == LOG_BLOCK:
            self.flush()

    def flush(self) -> None:
        """Write the rows that are not written yet."""
        self._file.write(self._rows[: self._filled].tobytes())
        self._filled = 0


def run_loop(control: RigControl, link: RigLink, clock: LoopClock, log: RigLog) -> RigTimes:
    """Run a rig until its control has finished, one step per time step of the line."""
    times, begin = RigTimes(), clock.now()
    try:
        while not control.finished:
            tick = begin + times.steps * control.dt
            clock.wait(tick)
            start = clock.now()
            command = control.advance(link.receive(), start - tick)
            link.send(command)
            row, end = control.row(), clock.now()
            times.steps += 1
            times.missed += end > tick + control.dt
            times.work.add(end - start)
            times.lateness.add(max(start - tick, 0.0))
            if row.delay == row.delay:
                times.delay.add(row.delay)
            log.add(row)
    except BaseException:
        # An interruption stops the rig as a limit does.
        control.interrupt()
        while not control.finished:
            clock.wait(clock.now() + control.dt)
            link.send(control.advance((), 0.0))
        raise
    finally:
        log.flush()
    return times


def convert_log(rows: Path, out: Path) -> None:
    """Write the rows of a log as NumPy file with named columns."""
    table = np.dtype([(name, "<f8") for name in RigRow._fields])
    np.save(out, np.fromfile(rows, table))


@contextmanager
def prefer_loop() -> Iterator[bool]:
    """Run a block before other processes, if the system allows it, and without collection of garbage; whether so."""
    preferred, gathers = False, gc.isenabled()
    with suppress(AttributeError, OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(LOOP_PRIORITY))
        preferred = True
    gc.disable()
    try:
        yield preferred
    finally:
        if gathers:
            gc.enable()
        if preferred:
            os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
