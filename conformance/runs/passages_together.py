"""Passages of several functions together: each function waits at its passage until all others wait or have ended.

The functions take turns, so that only one of them runs at a time, and what one of them has kept serves the others.
Passages on one line with one time step then advance in lanes, with the bits of each alone (`model.dynamics.lanes`).
"""

from collections import defaultdict
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextvars import ContextVar, copy_context
from threading import Lock, Thread
from typing import TypeVar

from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.core_choice import UnusableCore
from pantocheck.model.dynamics.passage import History, Passage

Result = TypeVar("Result")
Request = tuple[DiscretisedLine, Passage, "Future[History]"]
"""Passage on a line, and its history to come."""


class PassageGate:
    """Gate at which the passages of some functions wait for each other."""

    def __init__(self, functions: int) -> None:
        self.turn = Lock()
        self._running = functions
        self._waiting = list[Request]()

    def simulate(self, line: DiscretisedLine, passage: Passage) -> History:
        """Simulate a passage together with those of the other functions; raises as if it were alone."""
        history = Future[History]()
        self._waiting.append((line, passage, history))
        self._simulate_if_all_wait()
        self.turn.release()
        try:
            return history.result()
        finally:
            self.turn.acquire()

    def leave(self) -> None:
        """End one of the functions."""
        self._running -= 1
        self._simulate_if_all_wait()

    def _simulate_if_all_wait(self) -> None:
        if len(self._waiting) < self._running:
            return
        groups: dict[tuple[int, float], list[Request]] = defaultdict(list)
        for request in self._waiting:
            groups[id(request[0]), request[1].time_step].append(request)
        self._waiting = []
        for group in groups.values():
            _answer(group)


GATE: ContextVar[PassageGate | None] = ContextVar("gate", default=None)
"""Gate of the function that runs; None: its passages are simulated at once."""


def _answer(group: Sequence[Request]) -> None:
    """Simulate passages on one line; after a failure each alone, so that only its own function fails."""
    from pantocheck.model.dynamics.lanes import simulate_passages

    try:
        found = simulate_passages(group[0][0], [passage for _, passage, _ in group])
    except Exception as error:
        if len(group) == 1:
            group[0][2].set_exception(error)
        else:
            for request in group:
                _answer([request])
    else:
        for (_, _, history), result in zip(group, found, strict=True):
            history.set_result(result)


def most_together() -> int:
    """Largest number of passages that are faster together on this machine; one without a core."""
    try:
        from pantocheck.model.dynamics.lanes import count_core_lanes

        return count_core_lanes()
    except (ModuleNotFoundError, UnusableCore):
        return 1


def run_together(functions: Sequence[Callable[[], Result]]) -> list[Result]:
    """Results of functions whose passages are simulated together."""
    gate, results = PassageGate(len(functions)), [Future[Result]() for _ in functions]

    def run(function: Callable[[], Result], result: Future[Result]) -> None:
        with gate.turn:
            try:
                GATE.set(gate)
                result.set_result(function())
            except BaseException as error:
                result.set_exception(error)
            finally:
                gate.leave()

    for function, result in zip(functions, results, strict=True):
        # The end of the process must not wait for them.
        Thread(target=copy_context().run, args=(run, function, result), daemon=True).start()
    return [result.result() for result in results]
