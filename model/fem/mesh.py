"""Mesh: stations along the line, and rows of unknowns.

A row is one field (vertical z or lateral y) of wires of one kind that do not overlap: all stitch wires share a row, two
contact wires need two. In a row every station has a deflection w and a slope r. Only connectors couple the rows, so
that each row is a separate tensioned beam.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.catenary import Catenary, Kind, Wire


@dataclass(frozen=True)
class Mesh:
    """Stations and rows."""

    position: Array
    """Position along the track, (stations,) [m]."""
    row_kind: tuple[Kind, ...]
    """Kind of the wires of each row."""
    row_field: tuple[str, ...]
    """Field of each row, "z" or "y"."""
    row_of: dict[tuple[str, str], int]
    """Row by wire name and field."""

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.row_kind)

    @cached_property
    def _station_at(self) -> dict[float, int]:
        """Station of every position; connectors have the position of their station but for the last digits."""
        return {position: station for station, position in enumerate(self.position.tolist())}

    def station(self, position: float) -> int:
        """Index of the station at the position of a connector or another requested station [m]."""
        if position in self._station_at:
            return self._station_at[position]
        after = min(max(int(np.searchsorted(self.position, position)), 1), self.position.size - 1)
        nearest = after if self.position[after] - position < position - self.position[after - 1] else after - 1
        if abs(self.position[nearest] - position) > 1e-6:
            raise KeyError(f"the mesh has no station at {position} m; the nearest is at {self.position[nearest]} m")
        return nearest


def find_element(stations: Array, position: float) -> tuple[int, float, float]:
    """Index and length [m] of the element at a position [m], and the position within it as a share of its length."""
    element = min(max(int(np.searchsorted(stations, position)) - 1, 0), stations.size - 2)
    length = stations[element + 1] - stations[element]
    return element, length, (position - stations[element]) / length


def find_elements(stations: Array, position: Array) -> tuple[Indices, Array, Array]:
    """As `find_element`, for many positions, (n,) each."""
    element = np.clip(np.searchsorted(stations, position) - 1, 0, stations.size - 2)
    length = stations[element + 1] - stations[element]
    return element, length, (position - stations[element]) / length


def build_mesh(catenary: Catenary, element_length: float, places: tuple[float, ...] = ()) -> Mesh:
    """Place stations at all connectors and divide the wires between them into elements.

    Args:
        catenary: Description of the line.
        element_length: Largest length of an element [m].
        places: Positions of additional stations [m].

    Returns:
        Stations and rows.
    """
    fields = ("z", "y") if catenary.has_lateral_field else ("z",)
    rows: list[list[Wire]] = []
    for wire in catenary.wires:
        for row in rows:
            if row[0].kind is wire.kind and all(wire.end < other.start or other.end < wire.start for other in row):
                row.append(wire)
                break
        else:
            rows.append([wire])
    row_of = {
        (wire.name, name): index + len(rows) * shift
        for shift, name in enumerate(fields)
        for index, row in enumerate(rows)
        for wire in row
    }
    return Mesh(
        position=_stations(_breakpoints(catenary, places), element_length),
        row_kind=tuple(row[0].kind for row in rows) * len(fields),
        row_field=tuple(name for name in fields for _ in rows),
        row_of=row_of,
    )


def _breakpoints(catenary: Catenary, requested: tuple[float, ...]) -> Array:
    """Positions of connectors, masses, anchors, changes of a wire and requested stations, each once."""
    places = [*requested, *(place for wire in catenary.wires for place in (wire.start, wire.end))]
    for wire in catenary.wires:
        places += [place for change in wire.tension_changes for place in (change.start, change.end)]
        places += [place for change in wire.section_changes for place in (change.start, change.end)]
    places += [dropper.position for dropper in catenary.droppers] + [arm.position for arm in catenary.steady_arms]
    places += [support.position for support in catenary.messenger_supports]
    places += [clamp.position for clamp in catenary.clamps] + [mass.position for mass in catenary.point_masses]
    places += [spring.position for spring in catenary.springs]
    for curve in catenary.curves:
        transitions = (curve.start + curve.transition, curve.end - curve.transition)
        places += [place for place in (curve.start, *transitions, curve.end) if min(places) < place < max(places)]
    ordered = np.unique(np.array(places))
    # Equal positions from different sums differ in the last bits; an element of that length spoils the conditioning.
    kept: Array = ordered[np.append(True, np.diff(ordered) > 1e-6)]
    return kept


def _stations(breakpoints: Array, element_length: float) -> Array:
    """Equidistant stations between neighbouring breakpoints, and the breakpoints."""
    stations = [
        np.linspace(start, end, max(1, int(np.ceil((end - start) / element_length - 1e-9))), endpoint=False)
        for start, end in pairwise(breakpoints)
    ]
    return np.concatenate([*stations, breakpoints[-1:]])
