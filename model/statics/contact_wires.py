"""Contact wires above a point of the track: several in an overlap of sections, one or two parallel wires elsewhere."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.failures import ImpossiblePassage
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, keep_with_line
from pantocheck.model.fem import beam
from pantocheck.model.fem.mesh import find_elements


class ContactWires(NamedTuple):
    """Rows and extents of W contact wires, in the order of the line."""

    row: Indices
    first: Indices
    last: Indices
    """Row, first and last station of each wire, (W,)."""


@keep_with_line
def locate_contact_wires(line: DiscretisedLine) -> ContactWires:
    """Locate the contact wires of a line on its mesh."""
    mesh, wires = line.mesh, line.catenary.contact_wires
    places = [(mesh.row_of[wire.name, "z"], mesh.station(wire.start), mesh.station(wire.end)) for wire in wires]
    return ContactWires(*np.array(places, dtype=np.int64).reshape(-1, 3).T.copy())


def mark_touched_wires(line: DiscretisedLine, position: Array) -> NDArray[np.bool_]:
    """Mark the contact wires that a head at rest touches at positions: the lowest one and those parallel to it.

    Parallel wires have the same ends; they share a static force equally. A wire of the other section in an overlap does
    not count, although a large force may lift the lowest wire up to it.

    Args:
        line: Discretised line.
        position: Positions along the track, (n,) [m].

    Returns:
        Marks in the order of the line, at least one for each position, (n, W).

    Raises:
        ImpossiblePassage: There is no contact wire at a position.
    """
    wires = locate_contact_wires(line)
    element = find_elements(line.mesh.position, position)[0][:, None]
    above = (wires.first <= element) & (element < wires.last)
    if not above.any(axis=1).all():
        missing = position[~above.any(axis=1)][0]
        raise ImpossiblePassage(f"there is no contact wire at {missing:g} m, where a pantograph needs one")
    lowest = np.where(above, wire_heights(line, position), np.inf).argmin(axis=1)[:, None]
    return np.asarray((wires.first == wires.first[lowest]) & (wires.last == wires.last[lowest]))


def wire_heights(line: DiscretisedLine, position: Array) -> Array:
    """Heights of the rows of all contact wires at rest, (n, W) [m]; positions along the track, (n,) [m]."""
    element, length, s = find_elements(line.mesh.position, position)
    ends = line.state.deflection[:, element[:, None] + np.arange(2)].reshape(line.mesh.rows, position.size, 4)
    return np.asarray(np.einsum("wni,in->nw", ends[locate_contact_wires(line).row], beam.shape(s, length)))


def touched_wires(line: DiscretisedLine, position: float) -> Indices:
    """Indices of the contact wires that a head at rest touches at a position [m], as in `mark_touched_wires`, (m,)."""
    return np.flatnonzero(mark_touched_wires(line, np.array([position]))[0])


def touched_rows(line: DiscretisedLine, position: float) -> Indices:
    """Rows of the contact wires that a head at rest touches at a position, as in `touched_wires`."""
    return locate_contact_wires(line).row[touched_wires(line, position)]
