"""Damping of the line, by kind of component and by frequency band."""

from dataclasses import replace
from typing import TYPE_CHECKING

from pantocheck.conformance.cases.damping_file import Damping
from pantocheck.conformance.line.elements.element import Element
from pantocheck.model import Catenary, Kind, ModalBand, Rayleigh

if TYPE_CHECKING:
    from pantocheck.conformance.cases.line_layout import LineLayout

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

    def add_to_section(self, catenary: Catenary, layout: "LineLayout") -> Catenary:
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
