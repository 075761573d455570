"""Arrays of the time step of the second formulation: the line and the pantographs."""

from typing import NamedTuple

from verification.formulations.difference_strands import Floats, Indices


class Lines(NamedTuple):
    """Arrays of the line; G strands, N points in all, B bars, R stretches of another tension, C clamps, A arms."""

    step: float
    """Time step [s]."""
    first: Indices
    count: Indices
    """First point and number of points of every strand, (G,)."""
    start: Floats
    spacing: float
    """Position of the first point and spacing of the points, (G,) [m]."""
    string: Floats
    bending: Floats
    """T / h and B / h^3 of every strand, (G,) [N/m]."""
    delay: Floats
    """Stiffness-proportional damping coefficient of every strand, (G,) [s]."""
    strand_keep: Floats
    strand_gain: Floats
    """v = keep v + gain f at the inner points of every strand, (G,) [-, s/kg]."""
    keep: Floats
    gain: Floats
    """v = keep v + gain f, with the lumped mass and the centred damping of every point, (N,) [-, s/kg]."""
    special: Indices
    """Points with other values than the inner points of their strand, (S,)."""
    special_strand: Indices
    """Their strands, (S,)."""
    bar_first: Indices
    bar_point: Indices
    bar_coefficient: Floats
    """Points and coefficients of bar b: bar_first[b] ... bar_first[b + 1] - 1."""
    bar_position: Floats
    bar_stiffness: Floats
    bar_damping: Floats
    bar_preload: Floats
    """Properties of the bars, (B,); the preload of a bar that acts in both directions is huge [m, N/m, N s/m, N]."""
    relief: Indices
    """First and last point of stretches with another tension, (R, 2)."""
    relief_string: Floats
    """Change of the tension over the spacing, (R,) [N/m]."""
    tie: Indices
    """Point of the messenger, end point of the stitch wire, and its inward neighbour's direction, +1 or -1, (C, 3)."""
    tie_strand: Indices
    """Strand of the stitch wire, (C,)."""
    arm: Indices
    """Lateral and vertical point of every arm, (A, 2)."""
    arm_direction: Floats
    """Direction of every arm (y, z), (A, 2) [-]."""
    contact: int
    """Number of the vertical strand of the contact wire."""
    excess: Floats
    """Excess flexibility of the contact wire, see `difference_strands.excess_flexibility`, (4,) [m/N]."""
    rest: Floats
    """Shape at rest, (N,) [m]."""


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
