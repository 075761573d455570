"""Line of the second formulation: wires, droppers, arms, supports and clamps from the data of a case."""

from dataclasses import dataclass

from difference_strands import Wire

from pantocheck.conformance.cases.line_file import LineFile

GRAVITY = 9.81
"""Acceleration of gravity [m/s2]."""


@dataclass(frozen=True)
class Dropper:
    """Dropper at a position [m] under a wire, and the height of the contact wire there [m]."""

    position: float
    upper: str
    height: float


@dataclass(frozen=True)
class Line:
    """Line of a case: its wires, the places of its parts, and the tables of its file."""

    file: LineFile
    wires: tuple[Wire, ...]
    droppers: tuple[Dropper, ...]
    clamps: tuple[tuple[float, str], ...]
    staggered: bool

    @property
    def supports(self) -> tuple[float, ...]:
        """Positions of the supports [m]."""
        return self.file.geometry.supports

    @property
    def arm_mass(self) -> float:
        """Mass of a hinged bar at its free end, a third, and of its clamp [kg]."""
        arm = self.file.steady_arm
        return arm.mass_kg_m * (arm.length_m or 0.0) / 3 + arm.clamp_kg

    @property
    def staggers(self) -> dict[str, tuple[tuple[float, float], ...]]:
        """Lateral positions (x, y) at anchors and supports, which alternate in sign, by wire [m]."""
        geometry = self.file.geometry
        amplitudes = {"contact": geometry.stagger_contact_wire_m, "messenger": geometry.stagger_messenger_m}
        return {
            name: tuple((x, a * (-1) ** i) for i, x in enumerate(geometry.span_limits))
            for name, a in amplitudes.items()
        }


def build_line(file: LineFile) -> Line:
    """Line of a line file with one contact wire and one messenger wire."""
    if file.contact_wire.number != 1 or file.messenger_wire.number != 1 or file.damping.modal:
        raise ValueError("the second formulation has one contact wire, one messenger wire and no modal damping")
    geometry, stitch = file.geometry, file.stitch_wire
    half = 0.0 if stitch is None else stitch.length_m / 2
    relief = () if stitch is None else tuple((x - half, x + half, -stitch.tension_N) for x in geometry.supports)
    wires = [
        _wire(file, "contact", 0.0, geometry.length),
        _wire(file, "messenger", 0.0, geometry.length, relief),
    ]
    clamps: list[tuple[float, str]] = []
    if stitch is not None:
        for i, x in enumerate(geometry.supports):
            wires.append(_wire(file, f"stitch {i}", x - half, x + half))
            clamps += [(x - half, f"stitch {i}"), (x + half, f"stitch {i}")]
    droppers = []
    for start in geometry.span_limits[:-1]:
        for x, sag in zip(file.droppers.x_m, file.droppers.presag_m or [0.0] * len(file.droppers.x_m), strict=True):
            position = start + x
            above = [wire.name for wire in wires[2:] if wire.start < position < wire.end]
            droppers.append(Dropper(position, above[0] if above else "messenger", -sag))
    staggered = geometry.stagger_contact_wire_m != 0 or geometry.stagger_messenger_m != 0
    return Line(file, tuple(wires), tuple(droppers), tuple(clamps), staggered)


def _wire(
    file: LineFile, name: str, start: float, end: float, relief: tuple[tuple[float, float, float], ...] = ()
) -> Wire:
    key = name.split(maxsplit=1)[0] + "_wire"
    table, damping = getattr(file, key), getattr(file.damping, key)
    return Wire(
        name,
        start,
        end,
        table.tension_N,
        table.bending_stiffness_N_m2,
        table.mass_kg_m,
        damping.mass_coefficient_1_s,
        damping.stiffness_coefficient_s,
        relief,
    )
