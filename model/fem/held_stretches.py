"""Held stretches: a wire that is held along the track at both ends of a stretch changes its tension.

        o-.  rest, slope z0'   .-o held     A displacement w across the wire elongates a stretch of length L by the
           `-._             .-'             integral of z0' w', so that its tension changes by
      held      `--.___.--'   | w
                              v                 h = EA / L * a'q,    a'q = integral of z0' w' dx,    force -a h

This is the linear theory of the shallow cable (Irvine and Caughey, Proc. R. Soc. London A 341, 1974), for motions well
below the lowest axial frequency of a stretch. It adds a stiffness of rank one per stretch, EA / L a a'; the stagger at
rest counts like z0. The elongation has no damping. A stitch wire is not part of the stretch.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.catenary import Catenary, Termination, Wire
from pantocheck.model.fem import beam
from pantocheck.model.fem.mesh import Mesh


class HeldStretches(NamedTuple):
    """Held stretches of all wires; K stretches with at most W stations, F fields."""

    first: Indices
    """First station, (K,)."""
    row: Indices
    """Rows of the wire in every field, (K, F)."""
    stiffness: Array
    """Additional tension per elongation, EA over length, (K,) [N/m]."""
    coefficient: Array
    """Elongation per deflection and slope at the stations from `first` on, the vector a, (K, F, W, 2); zero after
    the last [-, m].
    """


def build_held_stretches(catenary: Catenary, mesh: Mesh, deflection: Array) -> HeldStretches:
    """Build the stretches of all wires between the points that hold them along the track: fixed supports and anchors.

    Between a tensioning weight and the next such point the tension is constant.

    Args:
        catenary: Description of the line.
        mesh: Stations and rows.
        deflection: Line at rest, (rows, stations, 2).

    Raises:
        ValueError: A held wire has no axial stiffness.
    """
    fields = dict.fromkeys(mesh.row_field)
    stretches = [(wire, *ends) for wire in catenary.wires for ends in pairwise(_held_stations(catenary, mesh, wire))]
    widest = max((last - first + 1 for _, first, last in stretches), default=0)
    row = np.array([[mesh.row_of[wire.name, field] for field in fields] for wire, _, _ in stretches], dtype=np.int64)
    coefficient = np.zeros((len(stretches), len(fields), widest, 2))
    for n, (_, first, last) in enumerate(stretches):
        stations = slice(first, last + 1)
        coefficient[n, :, : last + 1 - first] = _elongation(mesh.position[stations], deflection[row[n], stations])
    lengths = [mesh.position[last] - mesh.position[first] for _, first, last in stretches]
    return HeldStretches(
        first=np.array([first for _, first, _ in stretches], dtype=np.int64),
        row=row.reshape(-1, len(fields)),
        stiffness=np.array([_axial_stiffness(s[0]) / length for s, length in zip(stretches, lengths, strict=True)]),
        coefficient=coefficient,
    )


def _held_stations(catenary: Catenary, mesh: Mesh, wire: Wire) -> list[int]:
    """Stations at which a wire is held along the track, in order; none without a fixed support."""
    supports = [s for s in catenary.messenger_supports if s.wire == wire.name and s.along_track == "fixed"]
    terminations = wire.terminations or ((Termination.ANCHOR if supports else Termination.WEIGHT),) * 2
    anchors = [x for x, end in zip((wire.start, wire.end), terminations, strict=True) if end is Termination.ANCHOR]
    return sorted({mesh.station(place) for place in (*anchors, *(support.position for support in supports))})


def _axial_stiffness(wire: Wire) -> float:
    if wire.axial_stiffness is None:
        raise ValueError(
            f"wire {wire.name!r} is fixed along the track at a support, but its axial stiffness is not given;"
            " give Wire.axial_stiffness, or along_track 'free' at all its supports"
        )
    return wire.axial_stiffness


def _elongation(position: Array, shape: Array) -> Array:
    """Integral of z0' N' over stations (n,) with shape functions N, for the shapes (fields, n, 2) at rest."""
    length = np.diff(position)
    ends = np.concatenate([shape[:, :-1], shape[:, 1:]], axis=-1)
    forces = np.einsum("eij,fej->fei", beam.stiffness(length, np.ones_like(length), np.zeros_like(length)), ends)
    elongation = np.zeros_like(shape)
    elongation[:, :-1] += forces[..., :2]
    elongation[:, 1:] += forces[..., 2:]
    return elongation
