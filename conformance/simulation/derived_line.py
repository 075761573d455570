"""Derived values of a line at rest, from its fine finite elements; `derived_format` defines them."""

from collections.abc import Iterable, Sequence
from itertools import accumulate
from typing import TypeVar

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.simulation.derived_details import (
    derive_curves,
    derive_irregularity,
    derive_point_masses,
    derive_stretches,
)
from pantocheck.conformance.simulation.derived_format import (
    DerivedContactWire,
    DerivedDroppers,
    DerivedLine,
    DerivedMessengerSupports,
    DerivedSection,
    DerivedSteadyArms,
    DerivedStitchWires,
    DerivedWire,
)
from pantocheck.conformance.simulation.derived_rounding import round_number, round_numbers, round_positions
from pantocheck.conformance.simulation.section_model import BuiltSection, divide_line
from pantocheck.model import Catenary, DiscretisedLine, Kind, Wire
from pantocheck.model.catenary import GRAVITY
from pantocheck.model.fem.beam import wave_speed
from pantocheck.model.fem.connectors import arm_direction

Entry = TypeVar("Entry")


def build_derived_line(file: LineFile, line: DiscretisedLine) -> DerivedLine:
    """Derived values of a line.

    Parameters
    ----------
    file : LineFile
        Content of the line file.
    line : DiscretisedLine
        Its finite elements.
    """
    sections = [_derive_section(section) for section in divide_line(file, line)]
    return DerivedLine(
        **dict(sections[0]),
        gravity_m_s2=GRAVITY,
        curves=derive_curves(line.catenary),
        further_sections=tuple(sections[1:]),
    )


def _derive_section(section: BuiltSection) -> DerivedSection:
    """Derived values of one tension section."""
    line = section.line
    return DerivedSection(
        span_limits_m=round_positions(section.limits),
        contact_wire=DerivedContactWire(
            **_wire(section, Kind.CONTACT_WIRE).model_dump(), irregularity=derive_irregularity(line.catenary)
        ),
        messenger_wire=_wire(section, Kind.MESSENGER_WIRE),
        stitch_wires=_stitch_wires(line.catenary),
        droppers=_droppers(section),
        steady_arms=_steady_arms(line),
        messenger_supports=_messenger_supports(line.catenary),
        point_masses=derive_point_masses(line.catenary),
    )


def _wire(section: BuiltSection, kind: Kind) -> DerivedWire:
    line, wires = section.line, section.wires(kind)
    first, row = wires[0], line.mesh.row_of[wires[0].name, "z"]
    stations = [line.mesh.station(x) for x in section.limits]
    staggers = [wire.stagger for wire in wires if wire.stagger is not None]
    return DerivedWire(
        start_m=round_positions([first.start])[0],
        end_m=round_positions([first.end])[0],
        wave_speed_m_s=round_number(wave_speed(first.tension, first.mass_per_length)),
        height_m=round_numbers(line.state.deflection[row, stations, 0]),
        lateral_position_m=tuple(round_numbers(y for _, y in stagger) for stagger in staggers) or None,
        stretches=derive_stretches(section.file, line, first),
    )


def _wires_of(catenary: Catenary, kind: Kind) -> list[Wire]:
    return [wire for wire in catenary.wires if wire.kind is kind]


def _stitch_wires(catenary: Catenary) -> DerivedStitchWires | None:
    wires = _wires_of(catenary, Kind.STITCH_WIRE)
    if not wires:
        return None
    messenger = _wires_of(catenary, Kind.MESSENGER_WIRE)[0]
    return DerivedStitchWires(
        start_m=round_positions(wire.start for wire in wires),
        end_m=round_positions(wire.end for wire in wires),
        wave_speed_m_s=round_number(wave_speed(wires[0].tension, wires[0].mass_per_length)),
        messenger_tension_N=messenger.tension + messenger.tension_changes[0].change,
        clamp_mass_kg=catenary.clamps[0].mass,
        mass_coefficient_1_s=catenary.rayleigh(Kind.DROPPER).mass_coefficient,
    )


def _droppers(section: BuiltSection) -> DerivedDroppers:
    line = section.line
    catenary, state, droppers = line.catenary, line.state, line.catenary.droppers
    length, direction = state.dropper_length, state.dropper_direction
    spans, rayleigh = _count_by_span(section), catenary.rayleigh(Kind.DROPPER)
    contact = {wire.name: n for n, wire in enumerate(catenary.contact_wires, 1)}

    def by_span(values: Sequence[float] | RealArray) -> tuple[tuple[float, ...], ...]:
        return _split(round_numbers(values), spans)

    stiffness = [d.taut_stiffness(float(rest)) for d, rest in zip(droppers, length, strict=True)]
    stitched = [catenary.wire(dropper.upper).kind is Kind.STITCH_WIRE for dropper in droppers]
    return DerivedDroppers(
        position_m=_split(round_positions(dropper.position for dropper in droppers), spans),
        contact_wire=_split([contact[dropper.lower] for dropper in droppers], spans),
        on_stitch_wire=_split(stitched, spans),
        contact_wire_height_m=by_span([dropper.contact_wire_height or 0.0 for dropper in droppers]),
        length_m=by_span(length),
        height_m=by_span(length * direction[:, 1]),
        width_m=by_span(length * direction[:, 0]),
        vertical_force_N=by_span(state.dropper_tension * direction[:, 1]),
        stiffness_N_m=by_span(stiffness),
        transverse_stiffness_N_m=by_span(state.dropper_tension / length) if catenary.has_lateral_field else None,
        mass_kg=by_span([dropper.mass for dropper in droppers]),
        upper_clamp_kg=droppers[0].upper_clamp_mass,
        lower_clamp_kg=droppers[0].lower_clamp_mass,
        mass_coefficient_1_s=rayleigh.mass_coefficient,
        stiffness_coefficient_s=rayleigh.stiffness_coefficient,
    )


def _count_by_span(section: BuiltSection) -> list[int]:
    """Number of droppers of every span."""
    positions = [dropper.position for dropper in section.line.catenary.droppers]
    return [int(count) for count in np.histogram(positions, section.limits)[0]]


def _split(values: Sequence[Entry], counts: Sequence[int]) -> tuple[tuple[Entry, ...], ...]:
    """Values in consecutive parts with given numbers of entries."""
    return tuple(tuple(values[end - count : end]) for count, end in zip(counts, accumulate(counts), strict=True))


def _join(values: Iterable[Entry]) -> Entry | tuple[Entry, ...]:
    """One value if all are equal, or else all values."""
    listed = tuple(values)
    return listed if len(set(listed)) != 1 else listed[0]


def _steady_arms(line: DiscretisedLine) -> DerivedSteadyArms:
    catenary, force = line.catenary, line.state.arm_force
    arms, rayleigh = catenary.steady_arms, catenary.rayleigh(Kind.STEADY_ARM)
    tensions = [arm_direction(arm, f)[2] for arm, f in zip(arms, force, strict=True)]
    across = [arm.transverse_stiffness(tension) for arm, tension in zip(arms, tensions, strict=True)]
    hinged = [catenary.has_lateral_field and arm.vertical_stiffness is None for arm in arms]
    return DerivedSteadyArms(
        position_m=round_positions(arm.position for arm in arms),
        lateral_force_N=round_numbers(force[:, 0]),
        vertical_force_N=round_numbers(force[:, 1]),
        transverse_stiffness_N_m=round_numbers(across) if any(hinged) else None,
        vertical_stiffness_N_m=None if all(hinged) else _join(arm.vertical_stiffness or 0.0 for arm in arms),
        vertical_damper_N_s_m=_join(arm.vertical_damper for arm in arms),
        mass_kg=_join(round_number(arm.mass) for arm in arms),
        mass_coefficient_1_s=rayleigh.mass_coefficient,
        stiffness_coefficient_s=rayleigh.stiffness_coefficient,
    )


def _messenger_supports(catenary: Catenary) -> DerivedMessengerSupports:
    """Supports of the first messenger wire; those of the others are equal."""
    first = _wires_of(catenary, Kind.MESSENGER_WIRE)[0].name
    supports = [support for support in catenary.messenger_supports if support.wire == first]
    stiffness = _join(support.stiffness for support in supports)
    damper = _join(support.damping for support in supports)
    lateral = catenary.has_lateral_field
    return DerivedMessengerSupports(
        position_m=round_positions(support.position for support in supports),
        height_m=_join(support.height for support in supports),
        vertical_stiffness_N_m=stiffness,
        lateral_stiffness_N_m=stiffness if lateral else None,
        vertical_damper_N_s_m=damper,
        lateral_damper_N_s_m=damper if lateral else None,
        held_along_track=_join(support.along_track == "fixed" for support in supports),
    )
