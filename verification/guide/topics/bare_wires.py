"""Wires without connectors, and a short line, on which closed forms hold."""

from pantocheck.model import Catenary, Dropper, Kind, MessengerSupport, SteadyArm, Wire

WIRE_TENSION, WIRE_MASS, WIRE_BENDING = 20e3, 1.35, 195.0
"""Tension [N], mass per length [kg/m] and bending stiffness [N m2] of a contact wire."""


def build_wire(length: float, tension: float = WIRE_TENSION, bending_stiffness: float = WIRE_BENDING) -> Catenary:
    """A contact wire of a length [m], pinned at both ends, with a tension [N] and a bending stiffness [N m2]."""
    return Catenary((Wire("contact", Kind.CONTACT_WIRE, 0.0, length, tension, WIRE_MASS, bending_stiffness),))


def build_short_line(spans: int) -> Catenary:
    """Contact wire and messenger wire with five droppers per span of 44 m; level contact wire."""
    span, end = 44.0, 44.0 * spans
    return Catenary(
        wires=(
            Wire("contact", Kind.CONTACT_WIRE, 0.0, end, WIRE_TENSION, WIRE_MASS, WIRE_BENDING),
            Wire("messenger", Kind.MESSENGER_WIRE, 0.0, end, 16e3, 1.07, 131.7),
        ),
        droppers=tuple(
            Dropper(number * span + x, "messenger", "contact", stiffness=1e5)
            for number in range(spans)
            for x in (4.0, 14.0, 24.0, 32.0, 40.0)
        ),
        steady_arms=tuple(
            SteadyArm(number * span, "contact", vertical_stiffness=300.0, carries_share=True)
            for number in range(1, spans)
        ),
        messenger_supports=tuple(MessengerSupport(number * span, "messenger", 1.2, 5e4) for number in range(spans + 1)),
    )
