"""The time step: Newmark average acceleration with unilateral droppers and contact.

The rows of beams are factored once. Connectors and contacts are scalar forces whose effect within the step is known in
closed form (the local columns of the inverse), so each is solved exactly in turn, and the turns are repeated until no
force changes any more. Forces far apart do not feel each other within a step, so two or three turns do.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from pantocheck.model.effective import Factor, solve_row

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

FORCE_TOLERANCE = 1e-9
"""A step has converged when no force changed by more than this in a turn [N]; forces are of the order of 100 N."""
NEGLIGIBLE_FORCE = 1e-13
"""Changes of a force below this are rounding, and are not passed on [N]."""
MOST_TURNS = 200
"""After so many turns a step is given up."""


class Line(NamedTuple):
    """What stays the same during a run; B rows, S stations, N connectors with E ends, W contact wires.

    Parameters
    ----------
    time_step : [s]
    reach : what lies farther than this from every pantograph stands still [m]
    position : (S,) [m]
    length : (S-1,) of the elements [m]
    stiffness_entries : (B, 4, S-1) entries 11, 12, 22, 24 of each element's stiffness [N/m, N, N m, N m]
    mass_scale : (B, S-1) mass per length times length over 420 of each element [kg]
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
    modal_damping : (J,) of the modes whose damping is set one by one [1/s]
    modal_weight : (J, B, S, 2) M phi of these modes [kg^1/2]
    modal_response : (J, B, S, 2) the inverse applied to it [kg^-1/2]
    modal_compliance : (J,) weight times response [-]
    load_row, load_station : where the external load acts
    rest : (W, S, 2) height and slope of the contact wires at rest [m, -]
    """

    time_step: float
    reach: float
    position: Array
    length: Array
    stiffness_entries: Array
    mass_scale: Array
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
    modal_damping: Array
    modal_weight: Array
    modal_response: Array
    modal_compliance: Array
    load_row: int
    load_station: int
    rest: Array


class Motion(NamedTuple):
    """State of the line about its initial state.

    Parameters
    ----------
    w, r : (3, B, S) deflection and slope: displacement, velocity, acceleration [m, -; per s; per s2]
    tension : (N,) of the connectors, in total [N]
    modal : (J,) damping forces on the modes whose damping is set one by one [N kg^-1/2]
    load : (1,) external load, upwards [N]
    """

    w: Array
    r: Array
    tension: Array
    modal: Array
    load: Array


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
    shear : (S-1,) of the elements of one row [N]
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
    shear: Array
    elongation: Array
    shape: Array
    element: Indices
    closing: Array
    compliance: Array
    z: Array


@njit(cache=True)
def moving_part(line: Line, train: Train) -> tuple[int, int]:
    """First and last of the stations that move: those within reach of a pantograph, or all without one."""
    first, last = 0, line.position.size - 1
    if train.position.size > 0:
        first = max(first, np.searchsorted(line.position, train.position.min() - line.reach))
        last = min(last, np.searchsorted(line.position, train.position.max() + line.reach))
    return first, last


@njit(cache=True)
def predict_wires(line: Line, motion: Motion, work: Workspace, first: int, last: int) -> None:
    """Newmark predictors of the rows, and the displacement that their stiffness sees."""
    dt = line.time_step
    for now, predicted, seen in ((motion.w, work.w, work.seen_w), (motion.r, work.r, work.seen_r)):
        for b in range(now.shape[1]):
            c = line.stiffness_coefficient[b]
            q, v, a = now[0, b, first : last + 1], now[1, b, first : last + 1], now[2, b, first : last + 1]
            to_q, to_v = predicted[0, b, first : last + 1], predicted[1, b, first : last + 1]
            _predict(dt, c, q, v, a, to_q, to_v, seen[b, first : last + 1])


@njit(cache=True)
def _predict(dt: float, c: float, q: Array, v: Array, a: Array, to_q: Array, to_v: Array, seen: Array) -> None:
    for s in range(q.size):
        to_q[s] = q[s] + dt * v[s] + dt * dt / 4 * a[s]
    for s in range(q.size):
        to_v[s] = v[s] + dt / 2 * a[s]
    for s in range(q.size):
        seen[s] = to_q[s] + c * to_v[s]


@njit(cache=True)
def wire_forces(line: Line, work: Workspace, w: Array, r: Array, first: int, last: int) -> None:
    """Forces and moments that wires and lumped parts exert on the stations in the predicted state, into w and r.

    The loops are cut so that each fills one array from a few others, in which form they compile to vector instructions.
    """
    h, shear = line.length[first:last], work.shear[first:last]
    for b in range(w.shape[0]):
        f, m = w[b, first : last + 1], r[b, first : last + 1]
        f[:] = 0.0
        m[:] = 0.0
        k = line.stiffness_entries[b]
        p, t = work.seen_w[b, first : last + 1], work.seen_r[b, first : last + 1]
        k11, k12, k22, k24 = k[0, first:last], k[1, first:last], k[2, first:last], k[3, first:last]
        _add_stiffness_forces(k11, k12, k22, k24, p, t, shear, f, m)
        q, v, u = work.w[0, b, first : last + 1], work.w[1, b, first : last + 1], work.r[1, b, first : last + 1]
        if line.mass_coefficient[b] != 0.0:
            _add_mass_damping(line.mass_coefficient[b], line.mass_scale[b, first:last], h, v, u, f, m)
        spring, damper = line.lumped_stiffness[b, first : last + 1], line.lumped_damping[b, first : last + 1]
        for s in range(f.size):
            f[s] -= spring[s] * q[s] + damper[s] * v[s]


@njit(cache=True)
def _add_stiffness_forces(
    k11: Array, k12: Array, k22: Array, k24: Array, p: Array, t: Array, shear: Array, w: Array, r: Array
) -> None:
    """Forces of beam elements in deflections p and slopes t."""
    p0, p1, t0, t1 = p[:-1], p[1:], t[:-1], t[1:]
    w0, w1, r0, r1 = w[:-1], w[1:], r[:-1], r[1:]
    for e in range(shear.size):
        shear[e] = k11[e] * (p0[e] - p1[e]) + k12[e] * (t0[e] + t1[e])
    for e in range(shear.size):
        w0[e] -= shear[e]
    for e in range(shear.size):
        w1[e] += shear[e]
    for e in range(shear.size):
        r0[e] -= k12[e] * (p0[e] - p1[e]) + k22[e] * t0[e] + k24[e] * t1[e]
    for e in range(shear.size):
        r1[e] -= k12[e] * (p0[e] - p1[e]) + k24[e] * t0[e] + k22[e] * t1[e]


@njit(cache=True)
def _add_mass_damping(c: float, scale: Array, length: Array, v: Array, u: Array, w: Array, r: Array) -> None:
    """Damping proportional to the consistent mass of beam elements, in velocities v and u of deflection and slope."""
    v0, v1, u0, u1 = v[:-1], v[1:], u[:-1], u[1:]
    w0, w1, r0, r1 = w[:-1], w[1:], r[:-1], r[1:]
    for e in range(scale.size):
        w0[e] -= c * scale[e] * (156 * v0[e] + 54 * v1[e] + length[e] * (22 * u0[e] - 13 * u1[e]))
    for e in range(scale.size):
        w1[e] -= c * scale[e] * (54 * v0[e] + 156 * v1[e] + length[e] * (13 * u0[e] - 22 * u1[e]))
    for e in range(scale.size):
        r0[e] -= c * scale[e] * length[e] * (22 * v0[e] + 13 * v1[e] + length[e] * (4 * u0[e] - 3 * u1[e]))
    for e in range(scale.size):
        r1[e] += c * scale[e] * length[e] * (13 * v0[e] + 22 * v1[e] + length[e] * (3 * u0[e] - 4 * u1[e]))


@njit(cache=True)
def predict_connectors(line: Line, motion: Motion, work: Workspace, w: Array, first: int, last: int) -> None:
    """Predicted elongations; the connectors pull with their tensions of the last step to begin with."""
    for n in range(line.station.size):
        s = line.station[n]
        if s < first or s > last:
            continue
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
def add_column(w: Array, r: Array, column: Array, station: int, value: float, limits: tuple[int, int]) -> None:
    """Add `value` times a local column of the inverse to the accelerations of one row, between two stations."""
    half = column.shape[1] // 2
    first, last = max(limits[0], station - half), min(limits[1], station + half) + 1
    shift = half - station
    _add_scaled(w[first:last], column[0, first + shift : last + shift], value)
    _add_scaled(r[first:last], column[1, first + shift : last + shift], value)


@njit(cache=True)
def _add_scaled(target: Array, source: Array, value: float) -> None:
    for i in range(target.size):
        target[i] += value * source[i]


@njit(cache=True)
def larger(a: float, b: float) -> float:
    """The larger of two numbers, or NaN where either is: `max` would drop it, and a lost run would look settled."""
    return a if a >= b or math.isnan(a) else b


@njit(cache=True)
def turn_connectors(line: Line, motion: Motion, work: Workspace, w: Array, r: Array, first: int, last: int) -> float:
    """Solve every connector between two stations once, the others held; returns the largest change of a tension [N]."""
    dt = line.time_step
    half = line.columns.shape[2] // 2
    largest = 0.0
    for n in range(line.station.size):
        s, k, c = line.station[n], line.stiffness[n], line.damping[n]
        if s < first or s > last:
            continue
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
        if abs(change) > NEGLIGIBLE_FORCE:
            motion.tension[n] = tension
            for e in range(line.end_row.shape[1]):
                row, f = line.end_row[n, e], line.end_coefficient[n, e]
                if f != 0.0:
                    add_column(w[row], r[row], line.columns[line.end_column[n, e]], s, -f * change, (first, last))
        largest = larger(largest, abs(change))
    return largest


@njit(cache=True)
def turn_contacts(line: Line, train: Train, work: Workspace, w: Array, r: Array, first: int, last: int) -> float:
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
            if abs(change) > NEGLIGIBLE_FORCE:
                train.contact[p, m] = force
                for i in range(2):
                    for j in range(2):
                        column, value = line.contact_columns[m, e + i, j], n[2 * i + j] * change
                        add_column(w[row], r[row], column, e + i, value, (first, last))
                for i in range(train.z.shape[2]):
                    for j in range(train.z.shape[2]):
                        train.z[2, p, i] -= train.inverse[p, i, j] * train.head[p, j] * change
            largest = larger(largest, abs(change))
    return largest


@njit(cache=True)
def _add_mode(w: Array, r: Array, shape: Array, value: float) -> None:
    for b in range(w.shape[0]):
        for s in range(w.shape[1]):
            w[b, s] += value * shape[b, s, 0]
            r[b, s] += value * shape[b, s, 1]


@njit(cache=True)
def turn_modes(line: Line, motion: Motion, work: Workspace, w: Array, r: Array) -> float:
    """Solve the damping force on every mode of its own damping once, the others held; returns the largest change."""
    dt = line.time_step
    largest = 0.0
    for j in range(line.modal_damping.size):
        weight, velocity = line.modal_weight[j], 0.0
        for b in range(w.shape[0]):
            for s in range(w.shape[1]):
                velocity += weight[b, s, 0] * (work.w[1, b, s] + dt / 2 * w[b, s])
                velocity += weight[b, s, 1] * (work.r[1, b, s] + dt / 2 * r[b, s])
        compliance = dt / 2 * line.modal_compliance[j]
        velocity -= compliance * motion.modal[j]
        force = -line.modal_damping[j] * velocity / (1 + line.modal_damping[j] * compliance)
        change = force - motion.modal[j]
        if abs(change) > NEGLIGIBLE_FORCE:
            motion.modal[j] = force
            _add_mode(w, r, line.modal_response[j], change)
        largest = larger(largest, abs(change))
    return largest


@njit(cache=True)
def _correct(dt: float, q: Array, v: Array, a: Array, from_q: Array, from_v: Array) -> None:
    for s in range(q.size):
        q[s] = from_q[s] + dt * dt / 4 * a[s]
    for s in range(q.size):
        v[s] = from_v[s] + dt / 2 * a[s]


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
    rows = w.shape[0]
    first, last = moving_part(line, train)
    # One station more on either side stands still and holds the moving part.
    before, behind = max(first - 1, 0), min(last + 1, line.position.size - 1)
    predict_wires(line, motion, work, before, behind)
    wire_forces(line, work, w, r, before, behind)
    predict_connectors(line, motion, work, w, first, last)
    predict_train(line, train, work, w, r)
    w[line.load_row, line.load_station] += motion.load[0]
    for j in range(line.modal_damping.size):
        _add_mode(w, r, line.modal_weight[j], motion.modal[j])
    for b in range(rows):
        solve_row(line.factor, b, first, last, w[b, first : last + 1], r[b, first : last + 1])
    turns = 0
    while turns < MOST_TURNS:
        turns += 1
        largest = turn_contacts(line, train, work, w, r, first, last)
        largest = larger(largest, turn_connectors(line, motion, work, w, r, first, last))
        largest = larger(largest, turn_modes(line, motion, work, w, r))
        if largest < FORCE_TOLERANCE:
            break
    for now, predicted in ((motion.w, work.w), (motion.r, work.r)):
        for b in range(rows):
            q, v, a = now[0, b, first : last + 1], now[1, b, first : last + 1], now[2, b, first : last + 1]
            _correct(dt, q, v, a, predicted[0, b, first : last + 1], predicted[1, b, first : last + 1])
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
    load: Array,
    watch_row: Indices,
    watch_station: Indices,
    contact: Array,
    height: Array,
    watched: Array,
    tension: Array,
) -> int:
    """Advance by as many steps as the outputs have room for.

    Parameters
    ----------
    line, motion, train, work : as for `step`
    load : (T,) external load [N]
    watch_row, watch_station : (U,) where motion is recorded
    contact : (T, P) contact force in total, filled [N]
    height : (T, P) of the head, filled [m]
    watched : (T, U, 3) displacement, velocity, acceleration at the watched stations, filled [m, m/s, m/s2]
    tension : (T, N) of the first connectors, as many as there is room for, filled [N]

    Returns
    -------
    steps completed
    """
    for n in range(load.size):
        motion.load[0] = load[n]
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
            for i in range(3):
                watched[n, u, i] = motion.w[i, watch_row[u], watch_station[u]]
        for d in range(tension.shape[1]):
            tension[n, d] = motion.tension[d]
    return int(load.size)
