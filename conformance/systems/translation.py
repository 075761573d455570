"""From a case to the reference simulator's terms: the line, its pantographs, and where they run."""

from dataclasses import replace

import numpy as np
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.damping import ComponentDamping
from pantocheck.conformance.cases.line import Line
from pantocheck.conformance.cases.line import Wire as WireFile
from pantocheck.conformance.cases.pantograph import Pantograph as PantographFile
from pantocheck.model import (
    Catenary,
    Discretised,
    Dropper,
    Kind,
    MessengerSupport,
    Pantograph,
    Rayleigh,
    SteadyArm,
    Wire,
    chain,
    discretise,
)

CONTACT, MESSENGER = "contact wire", "messenger wire"

COARSE = 5.0
"""Element length that is good enough for dropper lengths, from which masses and stiffnesses follow [m]."""


def catenary(line: Line) -> Catenary:
    """The line of a line file.

    Parameters
    ----------
    line : as read

    Returns
    -------
    the line in the simulator's terms
    """
    built = _with_dropper_mass(line, 0.0 if line.droppers.mass_kg is None else line.droppers.mass_kg)
    if not line.droppers.mass_kg_m:
        return built
    # The lengths depend on the weights a little: two passes settle them to a micrometre.
    for _ in range(2):
        length = discretise(built, COARSE).state.dropper_length
        droppers = zip(built.droppers, line.droppers.mass_kg_m * length, strict=True)
        built = replace(built, droppers=tuple(replace(dropper, mass=float(mass)) for dropper, mass in droppers))
    return built


def _with_dropper_mass(line: Line, mass: float) -> Catenary:
    geometry, droppers, arm = line.geometry, line.droppers, line.steady_arm
    supports = [geometry.span_m * i for i in range(1, geometry.spans)]
    end = geometry.span_m * geometry.spans
    presag = droppers.presag_m or (0.0,) * len(droppers.x_m)
    return Catenary(
        wires=(
            _wire(CONTACT, Kind.CONTACT_WIRE, end, line.contact_wire),
            _wire(MESSENGER, Kind.MESSENGER_WIRE, end, line.messenger_wire),
        ),
        droppers=tuple(
            Dropper(
                geometry.span_m * span + x,
                MESSENGER,
                CONTACT,
                stiffness=droppers.stiffness_N_m,
                axial_stiffness=droppers.axial_stiffness_EA_N,
                mass=mass,
                upper_clamp_mass=droppers.clamp_on_messenger_kg,
                lower_clamp_mass=droppers.clamp_on_contact_kg,
                contact_wire_height=-sag,
            )
            for span in range(geometry.spans)
            for x, sag in zip(droppers.x_m, presag, strict=True)
        ),
        steady_arms=tuple(
            SteadyArm(
                x,
                CONTACT,
                vertical_stiffness=arm.vertical_stiffness_N_m,
                length=arm.length_m,
                mass=arm_mass_at_claw(line),
                carries_share=arm.static_share == "level",
            )
            for x in supports
        ),
        messenger_supports=tuple(
            MessengerSupport(
                x,
                MESSENGER,
                geometry.encumbrance_m,
                line.messenger_support.stiffness_N_m,
                line.messenger_support.damping_N_s_m,
            )
            for x in supports
        ),
        damping={
            Kind.CONTACT_WIRE: _rayleigh(line.damping.contact_wire),
            Kind.MESSENGER_WIRE: _rayleigh(line.damping.messenger_wire),
            Kind.STITCH_WIRE: _rayleigh(line.damping.stitch_wire),
            Kind.DROPPER: _rayleigh(line.damping.droppers),
            Kind.STEADY_ARM: _rayleigh(line.damping.steady_arms),
        },
    )


def arm_mass_at_claw(line: Line) -> float:
    """What a steady arm adds to the contact wire at its claw: a third of a bar that turns about its hinge [kg]."""
    arm = line.steady_arm
    return arm.mass_kg_m * (arm.length_m or 0.0) / 3 + arm.clamp_kg


def _wire(name: str, kind: Kind, end: float, wire: WireFile) -> Wire:
    return Wire(name, kind, 0.0, end, wire.tension_N, wire.mass_kg_m, wire.bending_stiffness_N_m2)


def _rayleigh(damping: ComponentDamping) -> Rayleigh:
    return Rayleigh(damping.mass_coefficient_1_s, damping.stiffness_coefficient_s)


def pantograph(file: PantographFile, uplift_force: float, working_height: float) -> Pantograph:
    """A pantograph pressing with an uplift force.

    Parameters
    ----------
    file : as read
    uplift_force : [N]
    working_height : of the head over the contact wire at the supports, at rest and pressing with that force [m]

    Returns
    -------
    the pantograph in the simulator's terms
    """
    parts = file.chain
    return chain(
        np.array(parts.masses_kg),
        np.array(parts.stiffness_N_m),
        np.array(parts.damping_N_s_m),
        uplift_force,
        parts.uplift_mass,
        file.contact.stiffness_N_m,
        working_height if parts.base_spring_unstretched == "working_height" else 0.0,
    )


def starts(case: Case) -> tuple[float, ...]:
    """Where each pantograph starts, the leading one first [m]."""
    return tuple(case.start + case.offsets[-1] - offset for offset in case.offsets)


def watched_supports(case: Case, line: Discretised) -> tuple[float, ...]:
    """Supports at and between the ends of the evaluated stretch [m]."""
    first, last = case.evaluated
    return tuple(arm.position for arm in line.catenary.steady_arms if first - 1e-6 <= arm.position <= last + 1e-6)
