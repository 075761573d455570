"""Driver of the time step: advances line and pantographs and records their motion."""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple, NoReturn

import numpy as np

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.failures import DidNotConverge
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.active_window import active_window
from pantocheck.model.dynamics.extents import active_run
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, Workspace, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays, entry_kernel, kernel
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.passage import FrameRequest, Frames
from pantocheck.model.dynamics.train import Train

BLOCK = 500
"""Number of steps between two reports of progress."""


class Recording(NamedTuple):
    """Recorded time series; T steps, C strips, U stations."""

    row: Indices
    station: Indices
    """Rows and stations whose motion is recorded, (U,)."""
    contact: Array
    """Contact force of each strip, summed over the contact wires, (T, C) [N]."""
    height: Array
    """Height of the strips where the wires touch them, (T, C) [m]; below the axis of the track without contact."""
    motion: Array
    """Displacement, velocity, acceleration at the stations, (T, U, 3) [m, m/s, m/s2]."""
    slack: Indices
    """Number of slack droppers in the active window, (T,)."""

    def cut(self, steps: slice) -> "Recording":
        """Part of the recording."""
        contact, height, motion = self.contact[steps], self.height[steps], self.motion[steps]
        return Recording(self.row, self.station, contact, height, motion, self.slack[steps])


@dataclass
class FrameRecorder:
    """Recorder of a moving picture: copies the state of line and pantographs after the requested steps."""

    request: FrameRequest
    kernel: KernelArrays
    connectors: int
    """Number of connectors, whose tensions are the first scalar forces."""
    taken: list[tuple[Array, Array, Array]] = field(default_factory=list)

    def take(self, steps: int, motion: Motion, train: Train) -> None:
        """Copy the state after a number of steps if it is requested."""
        if steps in self.request.steps:
            at, quarter = np.ix_(self.request.rows, self.request.stations), self.kernel.time_step**2 / 4
            displacement = motion.w[0][at] + quarter * motion.w[2][at]
            self.taken.append((displacement, motion.force[: self.connectors].copy(), train.z[0].copy()))

    def build_frames(self) -> Frames:
        """Frames that were taken."""
        return Frames(*(np.array(part) for part in zip(*self.taken, strict=True)))


def simulate_steps(
    kernel: KernelArrays,
    motion: Motion,
    train: Train,
    load: Array,
    recording: Recording,
    progress: Callable[[float], None] | None = None,
    frames: FrameRecorder | None = None,
) -> None:
    """Advance line and pantographs, in place, by the steps of a recording, and fill it.

    Args:
        kernel: Arrays of the line.
        motion: State of the line.
        train: State of the pantographs.
        load: External load in each step, upwards, (T,) [N].
        recording: Recording of T steps.
        progress: Called from time to time with the completed share, 0 to 1.
        frames: Recorder of a moving picture; None: none is requested.

    Raises:
        DidNotConverge: The forces of a time step did not converge.
    """
    work = build_workspace(kernel, train)
    advance = bind_arrays(_advance, kernel, motion, train, work)
    stops = {*range(BLOCK, load.size, BLOCK), load.size, *(frames.request.steps if frames else ())}
    for first, end in pairwise((0, *sorted(stops))):
        block = slice(first, end)
        steps = advance(load[block], recording.cut(block))
        if steps < end - first:
            refuse_divergence(first + steps, kernel.time_step)
        if frames:
            frames.take(end, motion, train)
        if progress and (end % BLOCK == 0 or end == load.size):
            progress(end / load.size)


@kernel
def _rise_at_wires(train: Train, work: Workspace, c: int) -> float:
    """Height of strip c at the lateral positions of its wires above that below the axis, times their forces [N m]."""
    rise, contact = 0.0, work.contact
    for n in range(contact.number_above[c]):
        wire = contact.above[c, n]
        for i in range(train.z.shape[2]):
            lateral = contact.head[c, wire, i] - train.head[c, i]
            rise += train.contact[c, wire] * lateral * train.z[0, train.owner[c], i]
    return rise


def bind_single_steps(
    kernel: KernelArrays, motion: Motion, train: Train, work: Workspace, recording: Recording
) -> Callable[[int], None]:
    """Function that advances line and pantographs, in place, by one step of a recording, and fills it.

    Args:
        kernel, motion, train, recording: As in `simulate_steps`.
        work: Scratch arrays.

    Returns:
        Function of the number of the step, from 0; it raises `DidNotConverge` if the forces did not converge.
    """
    advance, load = bind_arrays(_advance, kernel, motion, train, work), np.zeros(1)

    def advance_once(step: int) -> None:
        """Advance one time step, and record it as the step of this number."""
        if advance(load, recording.cut(slice(step, step + 1))) == 0:
            refuse_divergence(step, kernel.time_step)

    return advance_once


def refuse_divergence(steps: int, time_step: float) -> NoReturn:
    """Refuse a simulation whose forces did not converge after a number of steps [s].

    Raises:
        DidNotConverge: Always.
    """
    time = (steps + 1) * time_step
    raise DidNotConverge(
        f"the contact, dropper and damping forces of the time step at {time:.3f} s after the start did not converge"
    )


@entry_kernel
def _advance(
    kernel: KernelArrays, motion: Motion, train: Train, work: Workspace, load: Array, recording: Recording
) -> int:
    """Advance by one step per value of the load and record; return the number of completed steps."""
    connectors, dt = kernel.connectors, kernel.time_step
    for n in range(load.size):
        motion.load[0] = load[n]
        if step(kernel, motion, train, work) == 0:
            return n
        for c in range(train.owner.size):
            total, head = 0.0, 0.0
            for k in range(train.contact.shape[1]):
                total += train.contact[c, k]
            for i in range(train.z.shape[2]):
                head += train.head[c, i] * train.z[0, train.owner[c], i]
            if train.lateral.shape[1] > 0 and total > 0.0:
                head += _rise_at_wires(train, work, c) / total
            recording.contact[n, c], recording.height[n, c] = total, head
        for u in range(recording.row.size):
            b, s = recording.row[u], recording.station[u]
            a = motion.w[2, b, s]
            recording.motion[n, u, 0] = motion.w[0, b, s] + dt * dt / 4 * a
            recording.motion[n, u, 1] = motion.w[1, b, s] + dt / 2 * a
            recording.motion[n, u, 2] = a
        slack, window = 0, active_window(kernel.window, train, motion.w, motion.active)
        for k in range(connectors.run.size - 1):
            first, end = active_run(connectors.station, connectors.run, k, window)
            for c in range(first, end):
                if kernel.forces.law.unilateral[c] and motion.force[c] == 0.0:
                    slack += 1
        recording.slack[n] = slack
    return int(load.size)


def allocate_recording(
    line: DiscretisedLine,
    watched: tuple[tuple[str, float], ...],
    steps: int,
    strips: int,
    axes: tuple[str, ...] = ("z",),
) -> Recording:
    """Allocate a recording of a number of steps.

    The watched stations are those of `Passage`; each records the given axes ("z", "y"), station by station.
    """
    stations = [line.mesh.station(position) for _, position in watched]
    return Recording(
        row=np.array([line.mesh.row_of[wire, axis] for wire, _ in watched for axis in axes], dtype=np.int64),
        station=np.repeat(np.array(stations, dtype=np.int64), len(axes)),
        contact=np.zeros((steps, strips)),
        height=np.zeros((steps, strips)),
        motion=np.zeros((steps, len(watched) * len(axes), 3)),
        slack=np.zeros(steps, dtype=np.int64),
    )
