"""Extents of the wires: found as the wires were described, and nothing moves outside of them."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from helpers.lines import DAMPED, PANTOGRAPH_2002, overlapping_line, simple_line
from pantocheck.model import Catenary, Clamp, Kind, Passage, Wire, discretise
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.extents import active_run, clip_extent, find_extents, find_runs, merge_extents
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.motion import end_of_step
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.dynamics.vectors import LANES


def stitched_line() -> Catenary:
    """Two spans with a stitch wire at the mast, which carries the two nearest droppers."""
    line = simple_line(damping=DAMPED)
    stitch = Wire("stitch", Kind.STITCH_WIRE, 52.0, 68.0, 3e3, 0.3, 0.0)
    clamps = tuple(Clamp(x, "messenger", "stitch") for x in (52.0, 68.0))
    droppers = tuple(replace(d, upper="stitch") if 52.0 < d.position < 68.0 else d for d in line.droppers)
    return replace(line, wires=(*line.wires, stitch), droppers=droppers, clamps=clamps)


def plain_extents(catenary: Catenary, element: float) -> list[tuple[int, int, int]]:
    """Row, first and last station of every wire and field, one after the other."""
    mesh = discretise(catenary, element).mesh
    return sorted(
        (row, int(np.abs(mesh.position - wire.start).argmin()), int(np.abs(mesh.position - wire.end).argmin()))
        for (name, _), row in mesh.row_of.items()
        for wire in [catenary.wire(name)]
    )


@pytest.mark.parametrize(
    "catenary", [simple_line(), stitched_line(), overlapping_line(3, 3), overlapping_line(2, 4, 2)]
)
def test_extents_are_those_of_the_wires(catenary: Catenary) -> None:
    """Every wire has one extent in its row."""
    extents = find_extents(discretise(catenary, 2.0).beams)
    assert list(zip(*(part.tolist() for part in extents), strict=True)) == plain_extents(catenary, 2.0)


def test_clipped_extent_is_the_part_inside_the_window() -> None:
    """Set of stations in both, by counting; a wire outside has none."""
    extents = find_extents(discretise(overlapping_line(3, 3), 5.0).beams)
    for window in (Window(0, 3), Window(20, 30), Window(0, 200)):
        for n in range(extents.row.size):
            both = set(range(extents.first[n], extents.last[n] + 1)) & set(range(window.first, window.last + 1))
            first, last = clip_extent(extents, n, window)
            assert set(range(first, last + 1)) == both


@pytest.mark.parametrize("gap", [8, 40, 200])
def test_merged_extents_have_no_group_of_stations_in_common(gap: int) -> None:
    """They cover the same stations and at most a vector more at each end; no group of `gap` stations is in two."""
    extents = find_extents(discretise(overlapping_line(4, 3), 2.0).beams)
    merged = merge_extents(extents, gap)
    groups = [
        (row, group)
        for row, first, last in zip(*(part.tolist() for part in merged), strict=True)
        for group in range(first // gap, last // gap + 1)
    ]
    assert len(groups) == len(set(groups))
    assert ((merged.first % LANES == 0) & (merged.last % LANES == LANES - 1)).all()
    for row, first, last in zip(*extents, strict=True):
        assert ((merged.row == row) & (merged.first <= first) & (last <= merged.last)).sum() == 1
    for row, first, last in zip(*merged, strict=True):
        inside = (extents.row == row) & (first <= extents.first) & (extents.last <= last)
        assert extents.first[inside].min() - first < LANES
        assert last - extents.last[inside].max() < LANES


def test_stations_without_a_wire_never_move() -> None:
    """A head runs over an overlap of three sections; forces, speeds and deflections between the wires of a row stay 0.

    The row of the second section has no wire before and behind it, that of the others none in between.
    """
    line = discretise(overlapping_line(3, 3, section=simple_line(3, damping=DAMPED)), 2.0)
    kernel, passage = build_kernel_arrays(line, 1e-3), Passage((PANTOGRAPH_2002,), (105.0,), 60.0, 1.5, 1e-3)
    motion, train = start_motion(line, kernel, passage)
    work = build_workspace(kernel, train)
    advance = bind_arrays(step, kernel, motion, train, work)
    for _ in range(1500):
        assert advance()
    covered = np.zeros(line.beams.free.shape[:2], dtype=np.bool_)
    for row, first, last in plain_extents(line.catenary, 2.0):
        covered[row, first : last + 1] = True
    assert 0.2 < covered.mean() < 0.9
    for field in end_of_step(motion, kernel.layout, 1e-3):
        assert not field[:, ~covered].any()
        assert np.abs(field[0]).max(axis=1).min() > 1e-6  # every row has moved


@pytest.mark.parametrize("stations", [[], [4], [1, 3, 3, 9, 2, 5, 5, 0], [7, 6, 6, 8]])
def test_runs_hold_the_parts_inside_a_window(stations: list[int]) -> None:
    """In every run, the parts found by search are those found one by one; runs join to all parts."""
    station = np.array(stations, dtype=np.int64)
    runs = find_runs(station)
    assert runs[-1] == station.size
    for window in (Window(0, 9), Window(3, 5), Window(5, 5), Window(8, 8), Window(10, 12)):
        found = []
        for k, (start, end) in enumerate(pairwise(runs.tolist())):
            assert (np.diff(station[start:end]) >= 0).all()
            found += range(*active_run(station, runs, k, window))
        assert found == [n for n, s in enumerate(stations) if window.first <= s <= window.last]


def test_connectors_of_a_line_are_few_runs() -> None:
    """Three sections: the droppers of each are one run; with them the rows of springs at arms and supports."""
    kernel = build_kernel_arrays(discretise(overlapping_line(3, 3), 2.0), 1e-3)
    assert kernel.connectors.run.tolist() == [0, 27, 54, 81]
    assert kernel.wires.lumped_run.size - 1 == 4
