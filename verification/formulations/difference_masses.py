"""Lumped masses of the points of the second formulation, with mass-proportional damping and dampers to the ground."""

import numpy as np

from verification.formulations.difference_line import Line
from verification.formulations.difference_strands import Floats, Strand, Strands, size

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
