"""Extents of the wires: only stations between the ends of a wire take part in a time step.

    row 0   o-------------------o             o-------------------o      first and third section of a line
    row 1                 o-------------------o                          second section
    window       |-------------------------------|                       active part of both rows

A row holds wires that do not overlap. A wire outside of the active window takes no time, and no wire changes its row
beyond its own ends. Parts of the line are searched for in runs of increasing stations, for the same reason.
"""

from typing import NamedTuple

import numpy as np

from pantocheck.model.description.arrays import Indices
from pantocheck.model.dynamics.active_window import Window, search
from pantocheck.model.dynamics.kernel_compilation import kernel
from pantocheck.model.dynamics.vectors import LANES
from pantocheck.model.fem.beams import Beams


class Extents(NamedTuple):
    """Extents of N wires, row by row."""

    row: Indices
    first: Indices
    last: Indices
    """Row, first and last station of each wire, (N,)."""


def find_extents(beams: Beams) -> Extents:
    """Find the extents of all wires: in each row the longest runs of elements with a wire."""
    present = np.pad(beams.mass_per_length > 0, ((0, 0), (1, 1))).astype(np.int64)
    change = np.diff(present, axis=1)
    row, first = np.nonzero(change == 1)
    return Extents(*map(np.ascontiguousarray, (row, first, np.nonzero(change == -1)[1])))


def merge_extents(extents: Extents, gap: int) -> Extents:
    """Round extents outwards to whole vectors of stations, and merge those of a row with less than a gap between them.

    The merged extents of a row have no vector in common, nor any other group of `gap` stations.
    """
    merged: list[list[int]] = []
    for row, first, last in zip(*(part.tolist() for part in extents), strict=True):
        if merged and merged[-1][0] == row and first - merged[-1][2] < gap:
            merged[-1][2] = last
        else:
            merged.append([row, first, last])
    row, first, last = np.array(merged, dtype=np.int64).reshape(-1, 3).T
    return Extents(row.copy(), first // LANES * LANES, last // LANES * LANES + LANES - 1)


@kernel
def clip_extent(extents: Extents, n: int, window: Window) -> Window:
    """First and last station of a wire inside the window; the last is before the first if the wire lies outside."""
    return Window(max(extents.first[n], window.first), min(extents.last[n], window.last))


def find_runs(station: Indices) -> Indices:
    """Find the runs in which the stations of N parts do not decrease: the first part of each run, and N."""
    starts = np.flatnonzero(np.diff(station, prepend=np.iinfo(np.int64).max) < 0)
    return np.append(starts, station.size)


@kernel
def active_run(station: Indices, run: Indices, k: int, window: Window) -> tuple[int, int]:
    """First part of run k at a station inside the window, and one after the last."""
    start, end = run[k], run[k + 1]
    if station[end - 1] < window.first or station[start] > window.last:
        return start, start
    first = search(station, start, end, window.first)
    return first, search(station, first, end, window.last + 1)
