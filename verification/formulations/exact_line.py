"""Arrays of the geometrically exact model: a line as mass points in space, joined by elastic wires, bars and springs.

      o---o---o---o---o---o    messenger wire: mass points, elastic segments, bending
          |       |            droppers: bars that carry tension only
      o---o---o---o---o---o    contact wire
                       `---x   steady arm: bar to a hinge, a mass point that is held

Nothing is linearised: every force acts along the current direction of its segment or bar. Positions, velocities and
forces are arrays (3, N) of the components x, y, z of N points.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class Wires(NamedTuple):
    """Wires as chains of mass points; W wires.

    Parameters
    ----------
    first, last : (W,) int ndarray
        Mass points at the ends; the points of a wire are consecutive.
    axial_stiffness, bending_stiffness : (W,) ndarray
        EA [N] and EI [N m2].
    tension : (W,) ndarray
        Tension at rest, which scales the stiffness-proportional damping [N].
    spacing : (W,) ndarray
        Distance of neighbouring points along the track at rest [m].
    stiffness_coefficient : (W,) ndarray
        Stiffness-proportional damping [s].
    """

    first: Indices
    last: Indices
    axial_stiffness: Array
    bending_stiffness: Array
    tension: Array
    spacing: Array
    stiffness_coefficient: Array


class Bars(NamedTuple):
    """Massless bars between two points; B bars.

    Parameters
    ----------
    ends : (B, 2) int ndarray
        Mass points at both ends.
    stiffness, length : (B,) ndarray
        Axial stiffness [N/m] and unstretched length [m].
    axial_damping, rotational_damping : (B,) ndarray
        Damping along the bar, and across it [N s/m].
    unilateral : (B,) ndarray
        Whether the bar carries tension only.
    """

    ends: Indices
    stiffness: Array
    length: Array
    axial_damping: Array
    rotational_damping: Array
    unilateral: NDArray[np.bool_]


class Springs(NamedTuple):
    """Springs and dampers from a point to the ground, one per direction; S springs.

    Parameters
    ----------
    point : (S,) int ndarray
        Mass points.
    stiffness, damping : (3, S) ndarray
        Coefficients in x, y and z [N/m, N s/m].
    anchor : (3, S) ndarray
        Position without force [m].
    """

    point: Indices
    stiffness: Array
    damping: Array
    anchor: Array


class Strings(NamedTuple):
    """Wires with small slopes, as in the theory of the shallow cable; n segments in G groups with one tension each.

    The tension of a group changes with the elongation of its segments: a segment with the extent (dx, dy, dz) elongates
    by the sum of slope times extent and curvature times half the square of the extent.

    Parameters
    ----------
    point : (n,) int ndarray
        First point of each segment; the second is the next one.
    stiffness : (3, n) ndarray
        Constant tension over spacing, across the track [N/m].
    slope : (3, n) ndarray
        Linear coefficient of the elongation [-].
    curvature : (3, n) ndarray
        Quadratic coefficient of the elongation [1/m].
    group : (n,) int ndarray
        Group of each segment.
    group_stiffness, group_length : (G,) ndarray
        EA over length [N/m], and the sum of the elongations at rest [m].
    """

    point: Indices
    stiffness: Array
    slope: Array
    curvature: Array
    group: Indices
    group_stiffness: Array
    group_length: Array


class ExactLine(NamedTuple):
    """Line of N mass points.

    Parameters
    ----------
    mass : (N,) ndarray
        Mass of each point [kg].
    drag : (N,) ndarray
        Mass-proportional damping of each point [N s/m].
    free : (3, N) ndarray
        One where a point can move, zero where it is held.
    unstretched : (N,) ndarray
        Unstretched length of the segment between each point and the next of its wire [m].
    gravity : float
        Acceleration of gravity [m/s2].
    wires, bars, springs, strings : Wires, Bars, Springs, Strings
        Parts of the line; a wire whose tension is that of a string has no axial stiffness itself.
    """

    mass: Array
    drag: Array
    free: Array
    unstretched: Array
    gravity: float
    wires: Wires
    bars: Bars
    springs: Springs
    strings: Strings


def no_bars() -> Bars:
    """Bars of a line without bars."""
    nothing = np.zeros(0)
    return Bars(np.zeros((0, 2), dtype=np.int64), nothing, nothing, nothing, nothing, np.zeros(0, dtype=np.bool_))


def no_springs() -> Springs:
    """Springs of a line without springs."""
    nothing = np.zeros((3, 0))
    return Springs(np.zeros(0, dtype=np.int64), nothing, nothing, nothing)


def no_strings() -> Strings:
    """Strings of a line whose wires are all exact."""
    none, nothing = np.zeros(0, dtype=np.int64), np.zeros(0)
    return Strings(none, *(np.zeros((3, 0)) for _ in range(3)), none, nothing, nothing)


def unstretched_lengths(position: Array, wires: Wires) -> Array:
    """Unstretched length of every segment whose tension has the component T along the track [m].

    With this component the same in every segment, the points of a wire are in equilibrium along the track.
    """
    unstretched = np.ones(position.shape[1])
    for first, last, axial_stiffness, tension in zip(
        wires.first, wires.last, wires.axial_stiffness, wires.tension, strict=True
    ):
        segment = np.diff(position[:, first : last + 1])
        length = np.linalg.norm(segment, axis=0)
        strain = tension * length / segment[0] / axial_stiffness
        unstretched[first:last] = length / (1 + strain)
    return unstretched
