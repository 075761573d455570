"""Extents of the wires: only stations between the ends of a wire take part in a time step.

    row 0   o-------------------o             o-------------------o      first and third section of a line
    row 1                 o-------------------o                          second section
    window       |-------------------------------|                       active part of both rows

A row holds wires that do not overlap. A wire outside of the active window takes no time, and no wire changes its row
beyond its own ends. Parts of the line are searched for in runs of increasing stations, for the same reason.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from pantocheck.model.arrays import Indices
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.fem.beams import Beams


class Extents(NamedTuple):
    """Extents of N wires, row by row.

    Parameters
    ----------
    row, first, last : (N,) int ndarray
        Row, first and last station of each wire.
    """

    row: Indices
    first: Indices
    last: Indices


def find_extents(beams: Beams) -> Extents:
    """Find the extents of all wires: in each row the longest runs of elements with a wire."""
    present = np.pad(beams.mass_per_length > 0, ((0, 0), (1, 1))).astype(np.int64)
    change = np.diff(present, axis=1)
    row, first = np.nonzero(change == 1)
    return Extents(*map(np.ascontiguousarray, (row, first, np.nonzero(change == -1)[1])))


@njit(cache=True)
def clip_extent(extents: Extents, n: int, window: Window) -> Window:
    """First and last station of a wire inside the window; the last is before the first if the wire lies outside."""
    return Window(max(extents.first[n], window.first), min(extents.last[n], window.last))


def find_runs(station: Indices) -> Indices:
    """Find the runs in which the stations of N parts do not decrease: the first part of each run, and N."""
    starts = np.flatnonzero(np.diff(station, prepend=np.iinfo(np.int64).max) < 0)
    return np.append(starts, station.size)


@njit(cache=True)
def active_run(station: Indices, window: Window) -> tuple[int, int]:
    """First of the parts of a run at their stations inside the window, and one after the last."""
    if station[-1] < window.first or station[0] > window.last:
        return 0, 0
    return int(np.searchsorted(station, window.first)), int(np.searchsorted(station, window.last, "right"))
