"""Contact of pantographs and contact wires in a time step: Gauss-Seidel sweeps over the contact forces.

A head can touch every contact wire whose extent covers the element above it: parallel wires, and in an overlap of
sections the wires of both. A raised wire lies above the head and has no overlap with it.

The contact is a unilateral spring between head and wire: the penalty and the residual flexibility of the wire element
in series (`residual_flexibility`). With the predicted overlap d of head and wire, the force at the end of a step is

    F = max(0, k (d + dt^2/4 a)),    a = acceleration of the head minus acceleration of the wire

A change of F changes a by -(compliance) F, and F is solved exactly with all other forces held.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.block_tridiagonal import Factor
from pantocheck.model.dynamics.inverse_columns import add_column, inverse_columns
from pantocheck.model.dynamics.irregularity_step import (
    IrregularityArrays,
    build_irregularity_arrays,
    height_of_irregularity,
)
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.dynamics.sweeps import NEGLIGIBLE_FORCE, maximum
from pantocheck.model.dynamics.train import Train
from pantocheck.model.fem.contact_wires import ContactWires, locate_contact_wires
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.fem.residual_flexibility import residual_flexibility

_find_element = njit(cache=True)(find_element)


class ContactArrays(NamedTuple):
    """Contact wires of a line in a time step; W contact wires, S stations.

    Parameters
    ----------
    time_step : float
        Time step [s].
    position : (S,) ndarray
        Positions of the stations [m].
    wires : ContactWires
        Rows and extents of the contact wires.
    first_column : (W,) int ndarray
        Index of the first station of each contact wire in `columns`.
    rest : (B, S, 2) ndarray
        Height and slope of the rows in the initial state [m, -].
    flexibility : (B, S-1, 7) ndarray
        Residual flexibility of the elements, see `element_flexibility` [m/N].
    irregularity : IrregularityArrays
        Additional heights of the contact wires.
    columns : (L, 2, 2, 2H) ndarray
        Columns of the inverse around the stations of all contact wires, for a force and for a moment.
    """

    time_step: float
    position: Array
    wires: ContactWires
    first_column: Indices
    rest: Array
    flexibility: Array
    irregularity: IrregularityArrays
    columns: Array


class ContactWorkspace(NamedTuple):
    """Predictors of the contacts of one step; P pantographs, W contact wires.

    Parameters
    ----------
    element : (P,) int ndarray
        Element above each pantograph.
    above : (P, W) int ndarray
        Contact wires above each pantograph, in the order of the line.
    number_above : (P,) int ndarray
        Their number.
    shape : (P, W, 4) ndarray
        Hermite functions at the contacts.
    stiffness : (P, W) ndarray
        Penalty and residual flexibility in series [N/m].
    overlap : (P, W) ndarray
        Predicted overlap of head and wire [m].
    compliance : (P, W) ndarray
        Relative acceleration of head and wire per contact force [1/kg].
    """

    element: Indices
    above: Indices
    number_above: Indices
    shape: Array
    stiffness: Array
    overlap: Array
    compliance: Array


def build_contact_arrays(line: DiscretisedLine, factor: Factor, time_step: float, half_width: int) -> ContactArrays:
    """Build the arrays of the contact wires for a time step [s]; `half_width` as in `inverse_columns`."""
    wires = locate_contact_wires(line)
    count = wires.last - wires.first + 1
    first_column = np.cumsum(count) - count
    row = np.repeat(wires.row, count)
    station = np.arange(row.size) + np.repeat(wires.first - first_column, count)
    columns = inverse_columns(
        factor, np.repeat(row, 2), np.repeat(station, 2), np.tile(np.arange(2), row.size), half_width
    )
    return ContactArrays(
        time_step=time_step,
        position=line.mesh.position,
        wires=wires,
        first_column=first_column,
        rest=np.ascontiguousarray(line.state.deflection),
        flexibility=line.beams.flexibility,
        irregularity=build_irregularity_arrays(line.catenary.contact_wires),
        columns=columns.reshape(row.size, 2, 2, 2 * half_width),
    )


def allocate_contact_workspace(train: Train) -> ContactWorkspace:
    """Allocate the scratch arrays for the simulation of a train."""
    pantographs, wires = train.contact.shape
    stiffness, overlap, compliance = (np.zeros((pantographs, wires)) for _ in range(3))
    element, number_above = (np.zeros(pantographs, dtype=np.int64) for _ in range(2))
    above, shape = np.zeros((pantographs, wires), dtype=np.int64), np.zeros((pantographs, wires, 4))
    return ContactWorkspace(element, above, number_above, shape, stiffness, overlap, compliance)


@njit(cache=True)
def predict_train(contact: ContactArrays, motion: Motion, train: Train, work: ContactWorkspace) -> None:
    """Move and predict the pantographs, and press with the contact forces of the last step as a first guess."""
    dt = contact.time_step
    unknowns = train.z.shape[2]
    train.elapsed[0] += dt
    # Share of the static force that still holds the heads down: a half-cosine from 1 to 0.
    holding = 0.0
    if train.elapsed[0] < train.ramp[0]:
        holding = (1 + math.cos(math.pi * train.elapsed[0] / train.ramp[0])) / 2
    for p in range(train.position.size):
        train.position[p] += dt * train.speed[0]
        _find_wires_above(contact, train, work, p)
        for i in range(unknowns):
            train.z[0, p, i] += dt * train.z[1, p, i] + dt * dt / 4 * train.z[2, p, i]
            train.z[1, p, i] += dt / 2 * train.z[2, p, i]
        contact_force = 0.0
        for n in range(work.number_above[p]):
            contact_force += train.contact[p, work.above[p, n]]
        contact_force += holding * train.held[p]
        head, compliance = 0.0, 0.0
        for i in range(unknowns):
            acceleration = 0.0
            for j in range(unknowns):
                force = train.force[p, j] - train.head[p, j] * contact_force
                for m in range(unknowns):
                    force -= train.damping[p, j, m] * train.z[1, p, m] + train.stiffness[p, j, m] * train.z[0, p, m]
                acceleration += train.inverse[p, i, j] * force
                compliance += train.head[p, i] * train.inverse[p, i, j] * train.head[p, j]
            train.z[2, p, i] = acceleration
            head += train.head[p, i] * train.z[0, p, i]
        work.overlap[p] = head
        work.compliance[p] = compliance
        for n in range(work.number_above[p]):
            _predict_contact(contact, motion, train, work, p, work.above[p, n])


@njit(cache=True)
def _find_wires_above(contact: ContactArrays, train: Train, work: ContactWorkspace, p: int) -> None:
    """Find the element and the contact wires above pantograph p; a wire that it has left presses no more."""
    e, _, _ = _find_element(contact.position, train.position[p])
    work.element[p], work.number_above[p] = e, 0
    for wire in range(train.contact.shape[1]):
        if contact.wires.first[wire] <= e < contact.wires.last[wire]:
            work.above[p, work.number_above[p]] = wire
            work.number_above[p] += 1
        else:
            train.contact[p, wire] = 0.0


@njit(cache=True)
def _predict_contact(
    contact: ContactArrays, motion: Motion, train: Train, work: ContactWorkspace, p: int, wire: int
) -> None:
    """Complete overlap and compliance of pantograph p, so far those of its head, by those of a contact wire."""
    half_width = contact.columns.shape[3] // 2
    row, n = contact.wires.row[wire], work.shape[p, wire]
    e, h, s = _find_element(contact.position, train.position[p])
    # Hermite functions, as in `beam.shape`.
    n[0], n[1] = (1 + 2 * s) * (1 - s) ** 2, h * s * (1 - s) ** 2
    n[2], n[3] = s * s * (3 - 2 * s), h * s * s * (s - 1)
    first_column = contact.first_column[wire] + e - contact.wires.first[wire]
    height, compliance = 0.0, work.compliance[p, wire]
    for i in range(2):
        height += n[2 * i] * (contact.rest[row, e + i, 0] + motion.w[0, row, e + i])
        height += n[2 * i + 1] * (contact.rest[row, e + i, 1] + motion.r[0, row, e + i])
        motion.w[2, row, e + i] += n[2 * i] * train.contact[p, wire]
        motion.r[2, row, e + i] += n[2 * i + 1] * train.contact[p, wire]
        for j in range(2):
            for slope in range(2):
                column = contact.columns[first_column + j, slope]
                station = half_width + i - j
                compliance += n[2 * j + slope] * (n[2 * i] * column[0, station] + n[2 * i + 1] * column[1, station])
    work.stiffness[p, wire] = 1 / (
        1 / train.contact_stiffness[p] + residual_flexibility(contact.flexibility[row, e], s)
    )
    work.overlap[p, wire] -= height + height_of_irregularity(contact.irregularity, wire, train.position[p])
    work.compliance[p, wire] = compliance


@njit(cache=True)
def sweep_contacts(
    contact: ContactArrays, motion: Motion, train: Train, work: ContactWorkspace, window: Window
) -> float:
    """Solve every contact once, all other forces held; return the largest change of a contact force [N]."""
    dt = contact.time_step
    w, r = motion.w[2], motion.r[2]
    largest = 0.0
    for p in range(train.position.size):
        e = work.element[p]
        for number in range(work.number_above[p]):
            wire = work.above[p, number]
            row, n, k = contact.wires.row[wire], work.shape[p, wire], work.stiffness[p, wire]
            approach = 0.0
            for i in range(train.z.shape[2]):
                approach += train.head[p, i] * train.z[2, p, i]
            approach -= n[0] * w[row, e] + n[1] * r[row, e] + n[2] * w[row, e + 1] + n[3] * r[row, e + 1]
            gain = k * dt * dt / 4
            compliance = gain * work.compliance[p, wire]
            linear = k * work.overlap[p, wire] + gain * approach
            force = max((linear + compliance * train.contact[p, wire]) / (1 + compliance), 0.0)
            change = force - train.contact[p, wire]
            if abs(change) > NEGLIGIBLE_FORCE:
                train.contact[p, wire] = force
                first_column = contact.first_column[wire] + e - contact.wires.first[wire]
                for i in range(2):
                    for j in range(2):
                        column, value = contact.columns[first_column + i, j], n[2 * i + j] * change
                        add_column(w[row], r[row], column, e + i, value, window)
                for i in range(train.z.shape[2]):
                    for j in range(train.z.shape[2]):
                        train.z[2, p, i] -= train.inverse[p, i, j] * train.head[p, j] * change
            largest = maximum(largest, abs(change))
    return largest


@njit(cache=True)
def correct_train(dt: float, train: Train) -> None:
    """Complete the predictors of the pantographs with the accelerations at the end of the step."""
    for p in range(train.position.size):
        for i in range(train.z.shape[2]):
            train.z[0, p, i] += dt * dt / 4 * train.z[2, p, i]
            train.z[1, p, i] += dt / 2 * train.z[2, p, i]
