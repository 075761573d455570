"""Tension sections in the model: wires raised over the overlaps and joined to one line."""

from collections.abc import Sequence
from dataclasses import replace

from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.section_tables import OverlapTable, SectionPlace, SectionTable
from pantocheck.model import Catenary, Kind
from pantocheck.model.catenary import Termination
from pantocheck.model.sections import Rise, join_sections, place_section


def join_line(line: LineFile, overlap: OverlapTable, sections: Sequence[Catenary]) -> Catenary:
    """Join the sections of a line, each built in its place without a rise.

    Parameters
    ----------
    line : LineFile
        Content of the line file.
    overlap : OverlapTable
        Overlaps of the line.
    sections : sequence of Catenary
        Tension sections in running order.

    Returns
    -------
    Catenary
        Line with raised wires in its overlaps.
    """
    ended = [
        _terminate(section, table, line.geometry.span_limits)
        for section, table in zip(sections, line.section or (), strict=True)
    ]
    return join_sections(
        [
            place_section(section, f"section {place.number}", 0.0, section_rise(line, overlap, place))
            for place, section in zip(line.section_places, ended, strict=True)
        ]
    )


def _terminate(section: Catenary, table: SectionTable, limits: Sequence[float]) -> Catenary:
    """Section whose messenger wires have their terminations and their mid-point anchor."""
    terminations = Termination(table.start), Termination(table.end)
    midpoint = None if table.midpoint_anchor is None else limits[table.midpoint_anchor]
    return replace(
        section,
        wires=tuple(
            replace(wire, terminations=terminations) if wire.kind is Kind.MESSENGER_WIRE else wire
            for wire in section.wires
        ),
        messenger_supports=tuple(
            replace(support, along_track="fixed") if support.position == midpoint else support
            for support in section.messenger_supports
        ),
    )


def section_rise(line: LineFile, overlap: OverlapTable, place: SectionPlace) -> Rise:
    """Rise of the wires of a section by position along the line; the ends of the line are not raised."""
    limits, n = line.geometry.span_limits, overlap.spans
    start, end = limits[place.first], limits[place.last]
    behind = [x - start for x in limits[place.first : place.first + n + 1]]
    ahead = [end - x for x in reversed(limits[place.last - n : place.last + 1])]

    def rise(x: float) -> float:
        """Rise towards the anchor at the start plus that towards the anchor at the end; one of them is zero."""
        from_start = overlap.rise(x - start, behind) if place.first > 0 else 0.0
        return from_start + (overlap.rise(end - x, ahead) if place.last < line.geometry.spans else 0.0)

    return rise
