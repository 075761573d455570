"""Tension sections in the model: wires raised over the overlaps and joined to one line."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.section_rises import section_rise
from pantocheck.conformance.cases.section_tables import SectionPlace, SectionTable
from pantocheck.model import Catenary, DiscretisedLine, Kind, Wire
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
            place_section(section, _name_section(place), 0.0, section_rise(line, place))
            for place, section in zip(line.section_places, ended, strict=True)
        ]
    )


def _name_section(place: SectionPlace) -> str:
    """Name of a section, the first part of the names of its wires."""
    return f"section {place.number}"


@dataclass(frozen=True)
class BuiltSection:
    """Tension section of a line with its part of the finite elements."""

    file: LineFile
    """Line file with the wires of the section."""
    limits: tuple[float, ...]
    """Positions of its anchors, and of the supports between them [m]."""
    line: DiscretisedLine
    """Finite elements of the line, with the parts of this section only in catenary and state."""

    def wires(self, kind: Kind) -> list[Wire]:
        """Wires of a kind."""
        return [wire for wire in self.line.catenary.wires if wire.kind is kind]


def divide_line(file: LineFile, line: DiscretisedLine) -> list[BuiltSection]:
    """Divide the finite elements of a line into its tension sections."""
    if file.overlap is None:
        return [BuiltSection(file, file.geometry.span_limits, line)]
    return [
        BuiltSection(
            file.section_file(place),
            file.geometry.span_limits[place.first : place.last + 1],
            _select_parts(line, f"{_name_section(place)} "),
        )
        for place in file.section_places
    ]


def _select_parts(line: DiscretisedLine, name: str) -> DiscretisedLine:
    """Line with the parts on wires whose names begin with a name."""
    catenary, state = line.catenary, line.state
    droppers = [n for n, dropper in enumerate(catenary.droppers) if dropper.lower.startswith(name)]
    arms = [n for n, arm in enumerate(catenary.steady_arms) if arm.wire.startswith(name)]
    return replace(
        line,
        catenary=replace(
            catenary,
            wires=tuple(wire for wire in catenary.wires if wire.name.startswith(name)),
            droppers=tuple(catenary.droppers[n] for n in droppers),
            steady_arms=tuple(catenary.steady_arms[n] for n in arms),
            messenger_supports=tuple(s for s in catenary.messenger_supports if s.wire.startswith(name)),
            clamps=tuple(clamp for clamp in catenary.clamps if clamp.upper.startswith(name)),
            point_masses=tuple(mass for mass in catenary.point_masses if mass.wire.startswith(name)),
        ),
        state=replace(
            state,
            dropper_tension=state.dropper_tension[droppers],
            dropper_length=state.dropper_length[droppers],
            dropper_direction=state.dropper_direction[droppers],
            arm_force=state.arm_force[arms],
        ),
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
