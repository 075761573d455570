"""Values that the suite derives from the inputs of a case, in results.json: wave speeds, masses, uplift forces."""

import math
from collections.abc import Iterator, Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.results.case_facts_format import DerivedFact
from pantocheck.model.fem.beam import wave_speed
from pantocheck.model.statics.wave_factors import doppler_factor


def list_derived_facts(case: Case, uplift_forces: Sequence[float] = ()) -> list[DerivedFact]:
    """Derived values of a case: of its wires, and of its pantographs.

    Args:
        case: Any case, with or without a speed.
        uplift_forces: Uplift force of every pantograph in the run [N]; empty: not known.
    """
    return [*_list_line_facts(case), *_list_pantograph_facts(case, uplift_forces)]


def _list_line_facts(case: Case) -> Iterator[DerivedFact]:
    """Wave speeds and masses of every section whose wires differ from those of the sections before it."""
    lines: list[LineFile] = []
    for number, place in enumerate(case.line.section_places, 1):
        line = case.line.section_file(place)
        wires = (line.contact_wire, line.messenger_wire)
        if wires in [(other.contact_wire, other.messenger_wire) for other in lines]:
            continue
        lines.append(line)
        yield from _list_wire_facts(line, case.speed, "" if number == 1 else f", section {number}")


def _list_wire_facts(line: LineFile, speed: float, section: str) -> Iterator[DerivedFact]:
    """Values of the wires of one section; the wave speeds are those of waves of low frequency."""
    contact, messenger = line.contact_wire, line.messenger_wire
    wave = wave_speed(contact.tension_N, contact.mass_kg_m)
    formula = "√(tension / mass per length)"
    yield DerivedFact(name=f"Wave speed of the contact wire{section}", value=wave, unit="m/s", basis=formula)
    yield DerivedFact(
        name=f"Wave speed of the messenger wire{section}",
        value=wave_speed(messenger.tension_N, messenger.mass_kg_m),
        unit="m/s",
        basis=formula,
    )
    if speed > 0:
        yield DerivedFact(
            name=f"Doppler factor of the contact wire{section}",
            value=doppler_factor(speed, wave),
            unit="",
            basis="(wave speed − speed) / (wave speed + speed)",
        )
    mass = sum(wire.number * wire.mass_kg_m for wire in (contact, messenger))
    tension = sum(wire.number * wire.tension_N for wire in (contact, messenger))
    yield DerivedFact(
        name=f"Mass per length of all wires{section}",
        value=mass,
        unit="kg/m",
        basis="contact and messenger wires, without droppers and clamps",
    )
    span = line.geometry.longest_span
    yield DerivedFact(
        name=f"First natural frequency of the longest span{section}",
        value=math.sqrt(tension / mass) / (2 * span),
        unit="Hz",
        basis=f"string of {span:g} m with tension and mass of all wires",
    )


def _list_pantograph_facts(case: Case, uplift_forces: Sequence[float]) -> Iterator[DerivedFact]:
    for number, pantograph in enumerate(case.pantographs, 1):
        if pantograph.chain is not None:
            yield DerivedFact(
                name=f"Mass of pantograph {number}",
                value=math.fsum(pantograph.chain.masses_kg),
                unit="kg",
                basis="sum of the masses of its chain",
            )
    if not uplift_forces:
        return
    for number, (force, lift) in enumerate(zip(uplift_forces, case.lift_forces, strict=True), 1):
        if lift.target_mean_force is not None:
            basis = f"tuned to a mean contact force of {lift.target_mean_force:g} N"
        else:
            basis = "force law of the pantograph" if number in case.law_forces else "stated in the case"
        yield DerivedFact(name=f"Uplift force of pantograph {number}", value=force, unit="N", basis=basis)
