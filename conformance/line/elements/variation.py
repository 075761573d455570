"""Variation of a line after it was built: temperature, and tolerances of tensions and dropper lengths."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, Tag

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
    validation_problem,
)
from pantocheck.conformance.line.elements.dropper import Droppers
from pantocheck.conformance.line.elements.element import Element, choose_by_key
from pantocheck.conformance.line.elements.tension_section import TensionSections
from pantocheck.conformance.line.elements.wire import Wires
from pantocheck.model import Catenary, Kind, Wire

VARIATION = Feature("variation")

VARIATION_ELEMENT_M = 0.5
"""Element length for the heights of a varied line [m].

With elements of 0.125 m the heights of the lines of the library change by less than 0.02 mm, the dropper forces by less
than 0.1 N, for 5 % less tension of the messenger wire.
"""

LengthChange = Annotated[float, Field(ge=-0.2, le=0.2)]


class WireVariation(InputTable):
    """Change of the tension of a wire after the line was built."""

    ends: Annotated[Literal["weight", "anchor"], VARIATION] = "weight"
    """weight: the tension does not depend on the temperature; anchor: both ends are rigid anchors, and the tension
    changes with the temperature.
    """
    axial_stiffness_EA_N: Annotated[float | None, Field(gt=0, le=1e9), VARIATION] = None
    """Axial stiffness EA; needed with ends = 'anchor' [N]."""
    expansion_coefficient_1_K: Annotated[float | None, Field(gt=0, le=1e-4), VARIATION] = None
    """Thermal expansion coefficient; needed with ends = 'anchor' [1/K]."""
    tension_change_share: Annotated[float, Field(ge=-0.5, le=0.5), VARIATION] = 0.0
    """Tolerance of the tension: share of it that is added [-]."""

    @cross_check
    def _check_anchors(self) -> Problems:
        if self.ends == "anchor":
            for key in ("axial_stiffness_EA_N", "expansion_coefficient_1_K"):
                if getattr(self, key) is None:
                    yield validation_problem(
                        key, "missing for a wire with rigid anchors", "Give the value, or set ends = 'weight'."
                    )


class ListedLengthChanges(InputTable):
    """Change of the length of every dropper."""

    length_change_m: Annotated[
        tuple[Annotated[tuple[LengthChange, ...], Field(strict=False, max_length=100)], ...],
        Field(strict=False, max_length=1000),
    ]
    """Added lengths, one list per span in the order of x_m [m]."""


class RandomLengthChanges(InputTable):
    """Random changes of the lengths of the droppers, uniformly distributed within a tolerance."""

    tolerance_m: Annotated[float, Field(ge=0, le=0.2)]
    """Largest change of a length [m]."""
    seed: Annotated[int, Field(ge=0, le=2**31 - 1)]
    """Seed of the changes."""


DropperVariation = Annotated[
    Annotated[ListedLengthChanges, Tag("ListedLengthChanges")]
    | Annotated[RandomLengthChanges, Tag("RandomLengthChanges")],
    choose_by_key("tolerance_m", RandomLengthChanges, ListedLengthChanges),
]


class SupportVariation(InputTable):
    """Random changes of the stagger at the supports, uniformly distributed within a tolerance."""

    stagger_tolerance_m: Annotated[float, Field(ge=0, le=0.5)]
    """Largest lateral change of the contact wire at a support [m]."""
    seed: Annotated[int, Field(ge=0, le=2**31 - 1)]
    """Seed of the changes."""


class Variation(SourcedTable):
    """Variation of a line after it was built with its nominal data; its droppers keep their lengths."""

    temperature_change_K: Annotated[float, Field(ge=-100, le=200), VARIATION] = 0.0
    """Change of the temperature of the wires [K]."""
    contact_wire: WireVariation = WireVariation()
    messenger_wire: WireVariation = WireVariation()
    droppers: Annotated[DropperVariation | None, Field(exclude_if=is_absent), VARIATION] = None
    """Changes of the lengths of the droppers."""
    supports: Annotated[SupportVariation | None, Field(exclude_if=is_absent), VARIATION] = None
    """Changes of the stagger of the contact wire."""


class Variations(Element):
    """Variation of the line after it was built; droppers keep their lengths or change them by a tolerance."""

    variation: Annotated[Variation | None, Field(exclude_if=is_absent), VARIATION] = None
    """Variation of the line after it was built."""

    @cross_check
    def _check_length_changes(self) -> Problems:
        table = None if self.variation is None else self.variation.droppers
        if isinstance(table, ListedLengthChanges):
            found = [len(span) for span in table.length_change_m]
            needed = [len(schedule.x_m) for schedule in self.part(Droppers).dropper_schedules]
            if found != needed:
                yield validation_problem(
                    "variation.droppers.length_change_m",
                    f"{len(found)} lists with {sum(found)} changes for {len(needed)} spans with {sum(needed)} droppers",
                    "Give one list per span, with one change per dropper.",
                )

    @cross_check
    def _check_stagger_changes(self) -> Problems:
        if self.variation is not None and self.variation.supports is not None and not self.line.layout.has_stagger:
            yield validation_problem(
                "variation.supports",
                "varies the stagger of a line without a stagger",
                "Give geometry.stagger_contact_wire_m, or leave out variation.supports.",
            )

    def complete_line(self, catenary: Catenary) -> Catenary:
        """Vary tensions and staggers, and hang the contact wire on its droppers.

        Raises:
            NoInitialState: A wire would have no tension left, or a dropper would be slack at rest.
        """
        from pantocheck.model.discretisation.dropper_lengths import compute_unloaded_lengths, hang_on_droppers
        from pantocheck.model.discretisation.wire_climate import excess_lengths

        variation = self.variation
        if variation is None:
            return catenary
        length = compute_unloaded_lengths(catenary, VARIATION_ELEMENT_M) + self._length_changes(variation, catenary)
        excess = excess_lengths(catenary, VARIATION_ELEMENT_M)
        moved = _stagger_changes(variation, self.line.geometry.supports)
        wires = tuple(_move_wire(_vary_tension(wire, variation, excess[wire.name]), moved) for wire in catenary.wires)
        return hang_on_droppers(replace(catenary, wires=wires), length, VARIATION_ELEMENT_M)

    def _length_changes(self, variation: Variation, catenary: Catenary) -> RealArray:
        """Change of the length of every dropper [m]."""
        table = variation.droppers
        if table is None:
            return np.zeros(len(catenary.droppers))
        if isinstance(table, RandomLengthChanges):
            return _draw_changes(table.tolerance_m, table.seed, catenary.droppers)
        # Section by section; the droppers of parallel wires at one place have the same change.
        places = self.part(TensionSections).section_places
        listed = [
            change for place in places for span in table.length_change_m[place.first : place.last] for change in span
        ]
        return np.repeat(listed, self.part(Wires).contact_wire.number)


def _vary_tension(wire: Wire, variation: Variation, excess_length: float) -> Wire:
    """Wire with its tension after the change of temperature and with its tolerance; a stitch wire is unchanged."""
    from pantocheck.model.discretisation.wire_climate import fixed_tension

    tables = {Kind.CONTACT_WIRE: variation.contact_wire, Kind.MESSENGER_WIRE: variation.messenger_wire}
    table = tables.get(wire.kind, WireVariation())
    tension = wire.tension
    if table.ends == "anchor" and table.axial_stiffness_EA_N and table.expansion_coefficient_1_K:
        strain = table.expansion_coefficient_1_K * variation.temperature_change_K
        tension = fixed_tension(tension, excess_length, table.axial_stiffness_EA_N, strain)
    return replace(wire, tension=tension * (1 + table.tension_change_share))


def _stagger_changes(variation: Variation, supports: Sequence[float]) -> dict[float, float]:
    """Change of the stagger of the contact wire at every support by its position [m, m]."""
    table = variation.supports
    changes = (
        np.zeros(len(supports)) if table is None else _draw_changes(table.stagger_tolerance_m, table.seed, supports)
    )
    return dict(zip(supports, changes.tolist(), strict=True))


def _move_wire(wire: Wire, changes: Mapping[float, float]) -> Wire:
    """Contact wire with its stagger after the change at every support; its anchors and other wires are unchanged."""
    if wire.kind is not Kind.CONTACT_WIRE or wire.stagger is None:
        return wire
    first, *inner, last = wire.stagger
    return replace(wire, stagger=(first, *((x, y + changes[x]) for x, y in inner), last))


def _draw_changes(tolerance: float, seed: int, parts: Sequence[object]) -> RealArray:
    """Change of every part, uniformly distributed within a tolerance, in the unit of the tolerance."""
    shares = np.random.PCG64(seed).random_raw(len(parts)) / 2.0**64
    return np.asarray(tolerance * (2 * shares - 1))
