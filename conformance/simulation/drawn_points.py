"""Points and shapes of a line at rest, for its drawings."""

from typing import get_args

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.line.elements.element import DrawnConnection, DrawnMark, Symbol
from pantocheck.conformance.line.elements.element_registry import ELEMENTS
from pantocheck.model import Catenary, DiscretisedLine


def find_deflection(line: DiscretisedLine, wire: str, field: str, position: RealArray | float) -> RealArray:
    """Height (`z`) or lateral position (`y`) of a wire at rest.

    Args:
        line: Line at rest.
        wire: Name of the wire.
        field: `z` or `y`.
        position: Positions along the line [m].

    Returns:
        Deflection at every position [m].
    """
    row = line.mesh.row_of[wire, field]
    return np.asarray(np.interp(np.asarray(position), line.mesh.position, line.state.deflection[row, :, 0]))


def list_element_marks(catenary: Catenary) -> list[DrawnMark]:
    """Points of all elements of a line, by their kinds in the order of `Symbol`."""
    order = get_args(Symbol)
    marks = [mark for element in ELEMENTS for mark in element.mark(catenary)]
    return sorted(marks, key=lambda mark: order.index(mark.symbol))


def list_connections(catenary: Catenary) -> list[DrawnConnection]:
    """Lines between two wires of all elements of a line."""
    return [connection for element in ELEMENTS for connection in element.connect(catenary)]
