"""Tension sections in the model: wires raised over the overlaps and joined to one line."""

from collections.abc import Sequence
from dataclasses import replace

from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.section_rises import section_rise
from pantocheck.conformance.cases.section_tables import SectionTable
from pantocheck.model import Catenary, Kind
from pantocheck.model.catenary import Termination
from pantocheck.model.sections import join_sections, place_section


def join_line(line: LineFile, sections: Sequence[Catenary]) -> Catenary:
    """Join the sections of a line, each built in its place without a rise.

    Parameters
    ----------
    line : LineFile
        Content of the line file.
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
            place_section(section, f"section {place.number}", 0.0, section_rise(line, place))
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
