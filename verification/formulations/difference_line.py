"""Arrays of the time step of the second formulation: the line and the pantographs."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from verification.formulations.difference_strands import Floats, Indices, Wire


class Lines(NamedTuple):
    """Arrays of the line; G strands, N points in all, B bars, R stretches of another tension, C clamps, A arms."""

    step: float
    """Time step [s]."""
    first: Indices
    count: Indices
    """First point and number of points of every strand, (G,)."""
    start: Floats
    spacing: float
    """Position of the first point and spacing of the points, (G,) [m]."""
    string: Floats
    bending: Floats
    """T / h and B / h^3 of every strand, (G,) [N/m]."""
    delay: Floats
    """Stiffness-proportional damping coefficient of every strand, (G,) [s]."""
    strand_keep: Floats
    strand_gain: Floats
    """v = keep v + gain f at the inner points of every strand, (G,) [-, s/kg]."""
    keep: Floats
    gain: Floats
    """v = keep v + gain f, with the lumped mass and the centred damping of every point, (N,) [-, s/kg]."""
    special: Indices
    """Points with other values than the inner points of their strand, (S,)."""
    special_strand: Indices
    """Their strands, (S,)."""
    bar_first: Indices
    bar_point: Indices
    bar_coefficient: Floats
    """Points and coefficients of bar b: bar_first[b] ... bar_first[b + 1] - 1."""
    bar_stiffness: Floats
    bar_damping: Floats
    bar_preload: Floats
    """Properties of the bars, (B,); the preload of a bar that acts in both directions is huge [N/m, N s/m, N]."""
    relief: Indices
    """First and last point of stretches with another tension, (R, 2)."""
    relief_string: Floats
    """Change of the tension over the spacing, (R,) [N/m]."""
    tie: Indices
    """Point of the messenger, end point of the stitch wire, and its inward neighbour's direction, +1 or -1, (C, 3)."""
    tie_strand: Indices
    """Strand of the stitch wire, (C,)."""
    arm: Indices
    """Lateral and vertical point of every arm, (A, 2)."""
    arm_direction: Floats
    """Direction of every arm (y, z), (A, 2) [-]."""
    contact: int
    """Number of the vertical strand of the contact wire."""
    lateral: int
    """Number of its lateral strand; -1 without stagger."""
    excess: Floats
    """Excess flexibility of the contact wire, see `difference_strands.excess_flexibility`, (4,) [m/N]."""
    rest: Floats
    """Shape at rest that a head feels, with the irregularity of the contact wire, (N,) [m]."""


class Heads(NamedTuple):
    """Pantographs of a train, M z'' + C z' + K z = load - contact forces - forces of joints.

    P pantographs, n unknowns, S strips, J joints; the joints are friction and stops.
    """

    position: Floats
    speed: float
    """Positions of the pantographs, (P,) [m], and their speed [m/s]."""
    mass: Floats
    """Diagonal of M, (P, n)."""
    stiffness: Floats
    damping: Floats
    """K and C, (P, n, n)."""
    load: Floats
    """Uplift force, and forces of the springs at z = 0, (P, n)."""
    offset: Floats
    """Distance of each strip ahead of the position, (P, S) [m]."""
    shape: Floats
    """Displacement of each strip per unknown and power of the lateral position of the wire, (P, S, powers, n)."""
    contact_stiffness: float
    height: Floats
    velocity: Floats
    """Displacements z and velocities, (P, n)."""
    contact_damping: float = 0.0
    hertz: float = np.inf
    """Damper beside the contact spring [N s/m], and coefficient of Hertz's law in place of it [N/m^1.5]."""
    joint: Floats = np.zeros((1, 0, 1))
    """Closing of each joint per unknown, (P, J, n)."""
    joint_law: Floats = np.zeros((1, 0, 5))
    """Stiffness, damper, gap, lower and upper bound of each joint, (P, J, 5) [N/m, N s/m, m, N, N]."""


# Line of the second formulation: wires, droppers, arms, supports and clamps from the case that a program receives.
#
# The case is the JSON object `case` of the message `run`, see docs/systems.md: inputs and the derived values beside
# them. Everything else is solved again, and nothing of the reference simulator is used.
CaseData = dict[str, Any]
"""Case of a message `run`."""

FEATURES = frozenset(
    (
        "applied_forces", "bending_modes", "bending_stiffness", "chain", "contact_damping", "contact_laws", "curves",
        "dropper_mass", "droppers", "friction", "gradients", "head_pitch", "head_roll", "irregularity", "line_at_rest",
        "listed_spans", "point_masses", "presag", "pushing_steady_arms", "rayleigh_damping", "several_pantographs",
        "single_supports", "stagger", "steady_arm_dampers", "steady_arm_mass", "steady_arms", "stitch_wire", "stops",
        "support_dampers", "surveyed_wire_heights", "two_strips", "uplift_force_tuning", "variation", "wire_height",
        "wire_springs",
    )
)  # fmt: skip
"""Features of a case that the second formulation has."""


@dataclass(frozen=True)
class Dropper:
    """Dropper at a position [m] under a wire, the height of the contact wire there [m], and its mass [kg]."""

    position: float
    upper: str
    height: float
    mass: float


class PointMass(NamedTuple):
    """Mass on a wire: position [m], wire, mass [kg] and mass-proportional damping [1/s]."""

    position: float
    wire: str
    mass: float
    mass_coefficient: float


@dataclass(frozen=True)
class Line:
    """Line of a case: its wires, the places of its parts, and the tables of the inputs and of the derived values."""

    inputs: CaseData
    derived: CaseData
    wires: tuple[Wire, ...]
    droppers: tuple[Dropper, ...]
    clamps: tuple[tuple[float, str], ...]

    @property
    def staggered(self) -> bool:
        """Whether the line moves sideways as well."""
        return self.derived["contact_wire"]["lateral_position_m"] is not None

    @property
    def point_masses(self) -> list[PointMass]:
        """Masses on the wires."""
        listed = self.derived.get("point_masses") or []
        keys = ("position_m", "wire", "mass_kg", "mass_coefficient_1_s")
        rows = ([part[key] for key in keys] for part in listed)
        return [PointMass(x, wire.removesuffix("_wire"), mass, alpha) for x, wire, mass, alpha in rows]

    @property
    def gravity(self) -> float:
        """Acceleration of gravity [m/s2]."""
        return float(self.derived["gravity_m_s2"])

    @property
    def span_limits(self) -> tuple[float, ...]:
        """Positions of anchors and supports [m]."""
        return tuple(self.derived["span_limits_m"])

    @property
    def supports(self) -> tuple[float, ...]:
        """Positions of the supports [m]."""
        return tuple(self.derived["steady_arms"]["position_m"])

    @property
    def arms(self) -> list[CaseData]:
        """Steady arm of every support: that of the line, with the values of the support in place of its own."""
        own = {support["number"]: support["steady_arm"] or {} for support in self._own_supports}
        given = [own.get(number, {}).items() for number in range(1, len(self.supports) + 1)]
        return [self.inputs["steady_arm"] | {key: value for key, value in arm if value is not None} for arm in given]

    @property
    def contact_heights(self) -> Floats:
        """Prescribed height of the contact wire at anchors and supports [m]."""
        geometry, last = self.inputs["geometry"], len(self.span_limits) - 1
        own = {support["number"]: support["contact_wire_height_m"] for support in self._own_supports}
        heights = []
        for number, x in enumerate(self.span_limits):
            neighbour = min(max(number, 1), last - 1)
            given = [own.get(number), own.get(neighbour), geometry.get("contact_wire_height_m", 0.0)]
            rise = (
                g["slope"] * (min(max(x, g["from_m"]), g["to_m"]) - g["from_m"]) for g in geometry.get("gradient", [])
            )
            heights.append(next(height for height in given if height is not None) + sum(rise))
        return np.array(heights)

    def irregularity(self, x: Floats) -> Floats:
        """Heights that a head feels in addition to those of the wire at positions (n,) [m]."""
        points = self.derived["contact_wire"].get("irregularity")
        if points is None:
            return np.zeros_like(x)
        spline = CubicSpline(points["x_m"], points["height_m"], bc_type="clamped")
        return np.asarray(spline(np.clip(x, points["x_m"][0], points["x_m"][-1])))

    def curvature(self, x: Floats) -> Floats:
        """Curvature of the track at positions (n,) [1/m]: it rises linearly over the transitions."""
        total = np.zeros_like(x)
        for curve in self.derived.get("curves") or []:
            start, end, ramp = curve["from_m"], curve["to_m"], curve["transition_m"]
            corners = (start, start + ramp, end - ramp, end)
            total += curve["curvature_1_m"] * np.interp(x, corners, (0.0, 1.0, 1.0, 0.0), left=0.0, right=0.0)
        return total

    @property
    def _own_supports(self) -> list[CaseData]:
        own: list[CaseData] = self.inputs["geometry"].get("support", [])
        return own

    def by_support(self, table: str, key: str) -> Floats:
        """Derived value of every arm or messenger support; a program receives one number if all are equal."""
        return np.broadcast_to(self.derived[table][key], len(self.supports))

    @property
    def staggers(self) -> dict[str, tuple[tuple[float, float], ...]]:
        """Lateral positions (x, y) at anchors and supports by wire [m]."""
        return {
            name: tuple(zip(self.span_limits, self.derived[f"{name}_wire"]["lateral_position_m"][0], strict=True))
            for name in ("contact", "messenger")
        }


def build_line(case: CaseData) -> Line:
    """Line of a case with one contact wire and one messenger wire."""
    inputs, derived = case["line"], case["derived"]["line"]
    if missing := sorted(set(case["features"]) - FEATURES):
        raise ValueError(f"the second formulation does not have {', '.join(missing)}")
    variation = inputs.get("variation") or {}
    changes = [(variation.get(wire) or {}).get("tension_change_share") for wire in ("contact_wire", "messenger_wire")]
    if variation.get("temperature_change_K") or any(changes):
        raise ValueError("the second formulation does not have tensions that change along a wire")
    messenger, stitch = inputs["messenger_wire"], derived["stitch_wires"]
    stretches = [] if stitch is None else list(zip(stitch["start_m"], stitch["end_m"], strict=True))
    change = 0.0 if stitch is None else stitch["messenger_tension_N"] - messenger["tension_N"]
    wires = [
        _wire(inputs, "contact", derived["contact_wire"]["start_m"], derived["contact_wire"]["end_m"]),
        _wire(
            inputs,
            "messenger",
            derived["messenger_wire"]["start_m"],
            derived["messenger_wire"]["end_m"],
            tuple((start, end, change) for start, end in stretches),
        ),
        *(_wire(inputs, f"stitch {i}", start, end) for i, (start, end) in enumerate(stretches)),
    ]
    clamps = [(x, f"stitch {i}") for i, stretch in enumerate(stretches) for x in stretch]
    return Line(inputs, derived, tuple(wires), tuple(_droppers(derived, wires)), tuple(clamps))


def _droppers(derived: CaseData, wires: list[Wire]) -> list[Dropper]:
    keys = ("position_m", "on_stitch_wire", "contact_wire_height_m", "mass_kg")
    columns = [[value for span in derived["droppers"][key] for value in span] for key in keys]
    droppers = []
    for x, stitched, height, mass in zip(*columns, strict=True):
        name = next(wire.name for wire in wires[2:] if wire.start < x < wire.end) if stitched else "messenger"
        droppers.append(Dropper(x, name, height, mass))
    return droppers


def _wire(
    inputs: CaseData, name: str, start: float, end: float, relief: tuple[tuple[float, float, float], ...] = ()
) -> Wire:
    key = name.split(maxsplit=1)[0] + "_wire"
    table, damping = inputs[key], inputs["damping"][key]
    return Wire(
        name,
        start,
        end,
        table["tension_N"],
        table["bending_stiffness_N_m2"],
        table["mass_kg_m"],
        damping["mass_coefficient_1_s"],
        damping["stiffness_coefficient_s"],
        relief,
    )
