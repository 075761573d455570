"""Display of progress on standard error: completed share, remaining time, task and step.

=====================  ===========================================================
output                 rule
=====================  ===========================================================
terminal               one line, cut to the width, redrawn at most `REDRAWS_PER_S` times a second
file, pipe or log      one line every `LOG_INTERVAL_S`, none for a shorter command; a warning at once
`-q`                   nothing
=====================  ===========================================================
"""

import logging
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from datetime import timedelta

from rich.console import Console
from rich.live import Live
from rich.text import Text

from pantocheck.conformance.app.commands.command_output import ROOT_LOGGER
from pantocheck.conformance.app.commands.console import error_console
from pantocheck.conformance.app.commands.guard import strip_control_characters
from pantocheck.conformance.app.commands.output_settings import current_settings
from pantocheck.conformance.core.step_log import TaskStep
from pantocheck.conformance.results.results_format import CaseResult

_LOGGER = logging.getLogger(__name__)

LOG_INTERVAL_S = 10.0
"""Time between two lines outside of a terminal [s]: a run of an hour writes 360 lines."""

REDRAWS_PER_S = 3.0
"""Redraws on a terminal [1/s]: a log of the terminal grows by some kilobytes a minute."""

FIRST_SHARE = 0.1
"""Completed share from which the remaining time is estimated; below, the estimate is an extrapolation by 10 times."""


@contextmanager
def show_line(describe: Callable[[], str]) -> Iterator[None]:
    """Show a line of progress while a computation runs; an empty line is not shown."""
    errors = error_console()
    if current_settings().detail == "quiet":
        yield
    elif errors.is_terminal:
        line = _LiveLine(describe)
        with Live(line, console=errors, refresh_per_second=REDRAWS_PER_S, transient=True):
            yield
    else:
        with _print_periodically(describe, errors):
            yield


class _LiveLine:
    """Line that is described anew for every redraw."""

    def __init__(self, describe: Callable[[], str]) -> None:
        self._describe = describe

    def __rich__(self) -> Text:
        return Text(strip_control_characters(self._describe()), no_wrap=True, overflow="ellipsis")


@contextmanager
def _print_periodically(describe: Callable[[], str], output: Console) -> Iterator[None]:
    ended = threading.Event()

    def print_lines() -> None:
        while not ended.wait(LOG_INTERVAL_S):
            if line := strip_control_characters(describe()):
                output.print(Text(f"{time.strftime('%H:%M:%S')} {line}"), soft_wrap=True)  # for a search in a log

    thread = threading.Thread(target=print_lines, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


class TaskProgress(logging.Handler):
    """Progress of tasks that report their steps to the loggers `pantocheck.*`.

    The title is their purpose; `work` has the work of tasks by their names, in any unit. Without it, each has the same.
    """

    def __init__(
        self,
        title: str,
        total: int,
        clock: Callable[[], float] = time.monotonic,
        work: Mapping[str, float] | None = None,
    ) -> None:
        super().__init__()
        self._title, self._total, self._clock, self._work = title, total, clock, work or {}
        self._begin, self._finished, self._done = clock(), 0, 0.0
        self._steps: dict[str, TaskStep] = {}
        self._task: str | None = None
        self._reached: list[tuple[float, float]] = []

    def begin_task(self, name: str) -> None:
        """Begin a task that may report no steps; the task before it is finished."""
        if self._task is not None:
            self.finish_task()
        self._total = max(self._total, self._finished + 1)  # a computation can repeat a task
        self._task = name
        _LOGGER.info("%s", name)

    def reach(self, task: str, finished: int, share: float) -> None:
        """State the latest finished task, the number of finished ones and their share of the duration of all.

        The first statement counts the tasks that an earlier run has finished.
        """
        self._task, self._finished, self._steps = task or None, finished, {}
        self._reached = [*self._reached[:1], (self._clock(), share)]

    def emit(self, record: logging.LogRecord) -> None:
        """Keep the step of a record; print a warning at once, above a live line."""
        if record.levelno == logging.WARNING and current_settings().detail != "verbose":  # whose log prints it
            error_console().print(Text(strip_control_characters(record.getMessage())), soft_wrap=True)
        if isinstance(step := getattr(record, "step", None), TaskStep):
            if self._reached:  # a part has cases without an end of their own: only the latest is named
                self._steps = {}
            self._steps[step.task] = step

    def finish_task(self, name: str = "") -> None:
        """Count a finished task; its steps begin with `name`, which is empty if no other task runs."""
        self._finished += 1
        self._done += self._weigh(name)
        self._steps = {task: step for task, step in self._steps.items() if not task.startswith(name)}

    def describe(self) -> str:
        """Progress in one line."""
        parts, steps = [], list(self._steps.values())
        now, (share, remaining) = self._clock(), self._estimate()
        if steps or self._reached or self._total > 1:  # the share of a program, a task without steps, is not known
            parts.append(f"{100 * share:.0f} %")
        if remaining is None:
            parts.append(f"{timedelta(seconds=round(now - self._begin))} elapsed")
        else:
            parts.append(f"about {timedelta(seconds=round(remaining))} remaining")
        parts.append(f"{self._title}: {self._finished} of {self._total} finished" if self._total > 1 else self._title)
        if steps:
            parts += [f"{step.task}: {step.name}" for step in steps]
        elif self._task is not None:
            parts.append(self._task)
        return ", ".join(parts)

    def _weigh(self, task: str) -> float:
        """Work of a task, or of a part whose name begins with that of its task."""
        matching = (work for name, work in self._work.items() if f"{task}/".startswith(f"{name}/"))
        return next(matching, 0.0 if self._work else 1.0)

    def _estimate(self) -> tuple[float, float | None]:
        """Completed share, and remaining time [s]; None: too little is done, or the time of the estimate is over."""
        now = self._clock()
        if self._reached:
            (begin, first), (latest, share) = self._reached[0], self._reached[-1]
        else:
            completed = self._done + sum(step.completed * self._weigh(step.task) for step in self._steps.values())
            total = sum(self._work.values()) or self._total
            begin, first, latest, share = self._begin, 0.0, now, min(completed / total, 1.0)
        if share - first < FIRST_SHARE:
            return share, None
        remaining = (latest - begin) * (1 - share) / (share - first) - (now - latest)
        return share, remaining if remaining >= 1 or share >= 1 else None


@contextmanager
def follow_steps(title: str, total: int = 1, work: Mapping[str, float] | None = None) -> Iterator[TaskProgress]:
    """Show the progress of tasks while they run; parameters as in `TaskProgress`."""
    progress, logger = TaskProgress(title, total, work=work), logging.getLogger(ROOT_LOGGER)
    if current_settings().detail == "quiet":
        yield progress
        return
    level = logger.level
    logger.addHandler(progress)
    logger.setLevel(logging.DEBUG)  # the shares of steps
    try:
        with show_line(progress.describe):
            yield progress
    finally:
        logger.removeHandler(progress)
        logger.setLevel(level)


@contextmanager
def report_cases(
    cases: int, title: str = "running cases", work: Mapping[str, float] | None = None
) -> Iterator[Callable[[CaseResult], None]]:
    """Show the progress of cases; yields the callback of the runner. Parameters as in `TaskProgress`."""
    with follow_steps(title, cases, work) as progress:
        yield lambda result: progress.finish_task(result.id)
