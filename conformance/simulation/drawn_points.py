"""Points and shapes of a line at rest, for its drawings."""

from collections.abc import Iterator
from typing import Literal

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.model import Catenary, DiscretisedLine, Kind

FixedSymbol = Literal["anchor", "messenger support", "steady arm"]
"""Part that is drawn as a point on a wire."""


def find_deflection(line: DiscretisedLine, wire: str, field: str, position: RealArray | float) -> RealArray:
    """Height (`z`) or lateral position (`y`) of a wire at rest.

    Parameters
    ----------
    line : DiscretisedLine
        Line at rest.
    wire : str
        Name of the wire.
    field : str
        `z` or `y`.
    position : ndarray or float
        Positions along the line [m].

    Returns
    -------
    ndarray
        Deflection at every position [m].
    """
    row = line.mesh.row_of[wire, field]
    return np.asarray(np.interp(np.asarray(position), line.mesh.position, line.state.deflection[row, :, 0]))


def list_fixed_points(catenary: Catenary) -> Iterator[tuple[FixedSymbol, str, float]]:
    """Symbol, wire and position of every anchor, messenger support and steady arm."""
    for wire in catenary.wires:
        if wire.kind is not Kind.STITCH_WIRE:
            yield from (("anchor", wire.name, end) for end in (wire.start, wire.end))
    yield from (("messenger support", support.wire, support.position) for support in catenary.messenger_supports)
    yield from (("steady arm", arm.wire, arm.position) for arm in catenary.steady_arms)
