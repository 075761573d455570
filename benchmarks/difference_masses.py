"""Lumped masses of the points of the second formulation, with mass-proportional damping and dampers to the ground."""

import numpy as np
from difference_line import Line
from difference_rest import Rest
from difference_strands import Floats, Strand, Strands, size


def lumped_masses(line: Line, strands: Strands, rest: Rest) -> tuple[Floats, Floats]:
    """Mass [kg] and damper to the ground [N s/m] of every point."""
    mass, damper = np.zeros(size(strands)), np.zeros(size(strands))
    file, table = line.file, line.file.droppers

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
            for x in line.supports:
                add(strand, x, line.arm_mass, file.damping.steady_arms.mass_coefficient_1_s)
                damper[strand.point(x)] += file.steady_arm.vertical_damper_N_s_m if axis == "z" else 0.0
        elif name == "messenger":
            for x in line.supports:
                damper[strand.point(x)] += file.messenger_support.damping_N_s_m
    alpha = file.damping.droppers.mass_coefficient_1_s
    axes = "zy" if line.staggered else "z"
    for axis in axes:
        for dropper, weight in zip(line.droppers, rest.dropper_mass, strict=True):
            add(strands[dropper.upper, axis], dropper.position, weight / 2 + table.clamp_on_messenger_kg, alpha)
            add(strands["contact", axis], dropper.position, weight / 2 + table.clamp_on_contact_kg, alpha)
        for x, name in line.clamps:
            wire, messenger = strands[name, axis].wire, strands["messenger", axis]
            add(messenger, x, file.stitch_wire.clamp_kg, alpha)
            add(messenger, x, wire.mass_per_length * messenger.spacing / 2, wire.mass_coefficient)
    return mass, damper
