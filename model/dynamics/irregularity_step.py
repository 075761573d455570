"""Irregularity of the contact wires in a time step: height of a cubic spline at the position of a head."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.catenary import Wire
from pantocheck.model.dynamics.kernel_compilation import kernel
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.irregularity_spline import NO_IRREGULARITY, spline_polynomials

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
