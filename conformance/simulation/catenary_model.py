"""From a line file to the reference simulator's terms."""

from collections.abc import Iterator
from dataclasses import replace

from pantocheck.conformance.cases.damping_file import ComponentDamping
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.line_file import WireTable as WireFile
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
"""Element length that is good enough for dropper lengths, from which their masses follow [m]."""


def build_catenary(line: LineFile) -> Catenary:
    """The line of a line file.

    Parameters
    ----------
    line : LineFile
        As read.

    Returns
    -------
    Catenary
        The line in the simulator's terms.
    """
    built = Catenary(
        wires=(*_wires(line, "contact wire", Kind.CONTACT_WIRE), *_messenger_wires(line), *_stitch_wires(line)),
        droppers=tuple(_droppers(line)),
        steady_arms=tuple(_steady_arms(line)),
        messenger_supports=tuple(_messenger_supports(line)),
        clamps=tuple(_clamps(line)),
        damping={
            Kind.CONTACT_WIRE: _rayleigh(line.damping.contact_wire),
            Kind.MESSENGER_WIRE: _rayleigh(line.damping.messenger_wire),
            Kind.STITCH_WIRE: _rayleigh(line.damping.stitch_wire),
            Kind.DROPPER: _rayleigh(line.damping.droppers),
            Kind.STEADY_ARM: _rayleigh(line.damping.steady_arms),
        },
        modal_damping=tuple(ModalBand(band.from_Hz, band.to_Hz, band.damping_ratio) for band in line.damping.modal),
    )
    if not line.droppers.mass_kg_m:
        return built
    # The lengths depend on the weights a little: two passes settle them to a micrometre.
    for _ in range(2):
        masses = line.droppers.mass_kg_m * discretise(built, COARSE).state.dropper_length
        droppers = zip(built.droppers, masses, strict=True)
        built = replace(built, droppers=tuple(replace(dropper, mass=float(mass)) for dropper, mass in droppers))
    return built


def _names(line: LineFile, name: str) -> list[str]:
    number = (line.contact_wire if name == "contact wire" else line.messenger_wire).number
    return [name] if number == 1 else [f"{name} {i + 1}" for i in range(number)]


def _wires(line: LineFile, name: str, kind: Kind) -> list[Wire]:
    file: WireFile = line.contact_wire if kind is Kind.CONTACT_WIRE else line.messenger_wire
    geometry = line.geometry
    stagger = geometry.stagger_contact_wire_m if kind is Kind.CONTACT_WIRE else geometry.stagger_messenger_m
    lateral = geometry.stagger_contact_wire_m != 0.0 or geometry.stagger_messenger_m != 0.0
    names = _names(line, name)
    wires = []
    for i, own in enumerate(names):
        beside = (file.spacing_m or 0.0) * (i - (len(names) - 1) / 2)
        plan = tuple((x, (stagger if n % 2 == 0 else -stagger) + beside) for n, x in enumerate(geometry.span_limits))
        wires.append(
            Wire(
                own,
                kind,
                0.0,
                geometry.length,
                file.tension_N,
                file.mass_kg_m,
                file.bending_stiffness_N_m2,
                stagger=plan if lateral else None,
            )
        )
    return wires


def _messenger_wires(line: LineFile) -> list[Wire]:
    """Messengers; between the clamps of a stitch wire they are relieved of its tension."""
    wires = _wires(line, "messenger wire", Kind.MESSENGER_WIRE)
    if line.stitch_wire is None:
        return wires
    half, relief = line.stitch_wire.length_m / 2, -line.stitch_wire.tension_N
    changes = tuple(TensionChange(x - half, x + half, relief) for x in line.geometry.supports)
    return [replace(wire, tension_changes=changes) for wire in wires]


def _stitch_wires(line: LineFile) -> Iterator[Wire]:
    stitch = line.stitch_wire
    if stitch is not None:
        half = stitch.length_m / 2
        for messenger in _names(line, "messenger wire"):
            for i, x in enumerate(line.geometry.supports, 1):
                name = _stitch_name(messenger, i)
                yield Wire(
                    name,
                    Kind.STITCH_WIRE,
                    x - half,
                    x + half,
                    stitch.tension_N,
                    stitch.mass_kg_m,
                    stitch.bending_stiffness_N_m2,
                )


def _stitch_name(messenger: str, support: int) -> str:
    return f"stitch wire of {messenger} at support {support}"


def _clamps(line: LineFile) -> Iterator[Clamp]:
    stitch = line.stitch_wire
    if stitch is not None:
        for messenger in _names(line, "messenger wire"):
            for i, x in enumerate(line.geometry.supports, 1):
                for end in (x - stitch.length_m / 2, x + stitch.length_m / 2):
                    yield Clamp(end, messenger, _stitch_name(messenger, i), stitch.clamp_kg)


def _droppers(line: LineFile) -> Iterator[Dropper]:
    file, messengers = line.droppers, _names(line, "messenger wire")
    presag = file.presag_m or (0.0,) * len(file.x_m)
    for span_start in line.geometry.span_limits[:-1]:
        for x, sag in zip(file.x_m, presag, strict=True):
            for i, contact in enumerate(_names(line, "contact wire")):
                position = span_start + x
                yield Dropper(
                    position,
                    _upper_wire(line, messengers[min(i, len(messengers) - 1)], position),
                    contact,
                    stiffness=file.stiffness_N_m,
                    axial_stiffness=file.axial_stiffness_EA_N,
                    mass=file.mass_kg or 0.0,
                    upper_clamp_mass=file.clamp_on_messenger_kg,
                    lower_clamp_mass=file.clamp_on_contact_kg,
                    contact_wire_height=-sag,
                )


def _upper_wire(line: LineFile, messenger: str, position: float) -> str:
    """What a dropper hangs on: the stitch wire if one passes there, else the messenger."""
    if line.stitch_wire is not None:
        for i, x in enumerate(line.geometry.supports, 1):
            if abs(position - x) < line.stitch_wire.length_m / 2:
                return _stitch_name(messenger, i)
    return messenger


def _steady_arms(line: LineFile) -> Iterator[SteadyArm]:
    arm = line.steady_arm
    # A bar that turns about its hinge moves a third of its mass with the claw.
    mass = arm.mass_kg_m * (arm.length_m or 0.0) / 3 + arm.clamp_kg
    for x in line.geometry.supports:
        for contact in _names(line, "contact wire"):
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
        for messenger in _names(line, "messenger wire"):
            yield MessengerSupport(
                x, messenger, line.geometry.encumbrance_m, support.stiffness_N_m, support.damping_N_s_m
            )


def _rayleigh(damping: ComponentDamping) -> Rayleigh:
    return Rayleigh(damping.mass_coefficient_1_s, damping.stiffness_coefficient_s)
