"""Steps of long computations, as records of the standard logging, which a display of progress can follow.

The loggers are named after their modules, `pantocheck.*`. Without a handler of the user, nothing is printed.
"""

import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import partial

logging.getLogger("pantocheck").addHandler(logging.NullHandler())


ShareCallback = Callable[[float], None]
"""Function that is called from time to time with the completed share, 0 to 1."""


def ignore_progress(share: float) -> None:
    """Follow no progress."""


def build_part_callback(progress: ShareCallback, begin: float, end: float) -> ShareCallback:
    """Callback of a part of a computation.

    Args:
        progress: Callback of the whole computation.
        begin, end: Completed shares of the whole before and after the part, 0 to 1.
    """
    return lambda share: progress(begin + (end - begin) * share)


@dataclass(frozen=True)
class TaskStep:
    """Position in a task."""

    task: str
    """Task, such as the id of a case."""
    name: str
    """Step that runs."""
    completed: float
    """Completed share of the task, 0 to 1."""


_PART: ContextVar[tuple[float, float]] = ContextVar("part_of_task", default=(0.0, 1.0))
"""Shares of the task at which the present part begins and ends."""


@contextmanager
def use_part(begin: float, end: float) -> Iterator[None]:
    """Count the steps inside as one part of a task.

    Args:
        begin, end: Completed shares of the task before and after the part, 0 to 1.
    """
    token = _PART.set((begin, end))
    try:
        yield
    finally:
        _PART.reset(token)


@dataclass(frozen=True)
class StepSequence:
    """Steps of a task in their order."""

    logger: logging.Logger
    """Logger of the module that executes the steps."""
    task: str
    """Task, such as the id of a case."""
    weights: Mapping[str, float]
    """Estimated duration of every step, in any unit."""

    def begin(self, name: str) -> ShareCallback:
        """Report the start of a step; return the callback of its completed share, 0 to 1."""
        return self.begin_together(name, [name])[0]

    def begin_together(self, label: str, names: Sequence[str]) -> list[ShareCallback]:
        """Report the start of steps that run at the same time, under one label.

        Args:
            label: Name of all of them together.
            names: Steps that follow each other in `weights`.

        Returns:
            Callback of the completed share of every step.
        """
        order, (begin, end) = list(self.weights), _PART.get()
        scale = (end - begin) / sum(self.weights.values())
        before = begin + scale * sum(self.weights[earlier] for earlier in order[: order.index(names[0])])
        self.logger.info("%s: %s", self.task, label, extra={"step": TaskStep(self.task, label, before)})
        shares = dict.fromkeys(names, 0.0)

        def report(name: str, share: float) -> None:
            shares[name] = share
            completed = before + scale * sum(shares[step] * self.weights[step] for step in names)
            self.logger.debug("%s: %s", self.task, label, extra={"step": TaskStep(self.task, label, completed)})

        return [partial(report, name) for name in names]


def report_remote(logger: logging.Logger, task: str) -> None:
    """Report the start of a task in another process, whose steps are not followed."""
    name = "in a process of its own"
    logger.info("%s: %s", task, name, extra={"step": TaskStep(task, name, 0.0)})
