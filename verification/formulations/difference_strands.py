"""Strands of the second formulation: every wire in every direction as points of one vector, with forces between them.

Points lie h apart. The elastic energy of a strand with tension T and bending stiffness EI is

    T/2 sum (w[i+1] - w[i])^2 / h  +  B/2 sum (w[i+1] - 2 w[i] + w[i-1])^2 / h^3,    B = EI + T h^2 / 12

The second sum runs over the inner points, so that the ends carry no moment. The term T h^2 / 12 removes the leading
error of the second difference: the string part is of fourth order.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Weights = tuple[Indices, Floats]


@dataclass(frozen=True)
class Wire:
    """Tensioned wire between two ends [m], with T [N], EI [N m2], mass [kg/m] and Rayleigh coefficients [1/s, s].

    `relief` lists stretches (start, end, change of the tension) [m, m, N].
    """

    name: str
    start: float
    end: float
    tension: float
    bending_stiffness: float
    mass_per_length: float
    mass_coefficient: float = 0.0
    stiffness_coefficient: float = 0.0
    relief: tuple[tuple[float, float, float], ...] = ()


@dataclass(frozen=True)
class Strand:
    """One direction (y or z) of a wire: points first ... first + count - 1 of the vector, `spacing` h apart [m]."""

    wire: Wire
    first: int
    count: int
    spacing: float

    @property
    def bending_stiffness(self) -> float:
        """Bending stiffness B of the scheme [N m2]."""
        return self.wire.bending_stiffness + self.wire.tension * self.spacing**2 / 12

    def point(self, x: float) -> int:
        """Point at a position, which must lie on the grid [m]."""
        i = round((x - self.wire.start) / self.spacing)
        if abs(self.wire.start + i * self.spacing - x) > 1e-6:
            raise ValueError(f"{self.wire.name}: {x:g} m lies between two points {self.spacing:g} m apart")
        return self.first + i

    def weights(self, x: float) -> Weights:
        """Points and weights that interpolate at a position [m]; the same weights distribute a point force."""
        s = (x - self.wire.start) / self.spacing
        i = int(np.floor(s + 1e-9))
        if abs(s - round(s)) < 1e-6:
            return np.array([self.first + round(s)]), np.ones(1)
        return self.first + i + np.arange(-1, 3), interpolation(s - i)

    @property
    def excess(self) -> Floats:
        """Flexibility of the points minus that of the beam, for points 0, 1, 2, 3 apart; see `excess_flexibility`."""
        return excess_flexibility(self.wire.tension, self.wire.bending_stiffness, self.bending_stiffness, self.spacing)

    def excess_at(self, x: float) -> float:
        """Excess flexibility under a point force at a position [m/N]."""
        points, weights = self.weights(x)
        return float(weights @ self.excess[np.abs(points[:, None] - points)] @ weights)

    def stiffness(self, size: int) -> sp.csc_array:
        """Stiffness matrix, the second derivative of the energy, with `size` unknowns [N/m]."""
        n, h = self.count, self.spacing
        slope = sp.diags_array([-np.ones(n - 1), np.ones(n - 1)], offsets=[0, 1], shape=(n - 1, n))
        ones = np.ones(n - 2)
        curvature = sp.diags_array([ones, -2 * ones, ones], offsets=[0, 1, 2], shape=(n - 2, n))
        tension = np.full(n - 1, self.wire.tension)
        for start, end, change in self.wire.relief:
            tension[self.point(start) - self.first : self.point(end) - self.first] += change
        matrix = slope.T @ sp.diags_array(tension / h) @ slope
        matrix += self.bending_stiffness / h**3 * (curvature.T @ curvature)
        place = sp.csc_array((np.ones(n), (self.first + np.arange(n), np.arange(n))), shape=(size, n))
        return sp.csc_array(place @ matrix @ place.T)

    def weight(self, gravity: float) -> Floats:
        """Weight of every point [N]; an end has half of it."""
        load = np.full(self.count, -gravity * self.wire.mass_per_length * self.spacing)
        load[[0, -1]] /= 2
        return load


Strands = dict[tuple[str, str], Strand]
"""Strands by name of the wire and direction."""


def interpolation(s: float) -> Floats:
    """Catmull-Rom weights of the points -1, 0, 1 and 2 at s spacings from point 0, 0 <= s <= 1."""
    return 0.5 * np.array([-s + 2 * s**2 - s**3, 2 - 5 * s**2 + 3 * s**3, s + 4 * s**2 - 3 * s**3, -(s**2) + s**3])


def excess_flexibility(tension: float, bending_stiffness: float, scheme_stiffness: float, spacing: float) -> Floats:
    """Local flexibility of the points under a point force minus that of the beam [m/N].

    Below a point force F, a long beam lies F l / (2 T) below a string, with l = sqrt(EI / T). Points with the stiffness
    B lie h F r^n / (T sqrt(a^2 + 4 a)) below it, n points away, with a = T h^2 / B and r + 1/r = 2 + a; the string
    itself adds h F n / (2 T). Both are the decaying solutions of the equation and of its difference equation.

    Args:
        tension, bending_stiffness, scheme_stiffness, spacing: T [N], EI [N m2], B [N m2] and h [m].

    Returns:
        Excess for displacement and force 0, 1, 2 and 3 points apart, (4,) [m/N].
    """
    a = tension * spacing**2 / scheme_stiffness
    root = np.sqrt(a**2 + 4 * a)
    decay, n = 1 + (a - root) / 2, np.arange(4)
    beam = np.sqrt(bending_stiffness / tension) / (2 * tension)
    return np.asarray(beam - spacing / tension * (n / 2 + decay**n / root))


def lay_out(wires: Sequence[Wire], axes: str, spacing: float) -> Strands:
    """Strands of all wires in all directions, by name of the wire and direction, one after another in one vector."""
    strands: Strands = {}
    first = 0
    for axis in axes:
        for wire in wires:
            count = round((wire.end - wire.start) / spacing) + 1
            if abs((count - 1) * spacing - (wire.end - wire.start)) > 1e-6:
                raise ValueError(f"{wire.name}: its length is not a multiple of {spacing:g} m")
            strands[wire.name, axis] = Strand(wire, first, count, spacing)
            first += count
    return strands


def size(strands: Strands) -> int:
    """Number of unknowns of all strands."""
    return sum(strand.count for strand in strands.values())
