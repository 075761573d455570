"""Solution of the effective matrix for all active stations: eight pieces of a row at a time, a panel.

    panel                0                             1
    piece (lane)   0   1   2  ...  7             0   1   2  ...  7
    stations      |---|---|---|-..-|---|        |---|---|---|-..-|---|  ->

A panel holds eight pieces of the same number of stations, one in each lane of a vector (`vectors`), and the recurrences
of `block_tridiagonal` run through all eight pieces at once. The force that a piece takes over from the piece before is
not known at that time. It is found by a warm-up: the elimination of the last stations of the piece before, from zero.
What came before these stations has decayed, because products of the factors L_s decay along a row. The number of
stations of the warm-up, the fade, is measured on the factors (`measure_fade`). The back substitution is the same from
the other end.

Pieces do not depend on each other otherwise, so that two panels are eliminated together: the processor then computes
one while the other waits for a result. A panel of zeros stands in for the second one of the last pair.
"""

from typing import Any, NamedTuple

import numpy as np

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.block_tridiagonal import Factor
from pantocheck.model.dynamics.extents import Extents, clip_extent
from pantocheck.model.dynamics.kernel_compilation import entry_kernel, inline_kernel, kernel
from pantocheck.model.dynamics.vectors import (
    LANES,
    align,
    lane_sum,
    load,
    round_up,
    shift_down,
    shift_up,
    splat,
    store,
    transpose,
)

Pair = tuple[Any, Any]
"""Two vectors, which exist in compiled code only."""

FADED = 1e-13
"""A force has faded where the elimination has reduced it to this share: below the rounding of the largest forces."""
SHORTEST_PIECE = 48
"""Smallest number of stations of a piece: with less, the warm-up takes more time than it saves."""


class PanelFactor(NamedTuple):
    """Block factors of B rows in panels; Q panels per row, pieces of n stations."""

    piece: int
    fade: int
    panels: int
    """Number of stations of a piece and of a warm-up, and number of panels per row."""
    link: Array
    """Entries ww, wr, rw, rr of the factors L_s, (B Q + 1, n, 4, 8); the last panel is zero."""
    inverse: Array
    """Entries ww, wr, rr of D_s^-1, (B Q + 1, n, 3, 8)."""


class PanelWorkspace(NamedTuple):
    """Scratch arrays of a solution; N panels are active at most, those that complete a pair included."""

    force: Array
    """Forces and moments of the panels, and in the end accelerations, (N, n, 2, 8)."""
    panel: Indices
    """Number of each panel in the factor, (N,)."""
    start: Indices
    first: Indices
    last: Indices
    """First station of the panel, and its first and last active station, as indices of a flattened array, (N,)."""
    follows: Array
    """1 if the panel follows the one before it in a row, else 0, (N,)."""


def build_panels(factor: Factor, position: Array, beyond: int) -> PanelFactor:
    """Arrange block factors in panels.

    Args:
        factor: Block factors of B rows with S stations.
        position: Positions of the stations, (S,) [m].
        beyond: Number of stations that the panels cover beyond the end of the line, at least.
    """
    stations = factor.link.shape[1]
    fade = min(measure_fade(factor, position), stations)
    piece = max(SHORTEST_PIECE, round_up(fade))
    panels = -(-(stations + beyond) // (LANES * piece))
    link, inverse = (_arrange(part, panels, piece) for part in (factor.link, factor.inverse))
    return PanelFactor(piece, fade, panels, link, inverse)


def _arrange(part: Array, panels: int, piece: int) -> Array:
    """Arrange (B, S, n) entries as (B Q + 1, piece, n, 8)."""
    rows, stations, entries = part.shape
    padded = np.zeros((rows, panels * LANES * piece, entries))
    padded[:, :stations] = part
    lanes = padded.reshape(rows * panels, LANES, piece, entries).transpose(0, 2, 3, 1)
    return align(np.concatenate([lanes, np.zeros((1, piece, entries, LANES))]))


def allocate_panel_workspace(factor: PanelFactor) -> PanelWorkspace:
    """Scratch arrays for all panels."""
    number = factor.link.shape[0] + 2
    panel, start, first, last = (np.zeros(number, dtype=np.int64) for _ in range(4))
    force = align(np.zeros((number, factor.piece, 2, LANES)))
    return PanelWorkspace(force, panel, start, first, last, np.zeros(number))


@entry_kernel
def measure_fade(factor: Factor, position: Array) -> int:
    """Largest number of stations over which products of the factors L_s decay to `FADED`.

    Moments are divided by the length of the element, so that both entries are forces.
    """
    rows, stations = factor.link.shape[:2]
    longest = 1
    for row in range(rows):
        for start in range(stations - 1):
            length = position[start + 1] - position[start]
            a, b, c, d = 1.0, 0.0, 0.0, 1.0
            s, size = start, 1.0
            while s < stations - 1 and size > FADED:
                ww, wr, rw, rr = factor.link[row, s]
                a, b, c, d = ww * a + wr * c, ww * b + wr * d, rw * a + rr * c, rw * b + rr * d
                size = max(abs(a), abs(b) * length, abs(c) / length, abs(d))
                s += 1
            longest = max(longest, s - start)
    return longest


@kernel
def solve_wires(
    factor: PanelFactor, extents: Extents, window: Window, w: Array, r: Array, work: PanelWorkspace
) -> float:
    """Solve A x = f in place for the active stations of all wires; f must be zero outside, and stays so.

    Args:
        factor: Block factors of A.
        extents: Merged extents of the wires: no panel belongs to two of them.
        window: First and last active station.
        w, r: In the last plane, on entry forces and moments [N, N m], on return accelerations of deflection and slope
            [m/s2, 1/s2], (3, B, S').
        work: Scratch arrays.

    Returns:
        Sum of the accelerations at the first stations of all pieces: NaN if any force was NaN.
    """
    count = _list_panels(factor, extents, window, w.shape[1], work)
    zero = splat(0.0)
    p, q = zero, zero
    for k in range(0, count, 2):
        for n in range(k, min(k + 2, count)):
            _gather(factor.piece, w, work, n, 0)
            _gather(factor.piece, r, work, n, LANES)
        p, q = _eliminate_pair(factor, work, k, p, q)
    p, q = zero, zero
    for k in range((count - 1) // 2 * 2, -1, -2):
        p, q = _substitute_pair(factor, work, k, p, q)
        for n in range(k, min(k + 2, count)):
            _scatter(factor.piece, w, work, n, 0)
            _scatter(factor.piece, r, work, n, LANES)
    total = 0.0
    for n in range(count):
        total += lane_sum(load(work.force, n * 2 * LANES * factor.piece))
    return total


@kernel
def _list_panels(factor: PanelFactor, extents: Extents, window: Window, rows: int, work: PanelWorkspace) -> int:
    """List the active panels, wire by wire, and one of zeros after the last; return their number."""
    size, count = LANES * factor.piece, 0
    for n in range(extents.row.size):
        row, active = extents.row[n], clip_extent(extents, n, window)
        if active.first <= active.last:
            for panel in range(active.first // size, active.last // size + 1):
                plane = (2 * rows + row) * factor.panels * size
                work.panel[count] = row * factor.panels + panel
                work.start[count] = plane + panel * size
                work.first[count] = plane + max(active.first, panel * size)
                work.last[count] = plane + min(active.last, panel * size + size - 1)
                work.follows[count] = 1.0 if panel > active.first // size else 0.0
                count += 1
    work.panel[count] = rows * factor.panels
    work.follows[count] = work.follows[count + 1] = 0.0
    return count


@kernel
def _gather(piece: int, field: Array, work: PanelWorkspace, n: int, offset: int) -> None:
    """Copy the stations of a panel to the lanes: deflections, or slopes with an offset of one vector."""
    base = n * 2 * LANES * piece + offset
    for i in range(0, piece, LANES):
        s = work.start[n] + i
        lanes = transpose(
            load(field, s),
            load(field, s + piece),
            load(field, s + 2 * piece),
            load(field, s + 3 * piece),
            load(field, s + 4 * piece),
            load(field, s + 5 * piece),
            load(field, s + 6 * piece),
            load(field, s + 7 * piece),
        )
        for j in range(LANES):
            store(work.force, base + 2 * LANES * (i + j), lanes[j])


@kernel
def _scatter(piece: int, field: Array, work: PanelWorkspace, n: int, offset: int) -> None:
    """Copy the lanes of a panel to its stations, and zero to those outside of the active part."""
    base = n * 2 * LANES * piece + offset
    for i in range(0, piece, LANES):
        at, s = base + 2 * LANES * i, work.start[n] + i
        stations = transpose(
            load(work.force, at),
            load(work.force, at + 2 * LANES),
            load(work.force, at + 4 * LANES),
            load(work.force, at + 6 * LANES),
            load(work.force, at + 8 * LANES),
            load(work.force, at + 10 * LANES),
            load(work.force, at + 12 * LANES),
            load(work.force, at + 14 * LANES),
        )
        for j in range(LANES):
            store(field, s + j * piece, stations[j])
    for s in range(work.start[n], work.first[n], LANES):
        store(field, s, splat(0.0))
    for s in range(work.last[n] + 1, work.start[n] + LANES * piece, LANES):
        store(field, s, splat(0.0))


@kernel
def _eliminate_pair(factor: PanelFactor, work: PanelWorkspace, k: int, p: Any, q: Any) -> Pair:
    """Eliminate panels k and k + 1; p and q: force and moment that the panel before transfers.

    Returns the force and the moment that panel k + 1 transfers.
    """
    piece = factor.piece
    fa, fb, la, lb = _offsets(piece, work, k, 4)
    pa, qa, pb, qb = splat(0.0), splat(0.0), splat(0.0), splat(0.0)
    for s in range(piece - factor.fade, piece):
        pa, qa = _transfer(factor, la, s, *_reduced(work, fa, s, pa, qa))
        pb, qb = _transfer(factor, lb, s, *_reduced(work, fb, s, pb, qb))
    last_p, last_q = pb, qb
    before, middle = splat(work.follows[k]), splat(work.follows[k + 1])
    pb, qb = shift_up(pb, middle * pa), shift_up(qb, middle * qa)
    pa, qa = shift_up(pa, before * p), shift_up(qa, before * q)
    for s in range(piece):
        w, r = _reduced(work, fa, s, pa, qa)
        _put(work, fa, s, w, r)
        pa, qa = _transfer(factor, la, s, w, r)
        w, r = _reduced(work, fb, s, pb, qb)
        _put(work, fb, s, w, r)
        pb, qb = _transfer(factor, lb, s, w, r)
    return last_p, last_q


@kernel
def _substitute_pair(factor: PanelFactor, work: PanelWorkspace, k: int, x: Any, y: Any) -> Pair:
    """Substitute back panels k + 1 and k; x and y: deflection and slope at the first stations of the panel after them.

    Returns the deflection and the slope at the first stations of panel k.
    """
    piece = factor.piece
    fa, fb, la, lb = _offsets(piece, work, k, 4)
    _, _, ia, ib = _offsets(piece, work, k, 3)
    xa, ya, xb, yb = splat(0.0), splat(0.0), splat(0.0), splat(0.0)
    for s in range(factor.fade - 1, -1, -1):
        xb, yb = _substitute(factor, work, (fb, lb, ib), s, xb, yb)
        xa, ya = _substitute(factor, work, (fa, la, ia), s, xa, ya)
    first_x, first_y = xa, ya
    middle, after = splat(work.follows[k + 1]), splat(work.follows[k + 2])
    xa, ya = shift_down(xa, middle * xb), shift_down(ya, middle * yb)
    xb, yb = shift_down(xb, after * x), shift_down(yb, after * y)
    for s in range(piece - 1, -1, -1):
        xb, yb = _substitute(factor, work, (fb, lb, ib), s, xb, yb)
        _put(work, fb, s, xb, yb)
        xa, ya = _substitute(factor, work, (fa, la, ia), s, xa, ya)
        _put(work, fa, s, xa, ya)
    return first_x, first_y


@inline_kernel
def _offsets(piece: int, work: PanelWorkspace, k: int, entries: int) -> tuple[int, int, int, int]:
    """Indices of panels k and k + 1 in the forces, and in an array of the factor with some entries per station."""
    force, part = 2 * LANES * piece, entries * LANES * piece
    return k * force, (k + 1) * force, work.panel[k] * part, work.panel[k + 1] * part


@inline_kernel
def _reduced(work: PanelWorkspace, f: int, s: int, p: Any, q: Any) -> Pair:
    """Force and moment at station s of each piece, less those that the station before transfers."""
    at = f + 2 * LANES * s
    return load(work.force, at) - p, load(work.force, at + LANES) - q


@inline_kernel
def _put(work: PanelWorkspace, f: int, s: int, w: Any, r: Any) -> None:
    """Store two values at station s of each piece."""
    at = f + 2 * LANES * s
    store(work.force, at, w)
    store(work.force, at + LANES, r)


@inline_kernel
def _transfer(factor: PanelFactor, link: int, s: int, w: Any, r: Any) -> Pair:
    """Force and moment L g that station s of each piece transfers to the next one."""
    at, L = link + 4 * LANES * s, factor.link
    return (
        load(L, at) * w + load(L, at + LANES) * r,
        load(L, at + 2 * LANES) * w + load(L, at + 3 * LANES) * r,
    )


@inline_kernel
def _substitute(
    factor: PanelFactor, work: PanelWorkspace, offsets: tuple[int, int, int], s: int, x: Any, y: Any
) -> Pair:
    """Deflection and slope at station s of each piece from those at the next one."""
    force, link, inverse = offsets
    f, at, i = force + 2 * LANES * s, link + 4 * LANES * s, inverse + 3 * LANES * s
    w, r = load(work.force, f), load(work.force, f + LANES)
    L, D = factor.link, factor.inverse
    wr = load(D, i + LANES)
    return (
        load(D, i) * w + wr * r - load(L, at) * x - load(L, at + 2 * LANES) * y,
        wr * w + load(D, i + 2 * LANES) * r - load(L, at + LANES) * x - load(L, at + 3 * LANES) * y,
    )
