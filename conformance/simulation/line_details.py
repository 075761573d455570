"""Details of a catenary from a line file: point masses, changes of wires, irregularity, and curves of the track."""

from collections.abc import Sequence
from dataclasses import replace

from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.line_irregularity import build_irregularity
from pantocheck.conformance.cases.wire_changes import ContactWireChange, WireChange
from pantocheck.model import (
    Catenary,
    Kind,
    PointMass,
    SectionChange,
    TensionChange,
    TrackCurve,
    Wire,
)
from pantocheck.model.worn_wire import worn_stiffness_share

_KINDS = {"contact_wire": Kind.CONTACT_WIRE, "messenger_wire": Kind.MESSENGER_WIRE}
"""Kind of wire of each table."""


def add_details(catenary: Catenary, line: LineFile) -> Catenary:
    """Add point masses, changes of wires, the irregularity and the curves of the track to a catenary of uniform wires.

    In an overlap of tension sections they hold for the wires of both.

    Parameters
    ----------
    catenary : Catenary
        Catenary with uniform wires.
    line : LineFile
        Content of the line file.

    Returns
    -------
    Catenary
        The same catenary with the details of the line file.
    """
    changes: dict[Kind, Sequence[WireChange]] = {
        Kind.CONTACT_WIRE: line.contact_wire.change,
        Kind.MESSENGER_WIRE: line.messenger_wire.change,
    }
    wires = [_change_wire(wire, changes.get(wire.kind, ())) for wire in catenary.wires]
    irregularity = build_irregularity(line)
    return replace(
        catenary,
        wires=tuple(
            replace(wire, irregularity=irregularity) if wire.kind is Kind.CONTACT_WIRE else wire for wire in wires
        ),
        point_masses=tuple(
            PointMass(mass.x_m, wire.name, mass.mass_kg)
            for mass in line.point_mass
            for wire in wires
            if wire.kind is _KINDS[mass.wire] and wire.start < mass.x_m < wire.end
        ),
        curves=tuple(TrackCurve(c.from_m, c.to_m, c.radius_m, c.transition_m, c.cant_m) for c in line.curves),
    )


def _change_wire(wire: Wire, changes: Sequence[WireChange]) -> Wire:
    """Wire with its stretches of other properties."""
    sections, tensions = list(wire.section_changes), list(wire.tension_changes)
    for change in changes:
        start, end = max(change.from_m, wire.start), min(change.to_m, wire.end)
        if start >= end:
            continue  # on another tension section, or beyond the end of a shortened line
        mass, stiffness = _mass_and_stiffness(wire, change)
        if (mass, stiffness) != (wire.mass_per_length, wire.bending_stiffness):
            added = (mass - wire.mass_per_length, stiffness - wire.bending_stiffness)
            sections.append(SectionChange(start, end, *added))
        if change.tension_N is not None:
            tensions.append(TensionChange(start, end, change.tension_N - wire.tension))
    return replace(wire, section_changes=tuple(sections), tension_changes=tuple(tensions))


def _mass_and_stiffness(wire: Wire, change: WireChange) -> tuple[float, float]:
    """Mass per length and bending stiffness of a stretch [kg/m, N m2]."""
    mass, stiffness = wire.mass_per_length, wire.bending_stiffness
    if isinstance(change, ContactWireChange) and change.wear_share is not None:
        mass *= 1 - change.wear_share
        stiffness *= worn_stiffness_share(change.wear_share)
    return (
        mass if change.mass_kg_m is None else change.mass_kg_m,
        stiffness if change.bending_stiffness_N_m2 is None else change.bending_stiffness_N_m2,
    )
