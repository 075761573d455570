"""Contact wires above a point of the track: several in an overlap of sections, one or two parallel wires elsewhere."""

from typing import NamedTuple

import numpy as np

from pantocheck.model.description.arrays import Indices
from pantocheck.model.description.failures import ImpossiblePassage
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.fem import beam
from pantocheck.model.fem.mesh import find_element


class ContactWires(NamedTuple):
    """Rows and extents of W contact wires, in the order of the line."""

    row: Indices
    first: Indices
    last: Indices
    """Row, first and last station of each wire, (W,)."""


def locate_contact_wires(line: DiscretisedLine) -> ContactWires:
    """Locate the contact wires of a line on its mesh."""
    mesh, wires = line.mesh, line.catenary.contact_wires
    places = [(mesh.row_of[wire.name, "z"], mesh.station(wire.start), mesh.station(wire.end)) for wire in wires]
    return ContactWires(*np.array(places, dtype=np.int64).reshape(-1, 3).T.copy())


def touched_wires(line: DiscretisedLine, position: float) -> Indices:
    """Indices of the contact wires that a head at rest touches at a position: the lowest one and those parallel to it.

    Parallel wires have the same ends; they share a static force equally. A wire of the other section in an overlap does
    not count, although a large force may lift the lowest wire up to it.

    Args:
        line: Discretised line.
        position: Position along the track [m].

    Returns:
        Indices in the order of the line, at least one, (n,).

    Raises:
        ImpossiblePassage: There is no contact wire at the position.
    """
    wires = locate_contact_wires(line)
    element, length, s = find_element(line.mesh.position, position)
    above = np.flatnonzero((wires.first <= element) & (element < wires.last))
    if above.size == 0:
        raise ImpossiblePassage(f"there is no contact wire at {position:g} m, where a pantograph needs one")
    height = line.state.deflection[wires.row[above], element : element + 2].reshape(-1, 4) @ beam.shape(s, length)
    lowest = above[height.argmin()]
    parallel = (wires.first == wires.first[lowest]) & (wires.last == wires.last[lowest])
    return np.flatnonzero(parallel)


def touched_rows(line: DiscretisedLine, position: float) -> Indices:
    """Rows of the contact wires that a head at rest touches at a position, as in `touched_wires`."""
    return locate_contact_wires(line).row[touched_wires(line, position)]
