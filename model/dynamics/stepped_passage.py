"""Passage of one pantograph that a caller advances step by step, with an additional force on its head.

The arguments of the core in C are packed once, so that a step takes some microseconds: that of a program in real time.
"""

import ctypes
import struct
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from pantocheck.model.description.failures import ImpossiblePassage
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.active_window import build_window_arrays
from pantocheck.model.dynamics.core_choice import choose_core, pack_argument
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.passage import History, Passage
from pantocheck.model.dynamics.recording import allocate_recording, refuse_divergence
from pantocheck.model.dynamics.simulation import build_history, start_motion


class HeadState(NamedTuple):
    """Head of the pantograph at the end of a step."""

    height: float
    """Height above that at the start [m]."""
    velocity: float
    """[m/s]."""
    force: float
    """Contact force [N]."""


class SteppedPassage:
    """Passage of a linear pantograph with one strip, in the core in C.

    Args:
        line: Discretised line.
        passage: Pantograph, start, speed, duration and time step.

    Raises:
        ImpossiblePassage: The pantograph has joints or several strips, there are several, or there is no core in C.
    """

    def __init__(self, line: DiscretisedLine, passage: Passage) -> None:
        core = choose_core()
        if core.library is None:
            raise ImpossiblePassage(f"a passage in real time needs the core in C; found {core.name}")
        if len(passage.pantographs) != 1 or len(passage.pantographs[0].strips) != 1 or passage.pantographs[0].joints:
            raise ImpossiblePassage("a passage in steps has one linear pantograph with one strip")
        self.passage, self.steps = passage, round(passage.duration / passage.time_step)
        self._window = build_window_arrays(line, passage)
        kernel = build_kernel_arrays(line, passage.time_step, self._window)
        motion, train = start_motion(line, kernel, passage)
        self._train = train
        self._recording = allocate_recording(line, passage.watched, self.steps, 1)
        self._last = allocate_recording(line, passage.watched, 1, 1)
        self._own_force, self._head = train.force[0].copy(), train.head[0]
        self.start_height = float(self._head @ train.z[0, 0])
        self.start_force = float(train.contact.sum())
        moved = [*motion, train.position, train.elapsed, train.z, train.contact]
        self._start = [(array, array.copy()) for array in moved]
        # The packed words hold addresses: the arrays live as long as this object.
        self._arguments = (kernel, motion, train, build_workspace(kernel, train), np.zeros(1), self._last)
        words = b"".join(map(pack_argument, self._arguments))
        self._words = struct.pack("=q", len(words) + 8) + words
        self._advance: Callable[[bytes], Any] = core.library.pantocheck_advance
        core.library.pantocheck_advance.argtypes = [ctypes.c_char_p]
        core.library.pantocheck_advance.restype = ctypes.c_double
        self.step = 0

    def restart(self) -> None:
        """Return to rest at the start."""
        for array, copy in self._start:
            array[...] = copy
        self.step = 0

    def advance(self, added_force: float) -> HeadState:
        """Advance by one step under an additional upward force on the head [N].

        Raises:
            DidNotConverge: The forces of the step did not converge.
        """
        self._train.force[0] = self._own_force + added_force * self._head
        if self._advance(self._words) != 1:
            refuse_divergence(self.step, self.passage.time_step)
        for kept, last in zip(self._recording[2:], self._last[2:], strict=True):
            kept[self.step] = last[0]
        self.step += 1
        z = self._train.z[:, 0] @ self._head
        return HeadState(float(z[0]) - self.start_height, float(z[1]), float(self._last.contact[0, 0]))

    def build_history(self) -> History:
        """History of the passage, after its last step."""
        return build_history(self.passage, self._window, self._train, self._recording)
