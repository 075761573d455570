"""Catenary of the reference simulator from a line file."""

from collections.abc import Iterator
from dataclasses import replace

from pantocheck.conformance.cases.damping_file import ComponentDamping
from pantocheck.conformance.cases.line_file import LineFile, WireTable
from pantocheck.conformance.cases.line_layout import LineLayout, SpanLimit
from pantocheck.conformance.simulation.line_details import add_details
from pantocheck.conformance.simulation.line_variation import vary_catenary
from pantocheck.conformance.simulation.section_model import join_line
from pantocheck.model import (
    Catenary,
    Clamp,
    Dropper,
    Kind,
    MessengerSupport,
    ModalBand,
    Rayleigh,
    SteadyArm,
    TensionChange,
    Wire,
    discretise,
)

COARSE = 5.0
"""Element length for the dropper lengths from which the dropper masses follow [m]."""

_DAMPING_KEYS = {
    Kind.CONTACT_WIRE: "contact_wire",
    Kind.MESSENGER_WIRE: "messenger_wire",
    Kind.STITCH_WIRE: "stitch_wire",
    Kind.DROPPER: "droppers",
    Kind.STEADY_ARM: "steady_arms",
}
"""Damping table of each kind of component."""


def build_catenary(line: LineFile) -> Catenary:
    """Catenary of a line file.

    Parameters
    ----------
    line : LineFile
        Content of the line file.

    Returns
    -------
    Catenary
        Catenary for the simulator.

    Raises
    ------
    NoInitialState
        The varied line has no equilibrium.
    """
    layout = line.layout
    sections = [
        _build_section(line.section_file(place), layout.part(place.first, place.last)) for place in line.section_places
    ]
    catenary = sections[0] if line.overlap is None else join_line(line, sections)
    return vary_catenary(_add_dropper_masses(add_details(catenary, line), line.droppers.mass_kg_m), line)


def _add_dropper_masses(catenary: Catenary, mass_per_length: float | None) -> Catenary:
    """Masses of the droppers from their lengths, if a mass per length is given [kg/m]."""
    if not mass_per_length:
        return catenary
    # The lengths depend slightly on the weights: after two passes they are accurate to 0.1 mm.
    for _ in range(2):
        masses = mass_per_length * discretise(catenary, COARSE).state.dropper_length
        droppers = zip(catenary.droppers, masses, strict=True)
        catenary = replace(catenary, droppers=tuple(replace(dropper, mass=float(mass)) for dropper, mass in droppers))
    return catenary


def _build_section(line: LineFile, layout: LineLayout) -> Catenary:
    """Tension section of a line between the first and the last span limit of a layout."""
    return Catenary(
        wires=(
            *_wires(line, layout, Kind.CONTACT_WIRE),
            *_wires(line, layout, Kind.MESSENGER_WIRE),
            *(wire for _, wire in _stitch_wires(line, layout)),
        ),
        droppers=tuple(_droppers(line, layout)),
        steady_arms=tuple(_steady_arms(line, layout)),
        messenger_supports=tuple(_messenger_supports(line, layout)),
        clamps=tuple(_clamps(line, layout)),
        damping={kind: _rayleigh(getattr(line.damping, key)) for kind, key in _DAMPING_KEYS.items()},
        modal_damping=tuple(ModalBand(band.from_Hz, band.to_Hz, band.damping_ratio) for band in line.damping.modal),
    )


def _names(line: LineFile, kind: Kind) -> list[str]:
    """Names of the parallel wires of a kind."""
    name, table = (
        ("contact wire", line.contact_wire) if kind is Kind.CONTACT_WIRE else ("messenger wire", line.messenger_wire)
    )
    return [name] if table.number == 1 else [f"{name} {i + 1}" for i in range(table.number)]


def _wires(line: LineFile, layout: LineLayout, kind: Kind) -> Iterator[Wire]:
    stitch = line.stitch_wire
    changes: tuple[TensionChange, ...] = ()
    table: WireTable = line.contact_wire
    axial_stiffness = None
    if kind is Kind.MESSENGER_WIRE:
        table, axial_stiffness = line.messenger_wire, line.messenger_wire.axial_stiffness_EA_N
        if stitch is not None:
            # The messenger and the stitch wire share the tension between the clamps.
            half = stitch.length_m / 2
            masts = [support.limit.position for support in layout.supports]
            changes = tuple(TensionChange(x - half, x + half, -stitch.tension_N) for x in masts)
    places = [_wire_place(limit, kind) for limit in layout.limits]
    for i, name in enumerate(_names(line, kind)):
        offset = (table.spacing_m or 0.0) * (i - (table.number - 1) / 2)
        plan = tuple((limit.position, y + offset) for limit, (y, _) in zip(layout.limits, places, strict=True))
        yield Wire(
            name,
            kind,
            layout.limits[0].position,
            layout.limits[-1].position,
            table.tension_N,
            table.mass_kg_m,
            table.bending_stiffness_N_m2,
            tension_changes=changes,
            stagger=plan if layout.has_stagger or line.curves else None,
            axial_stiffness=axial_stiffness,
            end_heights=(places[0][1], places[-1][1]),
        )


def _wire_place(limit: SpanLimit, kind: Kind) -> tuple[float, float]:
    """Lateral position and height of a contact or messenger wire at a support or end of the line [m, m]."""
    if kind is Kind.CONTACT_WIRE:
        return limit.contact_wire_stagger, limit.contact_wire_height
    return limit.messenger_wire_stagger, limit.messenger_wire_height


def _stitch_wires(line: LineFile, layout: LineLayout) -> list[tuple[str, Wire]]:
    """Stitch wires, each with the name of its messenger."""
    stitch = line.stitch_wire
    if stitch is None:
        return []
    half = stitch.length_m / 2
    section = (stitch.tension_N, stitch.mass_kg_m, stitch.bending_stiffness_N_m2)
    masts = [(support.limit.number, support.limit.position) for support in layout.supports]
    return [
        (messenger, Wire(f"stitch wire of {messenger} at support {i}", Kind.STITCH_WIRE, x - half, x + half, *section))
        for messenger in _names(line, Kind.MESSENGER_WIRE)
        for i, x in masts
    ]


def _clamps(line: LineFile, layout: LineLayout) -> Iterator[Clamp]:
    if line.stitch_wire is not None:
        for messenger, wire in _stitch_wires(line, layout):
            for end in (wire.start, wire.end):
                yield Clamp(end, messenger, wire.name, line.stitch_wire.clamp_kg)


def _droppers(line: LineFile, layout: LineLayout) -> Iterator[Dropper]:
    table, messengers, stitch_wires = line.droppers, _names(line, Kind.MESSENGER_WIRE), _stitch_wires(line, layout)
    for span in layout.spans:
        for position, height in zip(span.dropper_position.tolist(), span.contact_wire_height.tolist(), strict=True):
            for i, contact in enumerate(_names(line, Kind.CONTACT_WIRE)):
                messenger = messengers[min(i, len(messengers) - 1)]
                stitch = (w.name for name, w in stitch_wires if name == messenger and w.start < position < w.end)
                yield Dropper(
                    position,
                    next(stitch, messenger),
                    contact,
                    stiffness=table.stiffness_N_m,
                    axial_stiffness=table.axial_stiffness_EA_N,
                    mass=table.mass_kg or 0.0,
                    upper_clamp_mass=table.clamp_on_messenger_kg,
                    lower_clamp_mass=table.clamp_on_contact_kg,
                    contact_wire_height=height,
                )


def _steady_arms(line: LineFile, layout: LineLayout) -> Iterator[SteadyArm]:
    for support in layout.supports:
        arm = support.steady_arm
        # A bar that rotates about its hinge acts at the claw with a third of its mass.
        mass = arm.mass_kg_m * (arm.length_m or 0.0) / 3 + arm.clamp_kg
        for contact in _names(line, Kind.CONTACT_WIRE):
            yield SteadyArm(
                support.limit.position,
                contact,
                vertical_stiffness=arm.vertical_stiffness_N_m,
                length=arm.length_m,
                mass=mass,
                vertical_damper=arm.vertical_damper_N_s_m,
                carries_share=arm.static_share == "level",
                acts=arm.acts,
                height=support.limit.contact_wire_height,
            )


def _messenger_supports(line: LineFile, layout: LineLayout) -> Iterator[MessengerSupport]:
    for support in layout.supports:
        table = support.messenger_support
        for messenger in _names(line, Kind.MESSENGER_WIRE):
            yield MessengerSupport(
                support.limit.position,
                messenger,
                support.limit.messenger_wire_height,
                table.stiffness_N_m,
                table.damping_N_s_m,
                table.along_track,
            )


def _rayleigh(damping: ComponentDamping) -> Rayleigh:
    return Rayleigh(damping.mass_coefficient_1_s, damping.stiffness_coefficient_s)
