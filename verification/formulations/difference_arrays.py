"""Lumped masses of the points of the second formulation, with mass-proportional damping and dampers to the ground."""

from dataclasses import dataclass

import numpy as np

from verification.formulations.difference_bars import arm_directions, build_bars
from verification.formulations.difference_line import Line, Lines
from verification.formulations.difference_rest import Bar, Rest, Uplift, compute_rest, join, rows, ties
from verification.formulations.difference_strands import Floats, Strand, Strands, Weights, lay_out, size

DAMPER = {"z": "vertical_damper_N_s_m", "y": "lateral_damper_N_s_m"}
"""Dampers of a messenger support by direction."""


def lumped_masses(line: Line, strands: Strands) -> tuple[Floats, Floats]:
    """Mass [kg] and damper to the ground [N s/m] of every point."""
    mass, damper = np.zeros(size(strands)), np.zeros(size(strands))
    droppers, alpha_of_arms = line.derived["droppers"], line.derived["steady_arms"]["mass_coefficient_1_s"]

    def add(strand: Strand, x: float, value: float, coefficient: float) -> None:
        s = (x - strand.wire.start) / strand.spacing
        i = min(int(s + 1e-9), strand.count - 2)
        for point, share in ((strand.first + i, 1 - (s - i)), (strand.first + i + 1, s - i)):
            mass[point] += share * value
            damper[point] += share * value * coefficient

    for (name, axis), strand in strands.items():
        inner = slice(strand.first + 1, strand.first + strand.count - 1)
        mass[inner] += strand.wire.mass_per_length * strand.spacing
        damper[inner] += strand.wire.mass_coefficient * strand.wire.mass_per_length * strand.spacing
        if name == "contact":
            masses, dampers = (line.by_support("steady_arms", key) for key in ("mass_kg", "vertical_damper_N_s_m"))
            for x, arm_mass, arm_damper in zip(line.supports, masses, dampers, strict=True):
                add(strand, x, float(arm_mass), alpha_of_arms)
                damper[strand.point(x)] += arm_damper if axis == "z" else 0.0
        elif name == "messenger":
            for x, support_damper in zip(
                line.supports, line.by_support("messenger_supports", DAMPER[axis]), strict=True
            ):
                damper[strand.point(x)] += support_damper
    for part in line.point_masses:
        for axis in "zy" if line.staggered else "z":
            add(strands[part.wire, axis], part.position, part.mass, part.mass_coefficient)
    alpha = droppers["mass_coefficient_1_s"]
    axes = "zy" if line.staggered else "z"
    for axis in axes:
        for dropper in line.droppers:
            half = dropper.mass / 2
            add(strands[dropper.upper, axis], dropper.position, half + droppers["upper_clamp_kg"], alpha)
            add(strands["contact", axis], dropper.position, half + droppers["lower_clamp_kg"], alpha)
        for x, name in line.clamps:
            wire, messenger = strands[name, axis].wire, strands["messenger", axis]
            stitch = line.derived["stitch_wires"]
            add(messenger, x, stitch["clamp_mass_kg"], stitch["mass_coefficient_1_s"])
            add(messenger, x, wire.mass_per_length * messenger.spacing / 2, wire.mass_coefficient)
    return mass, damper


# Arrays of the time step from the line: lumped masses, centred damping, bars, ties and arms.
STEP_PER_AREA = 0.0128
"""Time step over the square of the spacing [s/m2]: the whole scheme is of second order in the spacing."""
NEVER_SLACK = 1e300
"""Tension at rest of a bar that acts in both directions [N]."""


@dataclass(frozen=True)
class Model:
    """Line at rest on its points: arrays of the time step and the static solution."""

    line: Line
    strands: Strands
    rest: Rest
    uplift: Uplift
    arrays: Lines

    @property
    def contact(self) -> Strand:
        """Vertical strand of the contact wire."""
        return self.strands["contact", "z"]

    def point_load(self, x: float, force: float) -> Floats:
        """Load vector of a vertical force on the contact wire at a position [m, N]."""
        load = np.zeros(self.rest.shape.size)
        points, weights = self.contact.weights(x)
        load[points] = force * weights
        return load

    def lift(self, x: float, displacement: Floats) -> float:
        """Vertical displacement of the contact wire at a position [m]."""
        points, weights = self.contact.weights(x)
        return float(weights @ displacement[points])

    def static_uplift(self, x: float, force: float) -> float:
        """Uplift of the contact wire under a static force at a position, corrected for the points [m]."""
        displacement = self.uplift.displacement(self.point_load(x, force))
        return self.lift(x, displacement) - force * self.contact.excess_at(x)


def build_model(line: Line, spacing: float) -> Model:
    """Model of a line with points `spacing` apart [m]."""
    strands = lay_out(line.wires, "zy" if line.staggered else "z", spacing)
    rest = compute_rest(line, strands)
    bars = build_bars(line, strands, rest)
    n = size(strands)
    stiffness = sum(strand.stiffness(n) for strand in strands.values())
    uplift = Uplift(stiffness, bars, rows(_held(line, strands, rest), n))
    return Model(line, strands, rest, uplift, _arrays(line, strands, rest, bars))


def _add_irregularity(line: Line, strands: Strands, rest: Rest) -> Floats:
    """Shape at rest with the irregularity of the contact wire."""
    shape, contact = rest.shape.copy(), strands["contact", "z"]
    x = contact.wire.start + contact.spacing * np.arange(contact.count)
    shape[contact.first : contact.first + contact.count] += line.irregularity(x)
    return shape


def _held(line: Line, strands: Strands, rest: Rest) -> list[Weights]:
    """Sums of displacements that are zero: at anchors, between tied points, and along the arms."""
    held = []
    for (name, _axis), strand in strands.items():
        if name in {"contact", "messenger"}:
            held += [strand.weights(strand.wire.start), strand.weights(strand.wire.end)]
    for axis in "zy" if line.staggered else "z":
        held += ties(line, strands, axis)
    if line.staggered:
        for x, (y, z) in zip(line.supports, arm_directions(rest), strict=True):
            held.append(join((y, strands["contact", "y"].weights(x)), (z, strands["contact", "z"].weights(x))))
    return held


def _arrays(line: Line, strands: Strands, rest: Rest, bars: list[Bar]) -> Lines:
    parts = list(strands.values())
    h = parts[0].spacing
    step = STEP_PER_AREA * h**2
    mass, damper = lumped_masses(line, strands)
    with np.errstate(divide="ignore", invalid="ignore"):
        half = np.nan_to_num(step * damper / (2 * mass))
        gain = np.where(mass > 0, step / mass / (1 + half), 0.0)
    keep = (1 - half) / (1 + half)
    wires = [part.wire for part in parts]
    strand_half = np.array([step * wire.mass_coefficient / 2 for wire in wires])
    strand_gain = np.array([step / (wire.mass_per_length * h) for wire in wires]) / (1 + strand_half)
    special, owner = [], []
    for g, part in enumerate(parts):
        inner = np.arange(part.first + 1, part.first + part.count - 1)
        other = np.abs(gain[inner] / strand_gain[g] - 1) > 1e-9
        other |= np.abs(keep[inner] - (1 - strand_half[g]) / (1 + strand_half[g])) > 1e-12
        other[[0, -1]] = True
        special += list(inner[other])
        owner += [g] * int(other.sum())
    relief = [
        ((part.point(start), part.point(end)), change / h) for part in parts for start, end, change in part.wire.relief
    ]
    names = list(strands)
    tied = []
    for axis in "zy" if line.staggered else "z":
        for x, name in line.clamps:
            stitch = strands[name, axis]
            inward = 1 if abs(x - stitch.wire.start) < 1e-9 else -1
            tied.append((strands["messenger", axis].point(x), stitch.point(x), inward, names.index((name, axis))))
    arms = [
        (strands["contact", "y"].point(x), strands["contact", "z"].point(x)) for x in line.supports if line.staggered
    ]
    return Lines(
        step=step,
        first=np.array([part.first for part in parts]),
        count=np.array([part.count for part in parts]),
        start=np.array([wire.start for wire in wires]),
        spacing=h,
        string=np.array([wire.tension / h for wire in wires]),
        bending=np.array([part.bending_stiffness / h**3 for part in parts]),
        delay=np.array([wire.stiffness_coefficient for wire in wires]),
        strand_keep=(1 - strand_half) / (1 + strand_half),
        strand_gain=strand_gain,
        keep=keep,
        gain=gain,
        special=np.array(special),
        special_strand=np.array(owner),
        bar_first=np.cumsum([0] + [bar.points.size for bar in bars]),
        bar_point=np.concatenate([bar.points for bar in bars]),
        bar_coefficient=np.concatenate([bar.coefficients for bar in bars]),
        bar_stiffness=np.array([bar.stiffness for bar in bars]),
        bar_damping=np.array([bar.damping for bar in bars]),
        bar_preload=np.array([bar.preload if bar.unilateral else NEVER_SLACK for bar in bars]),
        relief=np.array([points for points, _ in relief], dtype=np.int64).reshape(-1, 2),
        relief_string=np.array([string for _, string in relief], dtype=float),
        tie=np.array([row[:3] for row in tied], dtype=np.int64).reshape(-1, 3),
        tie_strand=np.array([row[3] for row in tied], dtype=np.int64),
        arm=np.array(arms if line.staggered else [], dtype=np.int64).reshape(-1, 2),
        arm_direction=arm_directions(rest) if line.staggered else np.zeros((0, 2)),
        contact=names.index(("contact", "z")),
        lateral=names.index(("contact", "y")) if line.staggered else -1,
        excess=strands["contact", "z"].excess,
        rest=_add_irregularity(line, strands, rest),
    )
