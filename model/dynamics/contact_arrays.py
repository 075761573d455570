"""Arrays of the contact wires in a time step: their contact with pantographs, and the splines of their irregularity."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.catenary import Wire
from pantocheck.model.description.irregularity_spline import NO_IRREGULARITY, spline_polynomials
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.block_tridiagonal import Factor
from pantocheck.model.dynamics.connector_step import ConnectorArrays
from pantocheck.model.dynamics.distributed_step import DistributedArrays
from pantocheck.model.dynamics.kernel_compilation import kernel
from pantocheck.model.dynamics.train import Train
from pantocheck.model.dynamics.vectors import LANES, align
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.statics.contact_wires import ContactWires, locate_contact_wires

_find_interval = kernel(find_element)


class IrregularityArrays(NamedTuple):
    """Splines of W contact wires one after the other, with K points in all."""

    first: Indices
    """First point of each wire, (W + 1,); the last entry is K."""
    position: Array
    """Positions of the points, (K,) [m]."""
    polynomial: Array
    """Polynomial from each point to the next, highest power first, (K, 4) [m-2, m-1, -, m]; zero at the last point
    of a wire.
    """


def build_irregularity_arrays(wires: Sequence[Wire]) -> IrregularityArrays:
    """Build the splines of contact wires, in their order."""
    irregularities = [wire.irregularity or NO_IRREGULARITY for wire in wires]
    sizes = [len(irregularity.position) for irregularity in irregularities]
    return IrregularityArrays(
        first=np.cumsum([0, *sizes]),
        position=np.concatenate([irregularity.position for irregularity in irregularities]),
        polynomial=np.concatenate([np.pad(spline_polynomials(i), ((0, 1), (0, 0))) for i in irregularities]),
    )


@kernel
def height_of_irregularity(arrays: IrregularityArrays, wire: int, position: float) -> float:
    """Additional height of a contact wire at a position [m]."""
    first, end = arrays.first[wire], arrays.first[wire + 1]
    points = arrays.position[first:end]
    inside = min(max(position, points[0]), points[-1])
    interval, length, s = _find_interval(points, inside)
    distance, c = s * length, arrays.polynomial[first + interval]
    return float(((c[0] * distance + c[1]) * distance + c[2]) * distance + c[3])


@kernel
def slope_of_irregularity(arrays: IrregularityArrays, wire: int, position: float) -> float:
    """Slope of the additional height of a contact wire at a position; zero beyond its points [-]."""
    first, end = arrays.first[wire], arrays.first[wire + 1]
    points = arrays.position[first:end]
    if not points[0] < position < points[-1]:
        return 0.0
    interval, length, s = _find_interval(points, position)
    distance, c = s * length, arrays.polynomial[first + interval]
    return float((3 * c[0] * distance + 2 * c[1]) * distance + c[2])


# Arrays of the contact of pantographs and contact wires in a time step (`contact_step`).
class ContactArrays(NamedTuple):
    """Contact wires of a line in a time step; W contact wires, S stations."""

    time_step: float
    """Time step [s]."""
    position: Array
    """Positions of the stations, (S,) [m]."""
    wires: ContactWires
    """Rows and extents of the contact wires."""
    lateral_row: Indices
    """Row of the lateral motion of each wire; -1 without lateral field, (W,)."""
    rest: Array
    """Height and slope of the rows in the initial state, (B, S, 2) [m, -]."""
    flexibility: Array
    """Residual flexibility of the elements, see `element_flexibility`, (B, S-1, 7) [m/N]."""
    irregularity: IrregularityArrays
    """Additional heights of the contact wires."""
    factor: Factor
    """Block factors of the effective matrix."""
    half_width: int
    """Number of stations that a force influences on either side of an element (`column_half_width`)."""


class ContactWorkspace(NamedTuple):
    """Predictors of the contacts of one step; C strips, W contact wires, N scalar forces near a contact at most."""

    place: Array
    """Position of each strip along the track, (C,) [m]."""
    element: Indices
    """Element above each strip, (C,)."""
    above: Indices
    """Contact wires above each strip, in the order of the line, (C, W)."""
    number_above: Indices
    """Number of the contact wires above each strip, (C,)."""
    shape: Array
    """Hermite functions at the contacts, (C, W, 4)."""
    stiffness: Array
    """Penalty and residual flexibility in series, (C, W) [N/m]."""
    damping: Array
    """Damping of this series, (C, W) [N s/m]."""
    rate: Array
    """Predicted rate of the overlap, zero without damping, (C, W) [m/s]."""
    overlap: Array
    """Predicted overlap of strip and wire, (C, W) [m]."""
    pressing: Array
    """Force of the last step on each strip, with that of a ramp, (C,) [N]."""
    joint: Array
    """Forces of the joints in the predicted motion, without their bounds, (J,) [N]."""
    head: Array
    """Displacement of each strip below each wire per unknown, (C, W, n) [-]."""
    head_compliance: Array
    """Acceleration of each strip per its contact force, (C, W) [1/kg]."""
    response: Array
    """Accelerations of deflection and slope around each contact per contact force, (C, W, 2, n) [1/kg, 1/(kg m)]."""
    start: Indices
    """Station of the first value of each response, a multiple of a vector size, (C,); it can lie before the line."""
    wire_compliance: Array
    """Acceleration of each wire at one contact per force at another, (C, C, W) [1/kg]."""
    wire_acceleration: Array
    """Acceleration of each wire at its contacts under the forces of the last step, (C, W) [m/s2]."""
    first_guess: Array
    """Contact forces of the last step, (C, W) [N]."""
    near: Indices
    """Scalar forces that a contact influences, (C, W, N)."""
    influence: Array
    """Accelerations of the elongations of these forces per contact force, (C, W, N) [1/kg]."""
    number_near: Indices
    """Number of the scalar forces that a contact influences, (C, W)."""


def build_contact_arrays(line: DiscretisedLine, factor: Factor, time_step: float, half_width: int) -> ContactArrays:
    """Build the arrays of the contact wires for a time step [s]; `half_width` as in `column_half_width`."""
    return ContactArrays(
        time_step=time_step,
        position=line.mesh.position,
        wires=locate_contact_wires(line),
        lateral_row=np.array([line.mesh.row_of.get((wire.name, "y"), -1) for wire in line.catenary.contact_wires]),
        rest=np.ascontiguousarray(line.state.deflection),
        flexibility=line.beams.flexibility,
        irregularity=build_irregularity_arrays(line.catenary.contact_wires),
        factor=factor,
        half_width=half_width,
    )


def allocate_contact_workspace(
    contact: ContactArrays, connectors: ConnectorArrays, distributed: DistributedArrays, train: Train
) -> ContactWorkspace:
    """Allocate the scratch arrays for the simulation of a train."""
    strips, wires = train.contact.shape
    stiffness, damping, rate, overlap, wire_acceleration, first_guess = (np.zeros((strips, wires)) for _ in range(6))
    width = 2 * contact.half_width + 2 * LANES
    nodes = connectors.nodes
    place = nodes.row * (contact.position.size + width) + nodes.station
    ends_before = nodes.first_end[np.searchsorted(place, place + width)]
    near = int((ends_before - nodes.first_end[:-1]).max(initial=0)) + distributed.force.size
    return ContactWorkspace(
        place=np.zeros(strips),
        element=np.zeros(strips, dtype=np.int64),
        above=np.zeros((strips, wires), dtype=np.int64),
        number_above=np.zeros(strips, dtype=np.int64),
        shape=np.zeros((strips, wires, 4)),
        stiffness=stiffness,
        damping=damping,
        rate=rate,
        overlap=overlap,
        pressing=np.zeros(strips),
        joint=np.zeros(train.joint_owner.size),
        head=np.zeros((strips, wires, train.z.shape[2])),
        head_compliance=np.zeros((strips, wires)),
        response=align(np.zeros((strips, wires, 2, width))),
        start=np.zeros(strips, dtype=np.int64),
        wire_compliance=np.zeros((strips, strips, wires)),
        wire_acceleration=wire_acceleration,
        first_guess=first_guess,
        near=np.zeros((strips, wires, near), dtype=np.int64),
        influence=np.zeros((strips, wires, near)),
        number_near=np.zeros((strips, wires), dtype=np.int64),
    )
