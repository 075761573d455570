"""Known places of a track from tables of assets: supports, tension sections, overlaps and others, by kilometre."""

from collections.abc import Sequence
from pathlib import Path
from typing import get_args

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.spreadsheet import read_spreadsheet
from pantocheck.conformance.line.line_columns import POSITION, SUPPORT_COLUMNS, TypedRow, read_typed_rows
from pantocheck.conformance.records.sidecar_tables import EventKind
from pantocheck.conformance.results.network_format import KnownPlace, TrackSection

TENSION_SECTION = "tension_section"

PLACE_KINDS = (*get_args(EventKind), TENSION_SECTION)
"""Kinds of places; a row without a kind is a support."""

LATITUDE, LONGITUDE = "latitude_deg", "longitude_deg"

PLACE_COLUMNS = ("line", "track", "kind", "from_m", "to_m", LATITUDE, LONGITUDE, *SUPPORT_COLUMNS)
"""Columns of a table of assets: those of a table of supports, the ends of a stretch, and coordinates (WGS 84)."""

EXPLAINING = frozenset({"overlap", "section_insulator", "neutral_section", "switch"})
"""Kinds of places at which a deviation of the force is expected."""

NEAR_KM = 0.04
"""Largest distance of a place by whose name a deviation is called [km]: more than half a span."""


def read_places(path: Path, line: str | None, track: str | None) -> list[KnownPlace]:
    """Read a table of assets; positions are kilometres of the line (`x_km`, `from_km`, `to_km`, or metres).

    Args:
        path: The table.
        line, track: Names for a table without these columns; None: they are needed in the table.

    Raises:
        InputError: The table cannot be read, or a row lacks its position, line or track.
    """
    problems: list[InputError] = []
    rows = read_typed_rows(read_spreadsheet(path), PLACE_COLUMNS, problems)
    places = [place for row in rows if (place := _build_place(row, line, track, problems)) is not None]
    if problems:
        raise join_errors(problems)
    return places


def _build_place(row: TypedRow, line: str | None, track: str | None, problems: list[InputError]) -> KnownPlace | None:
    begin, end = (row.number(column) for column in ("from_m", "to_m"))
    position = row.number(POSITION)
    kind = str(row.values.get("kind", "support"))
    latitude, longitude = row.number(LATITUDE), row.number(LONGITUDE)
    own_line, own_track = row.values.get("line", line), row.values.get("track", track)
    if kind not in PLACE_KINDS:
        problems.append(
            InputError(row.place, f"has the unknown kind {kind[:40]!r}", f"Known are {', '.join(PLACE_KINDS)}.")
        )
    elif (latitude is None) != (longitude is None) or abs(latitude or 0.0) > 90 or abs(longitude or 0.0) > 180:
        found = f"has the latitude {latitude} and the longitude {longitude}"
        problems.append(InputError(row.place, found, "Give both in decimal degrees, or neither."))
    elif own_line is None or own_track is None:
        problems.append(InputError(row.place, "names no line or track", "Add the columns line and track."))
    elif (begin is None or end is None) and position is None:
        problems.append(InputError(row.place, "has no position", "Give x_km, or from_km and to_km."))
    else:
        low, high = sorted(x for x in (begin, end) if x is not None) if position is None else (position, position)
        name = str(row.values.get("name", row.values.get("number", "")))
        return KnownPlace(
            line=str(own_line),
            track=str(own_track),
            kind=kind,
            name=name,
            from_km=low / 1000,
            to_km=high / 1000,
            latitude_deg=latitude,
            longitude_deg=longitude,
        )
    return None


def list_tension_sections(places: Sequence[KnownPlace], line: str, track: str) -> list[TrackSection]:
    """Tension sections of a track as sections to be graded, in the order of kilometres; empty if none is known."""
    found = [x for x in places if (x.line, x.track, x.kind) == (line, track, TENSION_SECTION) and x.to_km > x.from_km]
    return [
        TrackSection(line=line, track=track, name=x.name, from_km=x.from_km, to_km=x.to_km)
        for x in sorted(found, key=lambda x: (x.from_km, x.to_km))
    ]


def list_support_kilometres(places: Sequence[KnownPlace], line: str, track: str) -> RealArray:
    """Kilometres of the supports of a track in increasing order, (n,) [km]."""
    return np.unique([x.from_km for x in places if (x.line, x.track, x.kind) == (line, track, "support")])


def find_known_place(places: Sequence[KnownPlace], line: str, track: str, km: float) -> tuple[str, bool]:
    """Name of the place near a kilometre, and whether a deviation of the force is expected there.

    A place that explains the deviation comes first, then the nearest one.
    """
    near = [
        (x.kind not in EXPLAINING, max(x.from_km - km, km - x.to_km, 0.0), x)
        for x in places
        if (x.line, x.track) == (line, track) and x.kind != TENSION_SECTION
    ]
    near = [item for item in near if item[1] <= NEAR_KM]
    if not near:
        return "", False
    other, _, place = min(near, key=lambda item: item[:2])
    return f"{place.kind.replace('_', ' ')} {place.name}".strip(), not other
