"""Arrays of the time step of the second formulation: the line and the pantographs."""

from typing import NamedTuple

from verification.formulations.difference_strands import Floats, Indices


class Lines(NamedTuple):
    """Arrays of the line; G strands, N points in all, B bars, R stretches of another tension, C clamps, A arms.

    Parameters
    ----------
    step : float
        Time step [s].
    first, count : (G,) int ndarray
        First point and number of points of every strand.
    start, spacing : (G,) ndarray
        Position of the first point and spacing of the points [m].
    string, bending : (G,) ndarray
        T / h and B / h^3 of every strand [N/m].
    delay : (G,) ndarray
        Stiffness-proportional damping coefficient of every strand [s].
    strand_keep, strand_gain : (G,) ndarray
        v = keep v + gain f at the inner points of every strand [-, s/kg].
    keep, gain : (N,) ndarray
        v = keep v + gain f, with the lumped mass and the centred damping of every point [-, s/kg].
    special : (S,) int ndarray
        Points with other values than the inner points of their strand.
    special_strand : (S,) int ndarray
        Their strands.
    bar_first, bar_point, bar_coefficient : ndarrays
        Points and coefficients of bar b: bar_first[b] ... bar_first[b + 1] - 1.
    bar_position, bar_stiffness, bar_damping, bar_preload : (B,) ndarray
        Properties of the bars; the preload of a bar that acts in both directions is huge [m, N/m, N s/m, N].
    relief : (R, 2) int ndarray
        First and last point of stretches with another tension.
    relief_string : (R,) ndarray
        Change of the tension over the spacing [N/m].
    tie : (C, 3) int ndarray
        Point of the messenger, end point of the stitch wire, and its inward neighbour's direction, +1 or -1.
    tie_strand : (C,) int ndarray
        Strand of the stitch wire.
    arm : (A, 2) int ndarray
        Lateral and vertical point of every arm.
    arm_direction : (A, 2) ndarray
        Direction of every arm (y, z) [-].
    contact : int
        Number of the vertical strand of the contact wire.
    excess : (4,) ndarray
        Excess flexibility of the contact wire, see `difference_strands.excess_flexibility` [m/N].
    rest : (N,) ndarray
        Shape at rest [m].
    """

    step: float
    first: Indices
    count: Indices
    start: Floats
    spacing: float
    string: Floats
    bending: Floats
    delay: Floats
    strand_keep: Floats
    strand_gain: Floats
    keep: Floats
    gain: Floats
    special: Indices
    special_strand: Indices
    bar_first: Indices
    bar_point: Indices
    bar_coefficient: Floats
    bar_position: Floats
    bar_stiffness: Floats
    bar_damping: Floats
    bar_preload: Floats
    relief: Indices
    relief_string: Floats
    tie: Indices
    tie_strand: Indices
    arm: Indices
    arm_direction: Floats
    contact: int
    excess: Floats
    rest: Floats


class Heads(NamedTuple):
    """Pantographs of a train; P pantographs, n masses from base to head. Every array is (P, n) or (P,)."""

    position: Floats
    speed: float
    mass: Floats
    stiffness: Floats
    damping: Floats
    unstretched: Floats
    uplift: Floats
    contact_stiffness: float
    height: Floats
    velocity: Floats
