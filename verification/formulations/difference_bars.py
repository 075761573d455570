"""Bars of the second formulation: droppers, steady arms and messenger supports, linearised about the state of rest.

Points are too flexible under a point force by their excess flexibility, so every bar is stiffened by it:
1 / k' = 1 / k - excess. Across its length, a loaded bar has the stiffness tension over length.
"""

import numpy as np

from verification.formulations.difference_line import Line
from verification.formulations.difference_rest import Bar, Rest, join
from verification.formulations.difference_strands import Floats, Strands

STIFFNESS = {"z": "vertical_stiffness_N_m", "y": "lateral_stiffness_N_m"}
"""Stiffnesses of a messenger support by direction."""


def build_bars(line: Line, strands: Strands, rest: Rest) -> list[Bar]:
    """Droppers, steady arms across their length and messenger supports, linearised about the state of rest."""
    table, axes = line.inputs["droppers"], "yz" if line.staggered else "z"
    beta, bars = line.derived["droppers"]["stiffness_coefficient_s"], []
    length = rest.dropper_length
    for i, dropper in enumerate(line.droppers):
        (y, z), x = rest.dropper_extent[i] / length[i], dropper.position
        tension = rest.dropper_force[i] * length[i] / rest.dropper_extent[i, 1]
        k = table["stiffness_N_m"] or table["axial_stiffness_EA_N"] / length[i]
        k /= 1 - k * (strands[dropper.upper, "z"].excess_at(x) + strands["contact", "z"].excess_at(x))
        for direction, stiffness, taut_only in (((y, z), k, True), ((z, -y), tension / length[i], False)):
            if taut_only or line.staggered:
                parts = [
                    (sign * component, strands[wire, axis].weights(x))
                    for axis, component in zip("yz", direction, strict=True)
                    for wire, sign in ((dropper.upper, 1.0), ("contact", -1.0))
                    if axis in axes
                ]
                damping, preload = (beta * stiffness, tension) if taut_only else (0.0, 0.0)
                bars.append(Bar(x, *join(*parts), float(stiffness), float(damping), float(preload), taut_only))
    bars += _arm_bars(line, strands, rest)
    for spring in line.derived.get("wire_springs") or []:
        x, k = spring["position_m"], spring["stiffness_N_m"]
        upper, lower = strands["messenger", "z"], strands["contact", "z"]
        ends = join((1.0, upper.weights(x)), (-1.0, lower.weights(x)))
        stiffness = k / (1 - k * (upper.excess_at(x) + lower.excess_at(x)))
        bars.append(Bar(x, *ends, stiffness, spring["damping_N_s_m"]))
    for axis in axes:
        strand = strands["messenger", axis]
        for x, k in zip(line.supports, line.by_support("messenger_supports", STIFFNESS[axis]), strict=True):
            bars.append(Bar(x, *strand.weights(x), k / (1 - k * strand.excess_at(x))))
    return sorted(bars, key=lambda bar: bar.position)


def arm_directions(rest: Rest) -> Floats:
    """Direction (y, z) of every steady arm, along its force on the contact wire."""
    return rest.arm_force / np.hypot(*rest.arm_force.T)[:, None]


def _arm_bars(line: Line, strands: Strands, rest: Rest) -> list[Bar]:
    """Stiffness of the arms across their length: axial force over length, or the vertical stiffness of the file."""
    beta, bars = line.derived["steady_arms"]["stiffness_coefficient_s"], []
    for i, (x, arm) in enumerate(zip(line.supports, line.arms, strict=True)):
        if arm["vertical_stiffness_N_m"] is not None:
            k, parts = arm["vertical_stiffness_N_m"], [(1.0, strands["contact", "z"].weights(x))]
        elif line.staggered and arm["length_m"] is not None and arm["acts"] == "pull":
            k = float(np.hypot(*rest.arm_force[i])) / arm["length_m"]
            y, z = arm_directions(rest)[i]
            parts = [(z, strands["contact", "y"].weights(x)), (-y, strands["contact", "z"].weights(x))]
        else:
            raise ValueError("the second formulation has pulling arms with a length, or a vertical stiffness")
        bars.append(Bar(x, *join(*parts), float(k), float(beta * k)))
    return bars
