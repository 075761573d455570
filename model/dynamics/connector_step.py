"""The connectors' part of a time step: every tension solved exactly in turn.

A change of tension changes the accelerations around its ends by the local columns of the inverse.
"""

import math

from numba import njit

from pantocheck.model.arrays import Array
from pantocheck.model.dynamics.state import KernelArrays, Motion, Workspace

NEGLIGIBLE_FORCE = 1e-11
"""Changes of a force below this, a hundredth of what a step is solved to, are not passed on [N]."""


@njit(cache=True)
def predict_connectors(line: KernelArrays, motion: Motion, work: Workspace, first: int, last: int) -> None:
    """Predicted tensions; the connectors pull with their tensions of the last step to begin with."""
    for n in range(line.station.size):
        s = line.station[n]
        if s < first or s > last:
            continue
        change = motion.tension[n] - line.preload[n]
        d, rate = 0.0, 0.0
        for e in range(line.end_row.shape[1]):
            row, c = line.end_row[n, e], line.end_coefficient[n, e]
            d += c * motion.w[0, row, s]
            rate += c * motion.w[1, row, s]
            motion.w[2, row, s] -= c * change
        work.tension[n] = line.preload[n] + line.stiffness[n] * d + line.damping[n] * rate


@njit(cache=True)
def add_column(w: Array, r: Array, column: Array, station: int, value: float, limits: tuple[int, int]) -> None:
    """Add `value` times a local column of the inverse to the accelerations of one row, between two stations."""
    half = column.shape[1] // 2
    first, last = max(limits[0], station - half), min(limits[1] + 1, station + half)
    shift = half - station
    of_w, of_r = column[0, first + shift : last + shift], column[1, first + shift : last + shift]
    w, r = w[first:last], r[first:last]
    for i in range(w.size):
        w[i] += value * of_w[i]
        r[i] += value * of_r[i]


@njit(cache=True)
def larger(a: float, b: float) -> float:
    """The larger of two numbers, or NaN where either is: `max` would drop it, and a lost run would look settled."""
    return a if a >= b or math.isnan(a) else b


@njit(cache=True)
def sweep_connectors(
    line: KernelArrays, motion: Motion, work: Workspace, w: Array, r: Array, first: int, last: int
) -> float:
    """Solve every connector between two stations once, the others held; returns the largest change of a tension [N]."""
    largest = 0.0
    for n in range(line.station.size):
        s = line.station[n]
        if s < first or s > last:
            continue
        acceleration = 0.0
        for e in range(line.end_row.shape[1]):
            acceleration += line.end_coefficient[n, e] * w[line.end_row[n, e], s]
        linear = work.tension[n] + line.gain[n] * acceleration
        tension = (linear + line.yielding[n] * motion.tension[n]) / (1 + line.yielding[n])
        if line.unilateral[n] and tension < 0.0:
            tension = 0.0
        change = tension - motion.tension[n]
        if abs(change) > NEGLIGIBLE_FORCE:
            motion.tension[n] = tension
            for e in range(line.end_row.shape[1]):
                row, f = line.end_row[n, e], line.end_coefficient[n, e]
                if f != 0.0:
                    add_column(w[row], r[row], line.columns[line.end_column[n, e]], s, -f * change, (first, last))
        largest = larger(largest, abs(change))
    return largest
