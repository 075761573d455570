"""Values that the suite derives from the inputs of a case, in results.json: wave speeds, masses, uplift forces."""

import math
from collections.abc import Iterator, Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.lift_force import AppliedForces, LiftForce
from pantocheck.conformance.core.results_part import Owner
from pantocheck.conformance.core.sourced_table import PROVENANCE, SourcedTable
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.results.case_facts_format import (
    AppliedForceFacts,
    DerivedFact,
    MeanForceFacts,
    StoredRange,
    StoredValue,
)
from pantocheck.model.fem.beam import wave_speed
from pantocheck.model.statics.wave_factors import doppler_factor

UPLIFT_FORCE = "Uplift force of pantograph"
"""Prefix of the name of a fact."""


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
            head = pantograph.head
            strips = [strip.mass_kg for strip in head.strip if strip.mass_kg] if head is not None else []
            yield DerivedFact(
                name=f"Mass of pantograph {number}",
                value=math.fsum((*pantograph.chain.masses_kg, *strips)),
                unit="kg",
                basis="sum of the masses of its chain and of its strips"
                if strips
                else "sum of the masses of its chain",
            )
    if not uplift_forces:
        return
    for number, (force, lift) in enumerate(zip(uplift_forces, case.lift_forces, strict=True), 1):
        if lift.target_mean_force is not None:
            basis = f"tuned to a mean contact force of {lift.target_mean_force:g} N"
        else:
            basis = "force law of the pantograph" if number in case.law_forces else "stated in the case"
        yield DerivedFact(name=f"{UPLIFT_FORCE} {number}", value=force, unit="N", basis=basis)


def find_uplift_forces(facts: Sequence[DerivedFact]) -> tuple[float, ...]:
    """Uplift force of every pantograph among derived facts [N]; empty: not known."""
    return tuple(fact.value for fact in facts if fact.name.startswith(UPLIFT_FORCE))


# Values of the inputs of a case in results.json: every key of a table, lists of tables column by column.
NAME_KEYS = frozenset({"id", "title", "line", "model", "requires", "edition", "superseded_by", "on_request"})
"""Keys that name a case or its files, and are not inputs."""

OTHER_PARTS = frozenset({"limit", "reading", "pantograph", "mass_drop", "study", "damping"})
"""Keys of a case file with groups of their own."""

MOST_LISTED = 12
"""Longest list whose values are all stored; of a longer one, number and range are: a line may have 500 spans."""


def list_input_values(table: SourcedTable, groups: set[str], group: str) -> dict[str, StoredValue]:
    """Values that the file of a table states.

    Args:
        table: Table of a case, line or pantograph.
        groups: Names of all groups of inputs; a part of the table that is a group of its own is left out.
        group: Name of the group of the table.
    """
    excluded = {key for key in type(table).model_fields if f"{group}.{key}" in groups}
    excluded |= PROVENANCE | NAME_KEYS | (OTHER_PARTS if group == "case" else frozenset())
    tree = table.model_dump(mode="json", exclude=excluded, exclude_unset=True, exclude_none=True)
    columns: dict[str, list[object]] = {}
    for key, value in tree.items():
        _collect(key, value, columns)
    return {key: _summarise(values) for key, values in columns.items() if values}


def _collect(key: str, value: object, columns: dict[str, list[object]]) -> None:
    """Collect the values of nested tables and lists by their dotted key."""
    if isinstance(value, dict):
        for name, part in value.items():
            if name not in PROVENANCE:
                _collect(f"{key}.{name}", part, columns)
    elif isinstance(value, list):
        for part in value:
            _collect(key, part, columns)
    elif value is not None:
        columns.setdefault(key, []).append(value)


def _summarise(values: list[object]) -> StoredValue:
    """One value as it is, a short list as a list, a long one as number and range, or as its different texts."""
    numbers = [float(value) for value in values if isinstance(value, int | float) and not isinstance(value, bool)]
    if len(values) == 1:
        [value] = values
        return value if isinstance(value, bool | str) else numbers[0]
    if len(numbers) == len(values) > MOST_LISTED:
        return StoredRange(count=len(numbers), lowest=min(numbers), highest=max(numbers))
    if len(numbers) == len(values):
        return list(numbers)
    texts = [
        value if isinstance(value, float | int) and not isinstance(value, bool) else str(value) for value in values
    ]
    return texts if len(texts) <= MOST_LISTED else list(dict.fromkeys(texts))[:MOST_LISTED]


# Forces that the force laws of pantographs give at the speed of a case, in results.json and in words.
def list_law_forces(case: Case) -> dict[Owner, AppliedForceFacts | MeanForceFacts]:
    """Forces of the pantographs of a case whose force law applies, by the number of the pantograph as text."""
    return {str(number): _describe_lift_force(lift) for number, lift in case.law_forces.items()}


def _describe_lift_force(lift: LiftForce) -> AppliedForceFacts | MeanForceFacts:
    if isinstance(lift, AppliedForces):
        return AppliedForceFacts(static_force_N=lift.static_force, aerodynamic_force_N=lift.aerodynamic_force)
    return MeanForceFacts(mean_force_N=lift.target_mean_force)
