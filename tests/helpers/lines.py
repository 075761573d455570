"""Small lines for the tests of the simulator."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigvals

from pantocheck.model import Catenary, Dropper, Kind, MessengerSupport, Rayleigh, SteadyArm, Wire, build_chain
from pantocheck.model.description.sections import join_sections, place_section

Array = NDArray[np.float64]

DROPPERS_2002 = (5.0, 10.5, 17.0, 23.5, 30.0, 36.5, 43.0, 49.5, 55.0)
"""Positions of the droppers in a span of the EN 50318:2002 reference model [m]."""

PANTOGRAPH_2002 = build_chain(np.array([15.0, 7.2]), np.array([50.0, 4200.0]), np.array([90.0, 10.0]), 120.0, 0, 50e3)
"""Pantograph of the EN 50318:2002 reference model (published_values.toml, en50318_2002)."""


def bare_wire(
    length: float, tension: float = 20e3, mass_per_length: float = 1.35, bending_stiffness: float = 195.0
) -> Catenary:
    """A contact wire pinned at both ends, without any connector."""
    return Catenary((Wire("contact", Kind.CONTACT_WIRE, 0.0, length, tension, mass_per_length, bending_stiffness),))


def simple_line(
    spans: int = 2,
    span: float = 60.0,
    droppers: tuple[float, ...] = DROPPERS_2002,
    damping: dict[Kind, Rayleigh] | None = None,
    carries_share: bool = True,
    dropper_stiffness: float = 1e5,
) -> Catenary:
    """Contact and messenger wire of the EN 50318:2002 reference model over a number of spans.

    The supports at the anchors only define the height of the messenger anchors.
    """
    end = spans * span
    masts = [number * span for number in range(1, spans)]
    return Catenary(
        wires=(
            Wire("contact", Kind.CONTACT_WIRE, 0.0, end, 20e3, 1.35, 195.0),
            Wire("messenger", Kind.MESSENGER_WIRE, 0.0, end, 16e3, 1.07, 131.7),
        ),
        droppers=tuple(
            Dropper(number * span + x, "messenger", "contact", stiffness=dropper_stiffness)
            for number in range(spans)
            for x in droppers
        ),
        steady_arms=tuple(
            SteadyArm(x, "contact", vertical_stiffness=300.0, carries_share=carries_share) for x in masts
        ),
        messenger_supports=tuple(MessengerSupport(number * span, "messenger", 1.2, 5e4) for number in range(spans + 1)),
        damping=damping or {},
    )


def overlapping_line(
    sections: int = 2, spans: int = 2, overlap: int = 1, rise: float = 0.3, section: Catenary | None = None
) -> Catenary:
    """Sections of `simple_line` or of another line; over the overlaps [spans] the wires rise to their anchors [m].

    The rise is a parabola that begins at the first support behind the middle of the overlap, seen from the anchor.
    """
    section = section or simple_line(spans)
    length = section.wires[0].end
    span = length / spans
    reach, step = (overlap + 1) // 2 * span, length - overlap * span

    def place(number: int) -> Catenary:
        """Section by its number; the first anchor and the last one of the line are not raised."""
        start = number * step
        anchors = [start] * (number > 0) + [start + length] * (number < sections - 1)
        return place_section(
            section, f"section {number + 1}", start,
            lambda x: sum(rise * max(0.0, 1 - abs(x - anchor) / reach) ** 2 for anchor in anchors),
        )  # fmt: skip

    return join_sections([place(number) for number in range(sections)])


def twin_line() -> Catenary:
    """Line with parallel contact wires of different tension."""
    catenary = simple_line(spans=2, span=40.0, droppers=(5.0, 15.0, 25.0, 35.0), damping=DAMPED)
    contact, messenger = catenary.wires
    second = replace(contact, name="second", tension=12e3)
    return replace(
        catenary,
        wires=(contact, second, messenger),
        droppers=catenary.droppers + tuple(replace(d, lower="second", stiffness=5e4) for d in catenary.droppers),
        steady_arms=catenary.steady_arms + tuple(replace(arm, wire="second") for arm in catenary.steady_arms),
    )


def fix_along_track(catenary: Catenary, axial_stiffness: float = 13.8e6) -> Catenary:
    """Fix the messenger wires at all supports along the track; a solid bar of 120 mm2 of bronze has this EA [N]."""
    supports = tuple(replace(support, along_track="fixed") for support in catenary.messenger_supports)
    return replace(
        catenary,
        wires=tuple(replace(wire, axial_stiffness=axial_stiffness) for wire in catenary.wires),
        messenger_supports=supports,
    )


def complex_roots(mass: Array, damping: Array, stiffness: Array, count: int) -> Array:
    """Lowest complex eigenvalues of M q'' + C q' + K q = 0 with positive imaginary part [1/s]."""
    n = len(mass)
    lower = [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]
    roots = eigvals(np.block([[np.zeros((n, n)), np.eye(n)], lower]))
    oscillating = roots[roots.imag > 0]
    return np.asarray(oscillating[np.argsort(np.abs(oscillating))][:count])


DAMPED = {
    Kind.CONTACT_WIRE: Rayleigh(0.05, 1e-4),
    Kind.MESSENGER_WIRE: Rayleigh(0.03, 3e-4),
    Kind.DROPPER: Rayleigh(0.2, 1e-3),
    Kind.STEADY_ARM: Rayleigh(0.4, 2e-3),
    Kind.MESSENGER_SUPPORT: Rayleigh(0.0, 5e-4),
}
"""A different damping for every kind of component, so that an exchange is noticed."""
