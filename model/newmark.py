"""The time step: Newmark average acceleration with unilateral droppers and contact.

The rows of beams are factored once. Connectors and contacts are scalar forces whose effect within the step is known in
closed form (the local columns of the inverse), so each is solved exactly in turn, and the turns are repeated until no
force changes any more. Forces far apart do not feel each other within a step, so two or three turns do.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from pantocheck.model.effective import Factor, solve_row

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

FORCE_TOLERANCE = 1e-9
"""A step has converged when no force changed by more than this in a turn [N]; forces are of the order of 100 N."""
MOST_TURNS = 200
"""After so many turns a step is given up."""


class Line(NamedTuple):
    """What stays the same during a run; B rows, S stations, N connectors with E ends, W contact wires.

    Parameters
    ----------
    time_step : [s]
    position : (S,) [m]
    elements : (B, 10, S-1) stiffness entries 11, 12, 22, 24 and mass entries 11, 13, 12, -14, 22, -24 of each element
    mass_coefficient, stiffness_coefficient : (B,) damping of the wires [1/s, s]
    lumped_stiffness, lumped_damping : (B, S) [N/m, N s/m]
    factor : of the effective matrix
    columns : (L, 2, 2H+1) its inverse around the ends of the connectors
    station : (N,) of the connectors
    end_row, end_column : (N, E) row of each end, and its column in `columns`
    end_coefficient : (N, E) in the elongation; zero for an end that is not there
    stiffness, damping, preload : (N,) [N/m, N s/m, N]
    unilateral : (N,) whether the tension cannot be negative
    contact_row : (W,) rows that a pantograph touches
    contact_columns : (W, S, 2, 2, 2H+1) the inverse around every station, for a force and for a moment
    rest : (W, S, 2) height and slope of the contact wires at rest [m, -]
    """

    time_step: float
    position: Array
    elements: Array
    mass_coefficient: Array
    stiffness_coefficient: Array
    lumped_stiffness: Array
    lumped_damping: Array
    factor: Factor
    columns: Array
    station: Indices
    end_row: Indices
    end_column: Indices
    end_coefficient: Array
    stiffness: Array
    damping: Array
    preload: Array
    unilateral: NDArray[np.bool_]
    contact_row: Indices
    contact_columns: Array
    rest: Array


class Motion(NamedTuple):
    """State of the line about its initial state.

    Parameters
    ----------
    w, r : (3, B, S) deflection and slope: displacement, velocity, acceleration [m, -; per s; per s2]
    tension : (N,) of the connectors, in total [N]
    """

    w: Array
    r: Array
    tension: Array


class Train(NamedTuple):
    """Pantographs and their state; P pantographs of at most n unknowns, each touching W contact wires.

    Parameters
    ----------
    position : (P,) [m]
    speed : (1,) [m/s]
    inverse : (P, n, n) inverse of each pantograph's effective matrix [1/kg]
    damping, stiffness : (P, n, n) [N s/m, N/m]
    head : (P, n) picks the head's displacement [-]
    force : (P, n) constant forces [N]
    contact_stiffness : (P,) [N/m]
    z : (3, P, n) displacement, velocity, acceleration [m, m/s, m/s2]
    contact : (P, W) contact forces [N]
    """

    position: Array
    speed: Array
    inverse: Array
    damping: Array
    stiffness: Array
    head: Array
    force: Array
    contact_stiffness: Array
    z: Array
    contact: Array


class Workspace(NamedTuple):
    """Arrays that every step fills anew, so that none is allocated inside it.

    Parameters
    ----------
    w, r : (2, B, S) predicted displacement and velocity
    seen_w, seen_r : (B, S) predicted displacement plus stiffness coefficient times predicted velocity
    elongation : (2, N) predicted, and its rate [m, m/s]
    shape : (P, W, 4) Hermite functions at the contacts
    element : (P,) element over each pantograph
    closing : (P, W) predicted overlap of head and wire [m]
    compliance : (P, W) relative acceleration that a newton of contact force causes [1/kg]
    z : (2, P, n) predicted displacement and velocity of the pantographs
    """

    w: Array
    r: Array
    seen_w: Array
    seen_r: Array
    elongation: Array
    shape: Array
    element: Indices
    closing: Array
    compliance: Array
    z: Array


@njit(cache=True)
def predict_wires(line: Line, motion: Motion, work: Workspace) -> None:
    """Newmark predictors of the rows, and the displacement that their stiffness sees."""
    dt = line.time_step
    rows, stations = motion.w.shape[1:]
    for b in range(rows):
        c = line.stiffness_coefficient[b]
        for s in range(stations):
            work.w[0, b, s] = motion.w[0, b, s] + dt * motion.w[1, b, s] + dt * dt / 4 * motion.w[2, b, s]
            work.w[1, b, s] = motion.w[1, b, s] + dt / 2 * motion.w[2, b, s]
            work.seen_w[b, s] = work.w[0, b, s] + c * work.w[1, b, s]
        for s in range(stations):
            work.r[0, b, s] = motion.r[0, b, s] + dt * motion.r[1, b, s] + dt * dt / 4 * motion.r[2, b, s]
            work.r[1, b, s] = motion.r[1, b, s] + dt / 2 * motion.r[2, b, s]
            work.seen_r[b, s] = work.r[0, b, s] + c * work.r[1, b, s]


@njit(cache=True)
def wire_forces(line: Line, work: Workspace, w: Array, r: Array) -> None:
    """Forces and moments that wires and lumped parts exert on the stations in the predicted state, into w and r."""
    rows, stations = w.shape
    for b in range(rows):
        p, t, k, c = work.seen_w[b], work.seen_r[b], line.elements[b], line.mass_coefficient[b]
        v, u = work.w[1, b], work.r[1, b]
        force, moment = 0.0, 0.0
        for e in range(stations - 1):
            drop = p[e] - p[e + 1]
            shear = k[0, e] * drop + k[1, e] * (t[e] + t[e + 1])
            w0, r0, w1, r1 = c * v[e], c * u[e], c * v[e + 1], c * u[e + 1]
            w[b, e] = force - shear - k[4, e] * w0 - k[6, e] * r0 - k[5, e] * w1 + k[7, e] * r1
            r[b, e] = moment - k[1, e] * drop - k[2, e] * t[e] - k[3, e] * t[e + 1]
            r[b, e] -= k[6, e] * w0 + k[8, e] * r0 + k[7, e] * w1 - k[9, e] * r1
            force = shear - k[5, e] * w0 - k[7, e] * r0 - k[4, e] * w1 + k[6, e] * r1
            moment = k[7, e] * w0 + k[9, e] * r0 + k[6, e] * w1 - k[8, e] * r1
            moment -= k[1, e] * drop + k[3, e] * t[e] + k[2, e] * t[e + 1]
        w[b, stations - 1], r[b, stations - 1] = force, moment
        for s in range(stations):
            w[b, s] -= line.lumped_stiffness[b, s] * work.w[0, b, s] + line.lumped_damping[b, s] * work.w[1, b, s]


@njit(cache=True)
def predict_connectors(line: Line, motion: Motion, work: Workspace, w: Array) -> None:
    """Predicted elongations; the connectors pull with their tensions of the last step to begin with."""
    for n in range(line.station.size):
        s = line.station[n]
        change = motion.tension[n] - line.preload[n]
        d, rate = 0.0, 0.0
        for e in range(line.end_row.shape[1]):
            row, c = line.end_row[n, e], line.end_coefficient[n, e]
            d += c * work.w[0, row, s]
            rate += c * work.w[1, row, s]
            w[row, s] -= c * change
        work.elongation[0, n], work.elongation[1, n] = d, rate


@njit(cache=True)
def predict_train(line: Line, train: Train, work: Workspace, w: Array, r: Array) -> None:
    """Move the pantographs on, predict them, and press with the contact forces of the last step to begin with."""
    dt = line.time_step
    half = line.columns.shape[2] // 2
    for p in range(train.position.size):
        train.position[p] += dt * train.speed[0]
        x = train.position[p]
        e = min(max(np.searchsorted(line.position, x) - 1, 0), line.position.size - 2)
        h = line.position[e + 1] - line.position[e]
        s = (x - line.position[e]) / h
        work.element[p] = e
        for i in range(train.z.shape[2]):
            work.z[0, p, i] = train.z[0, p, i] + dt * train.z[1, p, i] + dt * dt / 4 * train.z[2, p, i]
            work.z[1, p, i] = train.z[1, p, i] + dt / 2 * train.z[2, p, i]
        pressing = 0.0
        for k in range(train.contact.shape[1]):
            pressing += train.contact[p, k]
        head, head_compliance = 0.0, 0.0
        for i in range(train.z.shape[2]):
            a = 0.0
            for j in range(train.z.shape[2]):
                f = train.force[p, j] - train.head[p, j] * pressing
                for m in range(train.z.shape[2]):
                    f -= train.damping[p, j, m] * work.z[1, p, m] + train.stiffness[p, j, m] * work.z[0, p, m]
                a += train.inverse[p, i, j] * f
                head_compliance += train.head[p, i] * train.inverse[p, i, j] * train.head[p, j]
            train.z[2, p, i] = a
            head += train.head[p, i] * work.z[0, p, i]
        for k in range(train.contact.shape[1]):
            row = line.contact_row[k]
            n = work.shape[p, k]
            n[0], n[1] = (1 + 2 * s) * (1 - s) ** 2, h * s * (1 - s) ** 2
            n[2], n[3] = s * s * (3 - 2 * s), h * s * s * (s - 1)
            wire, compliance = 0.0, head_compliance
            for i in range(2):
                wire += n[2 * i] * (line.rest[k, e + i, 0] + work.w[0, row, e + i])
                wire += n[2 * i + 1] * (line.rest[k, e + i, 1] + work.r[0, row, e + i])
                w[row, e + i] += n[2 * i] * train.contact[p, k]
                r[row, e + i] += n[2 * i + 1] * train.contact[p, k]
                for j in range(2):
                    for m in range(2):
                        column = line.contact_columns[k, e + j, m]
                        at = half + i - j
                        compliance += n[2 * j + m] * (n[2 * i] * column[0, at] + n[2 * i + 1] * column[1, at])
            work.closing[p, k] = head - wire
            work.compliance[p, k] = compliance


@njit(cache=True)
def add_column(w: Array, r: Array, column: Array, station: int, value: float) -> None:
    """Add `value` times a local column of the inverse to the accelerations of one row."""
    width = column.shape[1]
    shift = station - width // 2
    first, last = max(0, -shift), min(width, w.size - shift)
    for i in range(first, last):
        w[i + shift] += value * column[0, i]
        r[i + shift] += value * column[1, i]


@njit(cache=True)
def turn_connectors(line: Line, motion: Motion, work: Workspace, w: Array, r: Array) -> float:
    """Solve every connector once, the other forces held; returns the largest change of a tension [N]."""
    dt = line.time_step
    half = line.columns.shape[2] // 2
    largest = 0.0
    for n in range(line.station.size):
        s, k, c = line.station[n], line.stiffness[n], line.damping[n]
        acceleration, compliance = 0.0, 0.0
        for e in range(line.end_row.shape[1]):
            f = line.end_coefficient[n, e]
            acceleration += f * w[line.end_row[n, e], s]
            compliance += f * f * line.columns[line.end_column[n, e], 0, half]
        gain = k * dt * dt / 4 + c * dt / 2
        elastic = line.preload[n] + k * work.elongation[0, n] + c * work.elongation[1, n] + gain * acceleration
        tension = (elastic + gain * compliance * motion.tension[n]) / (1 + gain * compliance)
        if line.unilateral[n] and tension < 0.0:
            tension = 0.0
        change = tension - motion.tension[n]
        if change != 0.0:
            motion.tension[n] = tension
            for e in range(line.end_row.shape[1]):
                row, f = line.end_row[n, e], line.end_coefficient[n, e]
                if f != 0.0:
                    add_column(w[row], r[row], line.columns[line.end_column[n, e]], s, -f * change)
        largest = max(largest, abs(change))
    return largest


@njit(cache=True)
def turn_contacts(line: Line, train: Train, work: Workspace, w: Array, r: Array) -> float:
    """Solve every contact once, the other forces held; returns the largest change of a contact force [N]."""
    dt = line.time_step
    largest = 0.0
    for p in range(train.position.size):
        e, k = work.element[p], train.contact_stiffness[p]
        for m in range(train.contact.shape[1]):
            row, n = line.contact_row[m], work.shape[p, m]
            approach = 0.0
            for i in range(train.z.shape[2]):
                approach += train.head[p, i] * train.z[2, p, i]
            approach -= n[0] * w[row, e] + n[1] * r[row, e] + n[2] * w[row, e + 1] + n[3] * r[row, e + 1]
            gain = k * dt * dt / 4
            stiff = gain * work.compliance[p, m]
            force = (k * work.closing[p, m] + gain * approach + stiff * train.contact[p, m]) / (1 + stiff)
            force = max(force, 0.0)
            change = force - train.contact[p, m]
            if change != 0.0:
                train.contact[p, m] = force
                for i in range(2):
                    for j in range(2):
                        add_column(w[row], r[row], line.contact_columns[m, e + i, j], e + i, n[2 * i + j] * change)
                for i in range(train.z.shape[2]):
                    for j in range(train.z.shape[2]):
                        train.z[2, p, i] -= train.inverse[p, i, j] * train.head[p, j] * change
            largest = max(largest, abs(change))
    return largest


@njit(cache=True)
def step(line: Line, motion: Motion, train: Train, work: Workspace) -> int:
    """Advance line and pantographs by one time step, in place.

    Parameters
    ----------
    line : Line
    motion : Motion
    train : Train, with no pantograph at all for a free line
    work : Workspace

    Returns
    -------
    turns taken; zero when the forces did not converge
    """
    dt = line.time_step
    w, r = motion.w[2], motion.r[2]
    rows, stations = w.shape
    predict_wires(line, motion, work)
    wire_forces(line, work, w, r)
    predict_connectors(line, motion, work, w)
    predict_train(line, train, work, w, r)
    for b in range(rows):
        solve_row(line.factor, b, 0, stations - 1, w[b], r[b])
    turns = 0
    while turns < MOST_TURNS:
        turns += 1
        largest = turn_contacts(line, train, work, w, r)
        largest = max(largest, turn_connectors(line, motion, work, w, r))
        if largest < FORCE_TOLERANCE:
            break
    for b in range(rows):
        for s in range(stations):
            motion.w[0, b, s] = work.w[0, b, s] + dt * dt / 4 * w[b, s]
            motion.w[1, b, s] = work.w[1, b, s] + dt / 2 * w[b, s]
        for s in range(stations):
            motion.r[0, b, s] = work.r[0, b, s] + dt * dt / 4 * r[b, s]
            motion.r[1, b, s] = work.r[1, b, s] + dt / 2 * r[b, s]
    for p in range(train.position.size):
        for i in range(train.z.shape[2]):
            train.z[0, p, i] = work.z[0, p, i] + dt * dt / 4 * train.z[2, p, i]
            train.z[1, p, i] = work.z[1, p, i] + dt / 2 * train.z[2, p, i]
    # A comparison that is also false for NaN.
    return turns if largest < FORCE_TOLERANCE else 0


@njit(cache=True)
def march(
    line: Line,
    motion: Motion,
    train: Train,
    work: Workspace,
    watch_row: Indices,
    watch_station: Indices,
    contact: Array,
    height: Array,
    watched: Array,
    dropper: Array,
) -> int:
    """Advance by as many steps as the outputs have room for.

    Parameters
    ----------
    line, motion, train, work : as for `step`
    watch_row, watch_station : (U,) where displacements are recorded
    contact : (T, P) contact force in total, filled [N]
    height : (T, P) of the head, filled [m]
    watched : (T, U) displacement at the watched stations, filled [m]
    dropper : (T, N) tension of the connectors, filled; or (T, 0) [N]

    Returns
    -------
    steps completed
    """
    for n in range(contact.shape[0]):
        if step(line, motion, train, work) == 0:
            return n
        for p in range(train.position.size):
            total, head = 0.0, 0.0
            for k in range(train.contact.shape[1]):
                total += train.contact[p, k]
            for i in range(train.z.shape[2]):
                head += train.head[p, i] * train.z[0, p, i]
            contact[n, p], height[n, p] = total, head
        for u in range(watch_row.size):
            watched[n, u] = motion.w[0, watch_row[u], watch_station[u]]
        for d in range(dropper.shape[1]):
            dropper[n, d] = motion.tension[d]
    return int(contact.shape[0])
