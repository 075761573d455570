"""Connectors in a time step, by local columns of the inverse of the effective matrix.

A column is the response of a row to a unit force within one step. This force influences the line over a few times
sqrt(T / m) dt / 2 only (0.1 m at 1 ms). The matrix is symmetric: the column of a force at a station is also the share
of every force around in the acceleration of this station.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csc_array

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.discretisation.connectors import Connectors
from pantocheck.model.dynamics.active_window import Window, search
from pantocheck.model.dynamics.block_tridiagonal import Factor, solve_stations
from pantocheck.model.dynamics.extents import active_run, find_runs
from pantocheck.model.dynamics.kernel_compilation import entry_kernel, kernel
from pantocheck.model.dynamics.motion import Layout, Motion
from pantocheck.model.dynamics.scalar_forces import ScalarForces, ScalarWorkspace
from pantocheck.model.dynamics.vectors import LANES, align, lane_sum, load, splat

NEGLIGIBLE_SHARE = 1e-12
"""A column is cut where it has decayed below this share of its peak: a hundredth of the tolerance of the forces."""


def column_half_width(factor: Factor, loads: list[tuple[int, int]]) -> int:
    """Number of stations to keep on either side of a load: the rest of its column is negligible for every load.

    A load is a row and a station.
    """
    rows, stations = np.array(loads, dtype=np.int64).reshape(-1, 2).T.copy()
    width = LANES
    while width < factor.link.shape[1]:
        if _largest_tail(factor, rows, stations, width, np.zeros((2, 2 * width))) < NEGLIGIBLE_SHARE:
            break
        width += LANES
    return width


@entry_kernel
def _largest_tail(factor: Factor, rows: Indices, stations: Indices, half_width: int, column: Array) -> float:
    """Largest size of a column of the inverse at a cut on either side of its load, relative to its peak.

    The columns are those of a unit force and of a unit moment at every load; `column` is scratch memory, (2, 2 n).
    """
    largest = 0.0
    for k in range(rows.size):
        first, last = max(0, stations[k] - half_width), min(factor.link.shape[1], stations[k] + half_width) - 1
        shift = half_width - stations[k]
        for slope in range(2):
            column[:] = 0.0
            column[slope, half_width] = 1.0
            solve_stations(factor, rows[k], first, last, column[0], column[1], shift)
            peak = 0.0
            for i in range(2 * half_width):
                peak = max(peak, abs(column[0, i]) + abs(column[1, i]))
            # Zero beyond the ends of the line.
            tail = max(abs(column[0, 0]) + abs(column[1, 0]), abs(column[0, -1]) + abs(column[1, -1]))
            if peak > 0.0:
                largest = max(largest, tail / peak)
    return largest


@entry_kernel
def inverse_columns(factor: Factor, rows: Indices, stations: Indices, starts: Indices, columns: Array) -> None:
    """Fill local columns of the inverse for L unit forces.

    Args:
        factor: Block factors.
        rows, stations: Places of the forces, (L,).
        starts: Station of the first value of each column, (L,); it can lie before the line.
        columns: Deflection and slope at n stations, zero on entry, (L, 2, n); they stay zero beyond the ends of the
            line.
    """
    for k in range(rows.size):
        first, last = max(0, starts[k]), min(factor.link.shape[1], starts[k] + columns.shape[2]) - 1
        columns[k, 0, stations[k] - starts[k]] = 1.0
        solve_stations(factor, rows[k], first, last, columns[k, 0], columns[k, 1], -starts[k])


# Connectors in a time step: their tensions are scalar forces (`scalar_forces`) at a few nodes.
#
# A node is a row and a station at which connectors end; connectors at the same place share it. The acceleration of a
# node under all forces of a row is the inner product of these forces with the local column of the inverse
# (`inverse_columns`) of the node. It is needed for the forces of the predicted motion only: the sweeps change it by the
# compliances of the tensions. The changes of the tensions are then loads at the nodes.
class NodeArrays(NamedTuple):
    """Nodes of the connectors, row by row; J nodes, L ends of connectors, B rows."""

    first: Indices
    """First node of each row, and J, (B + 1,)."""
    row: Indices
    station: Indices
    """Places of the nodes, (J,); the stations of a row increase."""
    column: Array
    """Columns of the inverse around the nodes, (J, 2, n): deflection and slope [1/kg, 1/(kg m)]."""
    column_start: Indices
    """Station of the first value of each column, (J,); it can lie before the line."""
    first_end: Indices
    """First end of a connector at each node, and L, (J + 1,)."""
    connector: Indices
    """Connector of each end, (L,)."""
    coefficient: Array
    """Coefficient of each end in the elongation of its connector, (L,) [-]."""


class ConnectorArrays(NamedTuple):
    """Connectors of a line in a time step; N connectors in R runs with at most E ends."""

    run: Indices
    """First connector of each run (`find_runs`), and N, (R + 1,)."""
    station: Indices
    """Stations of the connectors, (N,)."""
    end_node: Indices
    end_index: Indices
    """Node of each end, and its index in a flattened plane of rows, (N, E)."""
    end_coefficient: Array
    """Coefficient of each end in the elongation, (N, E); zero for a missing end [-]."""
    nodes: NodeArrays


def connector_ends(connectors: Connectors) -> list[tuple[int, int]]:
    """Row and station of all ends, connector by connector."""
    number, row = np.nonzero(connectors.coefficient)
    return list(zip(row.tolist(), connectors.station[number].tolist(), strict=True))


def build_connector_arrays(connectors: Connectors, factor: Factor, layout: Layout, half_width: int) -> ConnectorArrays:
    """Build the arrays of the connectors for a time step; `half_width` as in `column_half_width`."""
    number, row = np.nonzero(connectors.coefficient)
    end = np.arange(number.size) - np.searchsorted(number, number)
    coefficient = connectors.coefficient[number, row]
    place, node = np.unique(row * layout.width + connectors.station[number], return_inverse=True)
    shape = (len(connectors.station), int(end.max(initial=-1)) + 1)
    end_node, end_index = (np.zeros(shape, dtype=np.int64) for _ in range(2))
    end_coefficient = np.zeros(shape)
    end_node[number, end], end_index[number, end], end_coefficient[number, end] = node, place[node], coefficient
    node_row, node_station = place // layout.width, place % layout.width
    column_start = node_station - half_width
    column = align(np.zeros((place.size, 2, 2 * half_width)))
    inverse_columns(factor, node_row, node_station, column_start, column)
    order = np.argsort(node, kind="stable")
    nodes = NodeArrays(
        first=np.searchsorted(node_row, np.arange(connectors.coefficient.shape[1] + 1)),
        row=node_row,
        station=node_station,
        column=column,
        column_start=column_start,
        first_end=np.searchsorted(node[order], np.arange(place.size + 1)),
        connector=number[order],
        coefficient=coefficient[order],
    )
    run = find_runs(connectors.station)
    return ConnectorArrays(run, connectors.station, end_node, end_index, end_coefficient, nodes)


def coefficients_at_nodes(connectors: ConnectorArrays) -> csc_array:
    """Coefficients of N connectors at J nodes, (N, J)."""
    nodes = connectors.nodes
    shape = (connectors.station.size, nodes.station.size)
    return csc_array((nodes.coefficient, nodes.connector, nodes.first_end), shape=shape)


def node_compliance(nodes: NodeArrays) -> coo_array:
    """Acceleration of each node per force at any other node, (J, J) [1/kg]; zero outside of the local columns."""
    size, width = nodes.station.size, nodes.column.shape[2]
    values, rows, columns = [np.zeros(0)], [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for distance in range(size):
        one, other = np.arange(size - distance), np.arange(distance, size)
        index = nodes.station[other] - nodes.column_start[one]
        near = np.flatnonzero((nodes.row[one] == nodes.row[other]) & (index < width))
        if not near.size:
            break
        value = nodes.column[near, 0, index[near]]
        pairs = [(near, near + distance), (near + distance, near)]
        for row, column in pairs[: 1 + (distance > 0)]:
            values.append(value)
            rows.append(row)
            columns.append(column)
    places = np.concatenate(rows), np.concatenate(columns)
    return coo_array((np.concatenate(values), places), shape=(size, size))


@kernel
def predict_connectors(
    connectors: ConnectorArrays, forces: ScalarForces, motion: Motion, work: ScalarWorkspace, window: Window
) -> None:
    """Fill the predicted tensions, and load the nodes with the tensions of the last step as a first guess."""
    w, law = motion.w.reshape(motion.w.size), forces.law
    plane = motion.w.shape[1] * motion.w.shape[2]
    for k in range(connectors.run.size - 1):
        first, end = active_run(connectors.station, connectors.run, k, window)
        for n in range(first, end):
            change = motion.force[n] - law.preload[n]
            elongation, rate = 0.0, 0.0
            for e in range(connectors.end_index.shape[1]):
                at, c = connectors.end_index[n, e], connectors.end_coefficient[n, e]
                elongation += c * w[at]
                rate += c * w[at + plane]
                w[at + 2 * plane] -= c * change
            work.predicted[n] = law.preload[n] + law.stiffness[n] * elongation + law.damping[n] * rate
            work.change[n] = 0.0


@kernel
def accelerate_connectors(
    connectors: ConnectorArrays, motion: Motion, node: Array, work: ScalarWorkspace, window: Window
) -> None:
    """Compute the accelerations of the active nodes and elongations under all forces.

    Args:
        connectors: Connectors of a line.
        motion: Forces in place of the accelerations.
        node: Accelerations of the nodes, replaced, (J,) [m/s2].
        work: Its accelerations are replaced.
        window: Active window.
    """
    nodes, width = connectors.nodes, motion.w.shape[2]
    size = nodes.column.shape[2]
    for row in range(nodes.first.size - 1):
        first = search(nodes.station, nodes.first[row], nodes.first[row + 1], window.first)
        end = search(nodes.station, first, nodes.first[row + 1], window.last + 1)
        plane = (2 * motion.w.shape[1] + row) * width
        for j in range(first, end):
            node[j] = inner_product(nodes.column, 2 * j * size, size, motion.w, motion.r, plane + nodes.column_start[j])
    for k in range(connectors.run.size - 1):
        first, end = active_run(connectors.station, connectors.run, k, window)
        for n in range(first, end):
            acceleration = 0.0
            for e in range(connectors.end_node.shape[1]):
                acceleration += connectors.end_coefficient[n, e] * node[connectors.end_node[n, e]]
            work.acceleration[n] = acceleration


@kernel
def inner_product(pair: Array, first: int, size: int, w: Array, r: Array, at: int) -> float:
    """Inner product of two rows, deflections and slopes, with parts of two fields.

    Args:
        pair: Array with both rows one after the other.
        first, size: Index of the first row in the flattened array, and length of a row: whole vectors.
        w, r: Deflections and slopes.
        at: Index of their parts in the flattened arrays.
    """
    product, other = splat(0.0), splat(0.0)
    for i in range(0, size, LANES):
        product = product + load(pair, first + i) * load(w, at + i)
        other = other + load(pair, first + size + i) * load(r, at + i)
    return float(lane_sum(product + other))


@kernel
def load_connectors(connectors: ConnectorArrays, motion: Motion, work: ScalarWorkspace, window: Window) -> None:
    """Load the nodes with the changes of the active tensions since the last step."""
    w = motion.w.reshape(motion.w.size)
    plane = motion.w.shape[1] * motion.w.shape[2]
    for k in range(connectors.run.size - 1):
        first, end = active_run(connectors.station, connectors.run, k, window)
        for n in range(first, end):
            for e in range(connectors.end_index.shape[1]):
                w[connectors.end_index[n, e] + 2 * plane] -= connectors.end_coefficient[n, e] * work.change[n]
