"""Rises of the wires over the overlaps of a line, by position along the line."""

from collections.abc import Callable

from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.section_tables import SectionPlace

SectionRise = Callable[[float], float]
"""Rise of the wires of a section by position along the line [m]."""


def section_rise(line: LineFile, place: SectionPlace) -> SectionRise:
    """Rise of the wires of a section; zero on a line without overlaps, and at the ends of the line."""
    overlap = line.overlap
    if overlap is None:
        return lambda x: 0.0
    limits, n = line.geometry.span_limits, overlap.spans
    start, end = limits[place.first], limits[place.last]
    behind = [x - start for x in limits[place.first : place.first + n + 1]]
    ahead = [end - x for x in reversed(limits[place.last - n : place.last + 1])]

    def rise(x: float) -> float:
        """Rise towards the anchor at the start plus that towards the anchor at the end; one of them is zero."""
        from_start = overlap.rise(x - start, behind) if place.first > 0 else 0.0
        return from_start + (overlap.rise(end - x, ahead) if place.last < line.geometry.spans else 0.0)

    return rise


def lowest_rise(line: LineFile, x: float) -> float:
    """Rise of the lowest contact wire at a position along the line [m]; zero outside of overlaps."""
    limits = line.geometry.span_limits
    places = [place for place in line.section_places if limits[place.first] <= x <= limits[place.last]]
    return min(section_rise(line, place)(x) for place in places)
