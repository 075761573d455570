"""Catenary of the reference simulator from a line file."""

from collections.abc import Iterator
from dataclasses import replace

from pantocheck.conformance.cases.damping_file import ComponentDamping
from pantocheck.conformance.cases.line_file import LineFile, WireTable
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
    """
    catenary = Catenary(
        wires=(
            *_wires(line, Kind.CONTACT_WIRE),
            *_wires(line, Kind.MESSENGER_WIRE),
            *(wire for _, wire in _stitch_wires(line)),
        ),
        droppers=tuple(_droppers(line)),
        steady_arms=tuple(_steady_arms(line)),
        messenger_supports=tuple(_messenger_supports(line)),
        clamps=tuple(_clamps(line)),
        damping={kind: _rayleigh(getattr(line.damping, key)) for kind, key in _DAMPING_KEYS.items()},
        modal_damping=tuple(ModalBand(band.from_Hz, band.to_Hz, band.damping_ratio) for band in line.damping.modal),
    )
    if not line.droppers.mass_kg_m:
        return catenary
    # The lengths depend slightly on the weights: after two passes they are accurate to 0.1 mm.
    for _ in range(2):
        masses = line.droppers.mass_kg_m * discretise(catenary, COARSE).state.dropper_length
        droppers = zip(catenary.droppers, masses, strict=True)
        catenary = replace(catenary, droppers=tuple(replace(dropper, mass=float(mass)) for dropper, mass in droppers))
    return catenary


def _names(line: LineFile, kind: Kind) -> list[str]:
    """Names of the parallel wires of a kind."""
    name, table = (
        ("contact wire", line.contact_wire) if kind is Kind.CONTACT_WIRE else ("messenger wire", line.messenger_wire)
    )
    return [name] if table.number == 1 else [f"{name} {i + 1}" for i in range(table.number)]


def _wires(line: LineFile, kind: Kind) -> Iterator[Wire]:
    geometry, stitch = line.geometry, line.stitch_wire
    changes: tuple[TensionChange, ...] = ()
    table: WireTable = line.contact_wire
    stagger, axial_stiffness = geometry.stagger_contact_wire_m, None
    if kind is Kind.MESSENGER_WIRE:
        table, stagger = line.messenger_wire, geometry.stagger_messenger_m
        axial_stiffness = line.messenger_wire.axial_stiffness_EA_N
        if stitch is not None:
            # The messenger and the stitch wire share the tension between the clamps.
            half = stitch.length_m / 2
            changes = tuple(TensionChange(x - half, x + half, -stitch.tension_N) for x in geometry.supports)
    lateral = geometry.stagger_contact_wire_m != 0.0 or geometry.stagger_messenger_m != 0.0
    for i, name in enumerate(_names(line, kind)):
        offset = (table.spacing_m or 0.0) * (i - (table.number - 1) / 2)
        plan = tuple((x, (stagger if n % 2 == 0 else -stagger) + offset) for n, x in enumerate(geometry.span_limits))
        yield Wire(
            name,
            kind,
            0.0,
            geometry.length,
            table.tension_N,
            table.mass_kg_m,
            table.bending_stiffness_N_m2,
            tension_changes=changes,
            stagger=plan if lateral else None,
            axial_stiffness=axial_stiffness,
        )


def _stitch_wires(line: LineFile) -> list[tuple[str, Wire]]:
    """Stitch wires, each with the name of its messenger."""
    stitch = line.stitch_wire
    if stitch is None:
        return []
    half = stitch.length_m / 2
    section = (stitch.tension_N, stitch.mass_kg_m, stitch.bending_stiffness_N_m2)
    return [
        (messenger, Wire(f"stitch wire of {messenger} at support {i}", Kind.STITCH_WIRE, x - half, x + half, *section))
        for messenger in _names(line, Kind.MESSENGER_WIRE)
        for i, x in enumerate(line.geometry.supports, 1)
    ]


def _clamps(line: LineFile) -> Iterator[Clamp]:
    if line.stitch_wire is not None:
        for messenger, wire in _stitch_wires(line):
            for end in (wire.start, wire.end):
                yield Clamp(end, messenger, wire.name, line.stitch_wire.clamp_kg)


def _droppers(line: LineFile) -> Iterator[Dropper]:
    table, messengers, stitch_wires = line.droppers, _names(line, Kind.MESSENGER_WIRE), _stitch_wires(line)
    for span_start, schedule in zip(line.geometry.span_limits[:-1], line.dropper_schedules, strict=True):
        presag = schedule.presag_m or (0.0,) * len(schedule.x_m)
        for x, sag in zip(schedule.x_m, presag, strict=True):
            for i, contact in enumerate(_names(line, Kind.CONTACT_WIRE)):
                position, messenger = span_start + x, messengers[min(i, len(messengers) - 1)]
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
                    contact_wire_height=-sag,
                )


def _steady_arms(line: LineFile) -> Iterator[SteadyArm]:
    arm = line.steady_arm
    # A bar that rotates about its hinge acts at the claw with a third of its mass.
    mass = arm.mass_kg_m * (arm.length_m or 0.0) / 3 + arm.clamp_kg
    for x in line.geometry.supports:
        for contact in _names(line, Kind.CONTACT_WIRE):
            yield SteadyArm(
                x,
                contact,
                vertical_stiffness=arm.vertical_stiffness_N_m,
                length=arm.length_m,
                mass=mass,
                vertical_damper=arm.vertical_damper_N_s_m,
                carries_share=arm.static_share == "level",
                acts=arm.acts,
            )


def _messenger_supports(line: LineFile) -> Iterator[MessengerSupport]:
    support = line.messenger_support
    for x in line.geometry.supports:
        for messenger in _names(line, Kind.MESSENGER_WIRE):
            yield MessengerSupport(
                x,
                messenger,
                line.geometry.encumbrance_m,
                support.stiffness_N_m,
                support.damping_N_s_m,
                support.along_track,
            )


def _rayleigh(damping: ComponentDamping) -> Rayleigh:
    return Rayleigh(damping.mass_coefficient_1_s, damping.stiffness_coefficient_s)
