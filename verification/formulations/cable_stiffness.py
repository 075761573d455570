"""Cable stiffness of a wire that hangs in spans: Irvine's linear change of tension, for docs/exact-model.md.

A small displacement u along the track and w across it lengthens a wire with the initial slope z0' by u' + z0' w'. With
the wire held along the track at both ends of a span of length L, its tension changes by

    h = EA / L * integral of z0' w' dx

and acts on the wire along its initial slope: a stiffness of rank one per span, EA / L a a' with a'w the integral.
"""

from itertools import pairwise
from typing import Literal

import numpy as np

from verification.formulations.exact_forces import string_elongations
from verification.formulations.exact_line import Array, ExactLine, Indices, Strings

TensionLaw = Literal[
    "constant", "per span", "per section", "per span, second order", "axial field held at supports", "axial field free"
]
"""Tension of the messenger wire with small slopes: constant; changed by the elongation of each span, or of the whole
wire; by the elongation of each span with its second-order part w'^2 / 2; or by that of each segment, with the motion
along the track and its inertia."""


def linearise_wire(line: ExactLine, position: Array, wire: int, supports: Array, law: TensionLaw) -> ExactLine:
    """Replace a wire of an exact line by one with small slopes.

    Args:
        line: Exact line.
        position: Positions at rest, about which the wire is linearised, (3, N) [m].
        wire: Number of the wire.
        supports: Points of the wire that are held along the track, (S,) int.
        law: Change of tension.

    Returns:
        Line with the linear wire.
    """
    wires = line.wires
    first, last, h = wires.first[wire], wires.last[wire], wires.spacing[wire]
    point = np.arange(first, last)
    segment = position[:, point + 1] - position[:, point]
    across = np.array([[0.0], [1.0], [1.0]])
    group = _groups(point, supports, law)
    length = np.bincount(group) * h
    stiffness = np.zeros_like(length) if law == "constant" else wires.axial_stiffness[wire] / length
    # With the whole second-order part the linear one is the elongation along the track alone.
    quadratic = across if law.endswith("second order") else np.zeros_like(across)
    strings = Strings(
        point=point,
        stiffness=wires.tension[wire] / h * across * np.ones(point.size),
        slope=np.ascontiguousarray((1 - quadratic) * segment / segment[0]),
        curvature=quadratic / h * np.ones(point.size),
        group=group,
        group_stiffness=stiffness,
        group_length=np.zeros_like(length),
    )
    strings = strings._replace(group_length=string_elongations(strings, position))
    free = line.free.copy()
    free[0, first : last + 1] = 0.0
    if law.startswith("axial field"):
        free[0, first + 1 : last] = 1.0
    if law == "axial field held at supports":
        free[0, supports] = 0.0
    axial_stiffness = wires.axial_stiffness.copy()
    axial_stiffness[wire] = 0.0
    return line._replace(free=free, wires=wires._replace(axial_stiffness=axial_stiffness), strings=strings)


def _groups(point: Indices, supports: Array, law: TensionLaw) -> Indices:
    """Group of every segment: each its own, that of its span, or one for all."""
    if law.startswith("axial field"):
        return np.arange(point.size)
    if law.startswith("per span"):
        return np.searchsorted(supports, point, side="right").astype(np.int64)
    return np.zeros_like(point)


def irvine_parameter(line: ExactLine, position: Array, wire: int, limits: Array) -> Array:
    """Irvine's parameter of every stretch of a wire between two points: 12 EA / T times the mean of z0'^2.

    For a parabola under the weight q per length it is (q L / T)^2 EA / T [-].
    """
    slope = np.diff(position[2]) / line.wires.spacing[wire]
    stretches = [12 * np.mean(slope[start:end] ** 2) for start, end in pairwise(limits)]
    return np.array(stretches) * line.wires.axial_stiffness[wire] / line.wires.tension[wire]
