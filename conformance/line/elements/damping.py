"""Damping of a line, by kind of component and by frequency band.

The keys name the matrix of each Rayleigh coefficient, because publications use alpha and beta for either matrix.
"""

from dataclasses import replace
from itertools import pairwise
from typing import Annotated

from pydantic import Field

from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.sourced_table import (
    PROVENANCE,
    InputTable,
    Problems,
    SourcedTable,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.core.trust import LEVELS
from pantocheck.conformance.line.elements.element import Element
from pantocheck.conformance.line.elements.line_layout import LineLayout
from pantocheck.model import Catenary, Kind, ModalBand, Rayleigh


class ComponentDamping(InputTable):
    """Rayleigh damping of one kind of component: C = mass_coefficient M + stiffness_coefficient K."""

    mass_coefficient_1_s: Annotated[float, Field(ge=0, le=100), Feature("rayleigh_damping")] = 0.0
    """Factor of the mass matrix [1/s]."""
    stiffness_coefficient_s: Annotated[float, Field(ge=0, le=10), Feature("rayleigh_damping")] = 0.0
    """Factor of the stiffness matrix [s]."""


class ModalDamping(InputTable):
    """Damping ratio of all undamped modes of the line in a frequency band, in place of their Rayleigh damping."""

    from_Hz: Annotated[float, Field(ge=0, le=1000)]
    """Lower edge of the band [Hz]."""
    to_Hz: Annotated[float, Field(gt=0, le=1000)]
    """Upper edge of the band [Hz]."""
    damping_ratio: Annotated[float, Field(ge=0, lt=1)]
    """Ratio to critical damping [-]."""

    @cross_check
    def _ordered(self) -> Problems:
        if self.from_Hz >= self.to_Hz:
            yield validation_problem(
                "from_Hz",
                f"{self.from_Hz:g} Hz is not below to_Hz = {self.to_Hz:g} Hz",
                "Give the lower edge of the band as from_Hz, the upper edge as to_Hz.",
            )


class Damping(SourcedTable):
    """Damping of the line; a kind of component without a table is undamped."""

    contact_wire: ComponentDamping = ComponentDamping()
    messenger_wire: ComponentDamping = ComponentDamping()
    stitch_wire: ComponentDamping = ComponentDamping()
    droppers: ComponentDamping = ComponentDamping()
    steady_arms: ComponentDamping = ComponentDamping()
    modal: Annotated[tuple[ModalDamping, ...], Field(strict=False, max_length=1000), Feature("modal_damping")] = ()
    """Frequency bands with a damping ratio."""

    @cross_check
    def _bands_apart(self) -> Problems:
        for before, after in pairwise(sorted(self.modal, key=lambda band: band.from_Hz)):
            if after.from_Hz < before.to_Hz:
                yield validation_problem(
                    "modal",
                    f"the bands {before.from_Hz:g}-{before.to_Hz:g} Hz, {after.from_Hz:g}-{after.to_Hz:g} Hz overlap",
                    "Change their edges: a mode has one damping ratio only.",
                )


class DampingFile(InputTable):
    """File of a damping model, as `pantocheck drop fit` writes it."""

    damping: Damping


def overlay_damping(damping: Damping, over: Damping) -> Damping:
    """Damping of a line with another one laid over it: the tables of `over` replace the same tables of the line."""
    replaced = over.model_fields_set - PROVENANCE
    changes: dict[str, object] = {key: getattr(over, key) for key in replaced | PROVENANCE}
    if damping.model_fields_set - PROVENANCE - replaced - {"modal"}:  # some kinds of component of the line remain
        changes["trust"] = max(damping.trust, over.trust, key=LEVELS.index)
        changes["source"] = list(dict.fromkeys((*_listed(over.source), *_listed(damping.source))))
    # A modal band is valid only together with the Rayleigh damping of the same fit.
    return damping.model_copy(update={"modal": (), **changes})


def _listed(source: str | list[str]) -> list[str]:
    return [source] if isinstance(source, str) else source


# Damping of the line, by kind of component and by frequency band.
DAMPING_KEYS = {
    Kind.CONTACT_WIRE: "contact_wire",
    Kind.MESSENGER_WIRE: "messenger_wire",
    Kind.STITCH_WIRE: "stitch_wire",
    Kind.DROPPER: "droppers",
    Kind.STEADY_ARM: "steady_arms",
}
"""Damping table of each kind of component."""


class LineDamping(Element):
    """Damping of all components."""

    damping: Damping

    def add_to_section(self, catenary: Catenary, layout: LineLayout) -> Catenary:
        """Give the damping to the section."""
        tables = {kind: getattr(self.damping, key) for kind, key in DAMPING_KEYS.items()}
        return replace(
            catenary,
            damping={
                kind: Rayleigh(table.mass_coefficient_1_s, table.stiffness_coefficient_s)
                for kind, table in tables.items()
            },
            modal_damping=tuple(ModalBand(band.from_Hz, band.to_Hz, band.damping_ratio) for band in self.damping.modal),
        )
