"""Active window of a time step: the stations that it moves, found by a binary search."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, max_wave_speed
from pantocheck.model.dynamics.kernel_compilation import kernel
from pantocheck.model.dynamics.passage import Passage
from pantocheck.model.dynamics.train import Train
from pantocheck.model.dynamics.vectors import LANES


@kernel
def search(values: Array | Indices, first: int, end: int, value: float) -> int:
    """First index from `first` on, before `end`, of increasing values that is not below a value; else `end`."""
    while first < end:
        middle = (first + end) // 2
        if values[middle] < value:
            first = middle + 1
        else:
            end = middle
    return first


# Active window: stations that no wave can have reached yet, or that are not needed any more, are held at rest.
#
# time ^                           With wave speed c and speed v of the pantograph, a disturbance from the pantograph
#  end +......./--x--\             travels along the characteristics x = x0 +- c t: the domain of influence. Outside of
#      |     /   /     \           it, the line is still at rest. The result at the end depends on a second cone: from
#      |   /    /    /             the stations outside of it no wave returns in time. The window is the intersection of
#      |    \  /   /               both, a rhombus around the path of the pantograph.
#      |     \/ /
#      +------x0-------> x
#
# A station that has left the window is cut off from the line. Its motion, and that of every station which a wave from
# the cut can have reached, is unknown: a recording holds NaN there.
MIN_HALF_WIDTH = 30.0
"""Half-width that is active around a pantograph from the first step, and distance from a cut at which motion counts as
known [m]: covers the influence of one step and fast short waves. At 10 m they are below 1e-9 m."""

LEAST_DAMPING = 4e-5
"""Stiffness coefficient of a wire from which short waves decay before they overtake the window [s].

The shortest waves of a mesh are faster than `max_wave_speed`. Within 7 s (elements of 0.5 m, steps of 1 ms) a window
changes the contact force by 3e-8 N with 5e-5 s, by 3e-5 N with 3e-5 s, and by 20 N without damping.
"""


# Held stretches move as a whole: a change of tension runs ahead of the waves, from stretch to stretch, over 2 to 12
# stretches for usual and unusual wires, so that no speed bounds it. The window of such a line grows with the motion
# itself: stations are held at rest as long as the outermost part of the window, the guard, is quiet. A guard is longer
# than the longest stretch, so that only its own motion can move what lies beyond. The window does not shrink, because
# what returns from a station has no bound either.
QUIET = 1e-11
"""Velocity of the wires below which a guard is at rest [m/s]: within 100 s a station beyond it would move by 1e-9 m,
which changes a contact force by 5e-5 N at 50 kN/m."""


class WindowArrays(NamedTuple):
    """Limits of the active window."""

    position: Array
    """Positions of the stations, (S,) [m]."""
    wave_speed: float
    """Upper bound of the wave speed, which moves the edges of the window [m/s]."""
    duration: float
    """Simulated time [s]."""
    kept_behind: float
    kept_ahead: float
    """Distances behind the last and ahead of the first pantograph within which the motion is known until the end
    [m].
    """
    reach: float
    """Largest half-width around the pantographs [m]."""
    whole_line: bool
    """Whether no reasoning limits the window: the whole line is active, or a window that grows with the motion."""
    guard: float
    """Length of the guard of a window that grows with the motion, else zero [m]."""


class Window(NamedTuple):
    """First and last active station; whole vectors of stations are active, also beyond the end of the line."""

    first: int
    last: int


def build_window_arrays(line: DiscretisedLine, passage: Passage) -> WindowArrays:
    """Limits of the active window of a passage.

    With an infinite reach the whole line is active if `kept_behind` is infinite, too, if the train is faster than the
    waves, or if short waves do not decay (`LEAST_DAMPING`). It is active with modal damping, too: a mode moves all of
    it at once. With held stretches the window grows with the motion.
    """
    c = max_wave_speed(line)
    damping = min(line.catenary.rayleigh(wire.kind).stiffness_coefficient for wire in line.catenary.wires)
    kept = passage.kept_behind if passage.speed < c and damping >= LEAST_DAMPING else math.inf
    ahead = math.inf if math.isinf(kept) else 0.0
    guard, position = 0.0, line.mesh.position
    if line.stretches.first.size and not math.isinf(min(passage.kept_behind, passage.reach)):
        end = np.minimum(line.stretches.first + line.stretches.coefficient.shape[2], position.size) - 1
        guard = MIN_HALF_WIDTH + float((position[end] - position[line.stretches.first]).max())
    if line.catenary.modal_damping:
        guard, kept, ahead = 0.0, math.inf, math.inf
    whole = bool(line.stretches.first.size or line.catenary.modal_damping) or math.isinf(min(kept, passage.reach))
    return WindowArrays(position, c, passage.duration, kept, ahead, passage.reach, whole, guard)


def build_whole_window(line: DiscretisedLine) -> WindowArrays:
    """Active window that is the whole line at all times."""
    return WindowArrays(line.mesh.position, max_wave_speed(line), math.inf, math.inf, math.inf, math.inf, True, 0.0)


@kernel
def wave_reach(limits: WindowArrays, speed: float, elapsed: Any) -> tuple[Any, Any]:
    """Largest distances behind the last and ahead of the first pantograph that waves can have reached [m].

    The time since the start [s] may be an array.
    """
    front = MIN_HALF_WIDTH + limits.wave_speed * elapsed
    return front + speed * elapsed, np.maximum(front - speed * elapsed, MIN_HALF_WIDTH)


@kernel
def half_widths(limits: WindowArrays, speed: float, elapsed: Any) -> tuple[Any, Any]:
    """Half-widths of the window behind the last and ahead of the first pantograph at a time after the start [m].

    A wave needs the time d / (c - v) to catch up a distance d behind a pantograph, and d / (c + v) from ahead.
    """
    behind, ahead = wave_reach(limits, speed, elapsed)
    left = np.maximum(limits.duration - elapsed, 0.0)
    behind = np.minimum(behind, MIN_HALF_WIDTH + limits.kept_behind + max(limits.wave_speed - speed, 0.0) * left)
    ahead = np.minimum(ahead, MIN_HALF_WIDTH + limits.kept_ahead + (limits.wave_speed + speed) * left)
    return np.minimum(behind, limits.reach), np.minimum(ahead, limits.reach)


@kernel
def active_window(limits: WindowArrays, train: Train, w: Array, active: Indices) -> Window:
    """Stations inside the window, rounded outwards to whole vectors; the whole line without a pantograph.

    Args:
        limits: Limits of the window.
        train: State of the pantographs.
        w: Deflections of the line, (3, B, S').
        active: First and last active station of the last step, the last before the first in front of the first step.
    """
    end = limits.position.size - 1
    first, last = 0, end
    if train.position.size > 0 and (limits.guard > 0.0 or not limits.whole_line):
        rear, front = train.position[0], train.position[0]
        for p in range(1, train.position.size):
            rear, front = min(rear, train.position[p]), max(front, train.position[p])
        if limits.guard == 0.0:
            behind, ahead = half_widths(limits, train.speed[0], train.elapsed[0])
            first = search(limits.position, first, last, rear - behind)
            last = search(limits.position, first, last, front + ahead)
        else:
            rear, front = rear - 2 * limits.guard, front + 2 * limits.guard
            if active[0] <= active[1]:
                first, last = active[0], min(active[1], end)
                rear, front = limits.position[first], limits.position[last]
                if _moves(w, first, search(limits.position, first, end, rear + limits.guard)):
                    rear -= limits.guard
                if _moves(w, search(limits.position, 0, end, front - limits.guard), last):
                    front += limits.guard
            first, last = search(limits.position, 0, end, rear), search(limits.position, 0, end, front)
    return Window(first // LANES * LANES, last // LANES * LANES + LANES - 1)


@kernel
def _moves(w: Array, first: int, last: int) -> bool:
    """Whether some wire moves between two stations."""
    for b in range(w.shape[1]):
        for s in range(first, last + 1):
            if not abs(w[1, b, s]) <= QUIET:
                return True
    return False


def find_unknown(
    limits: WindowArrays, passage: Passage, stations: Array, time: Array, chosen: Indices | slice = slice(None)
) -> NDArray[np.bool_]:
    """Find the times at which the motion of each station is unknown: a wave from a cut can have reached it.

    Args:
        limits: Limits of the active window.
        passage: Train and its speed.
        stations: Positions of the stations, (U,) [m].
        time: Times at the ends of steps, rising, (T,) [s].
        chosen: Steps of the result, (C,); default: all.

    Returns:
        True where the motion is unknown, (U, C).
    """
    unknown = np.zeros((stations.size, time[chosen].size), dtype=np.bool_)
    if limits.whole_line:
        return unknown
    position = stations[:, None]
    widths = np.array([half_widths(limits, passage.speed, time), wave_reach(limits, passage.speed, time)])
    for side, start, end_of_line, direction in (
        (0, min(passage.start), limits.position[0], -1),
        (1, max(passage.start), limits.position[-1], 1),
    ):
        edge = start + passage.speed * time + direction * widths[0, side]
        cut = np.flatnonzero((widths[0, side] < widths[1, side]) & (direction * edge < direction * end_of_line))
        if cut.size:
            # No edge moves faster than the waves, so that no wave of a later cut overtakes that of the first.
            first = cut[0]
            later = time[chosen] >= time[first]
            wave = edge[first] - direction * (MIN_HALF_WIDTH + limits.wave_speed * (time[chosen][later] - time[first]))
            unknown[:, later] |= direction * (position - wave) >= 0
    return unknown
