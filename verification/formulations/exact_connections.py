"""Bars and springs of a line: droppers, steady arms and messenger supports with their static forces."""

import numpy as np

from pantocheck.model import DiscretisedLine
from pantocheck.model.description.catenary import Kind
from pantocheck.model.discretisation.connectors import RIGID, arm_direction
from verification.formulations.exact_line import Array, Bars, Springs
from verification.formulations.exact_points import point_number


def build_bars(line: DiscretisedLine, position: Array) -> Bars:
    """Droppers, and steady arms if there is a lateral field."""
    droppers, state = line.catenary.droppers, line.state
    ends = [(point_number(line, d.lower, d.position), point_number(line, d.upper, d.position)) for d in droppers]
    stiffness = [d.taut_stiffness(float(rest)) for d, rest in zip(droppers, state.dropper_length, strict=True)]
    tension = list(state.dropper_tension)
    axial_damping = [line.catenary.rayleigh(Kind.DROPPER).stiffness_coefficient * k for k in stiffness]
    rotational_damping = [0.0] * len(droppers)
    if line.catenary.has_lateral_field:
        hinge = len(line.catenary.wires) * line.mesh.position.size
        for n, (arm, force) in enumerate(zip(line.catenary.steady_arms, state.arm_force, strict=True)):
            arm_tension = arm_direction(arm, force)[2]
            ends.append((point_number(line, arm.wire, arm.position), hinge + n))
            stiffness.append(RIGID)
            tension.append(arm_tension)
            axial_damping.append(0.0)
            beta = line.catenary.rayleigh(Kind.STEADY_ARM).stiffness_coefficient
            rotational_damping.append(beta * abs(arm.transverse_stiffness(arm_tension)))
    pairs = np.array(ends, dtype=np.int64).reshape(-1, 2)
    length = np.linalg.norm(position[:, pairs[:, 1]] - position[:, pairs[:, 0]], axis=0)
    return Bars(
        ends=pairs,
        stiffness=np.array(stiffness),
        length=length - np.array(tension) / np.array(stiffness),
        axial_damping=np.array(axial_damping),
        rotational_damping=np.array(rotational_damping),
        unilateral=np.arange(len(ends)) < len(droppers),
    )


def build_springs(line: DiscretisedLine, position: Array) -> Springs:
    """Messenger supports in y and z, and the vertical springs and dampers of steady arms."""
    points, stiffness, damping = [], [], []
    for support in line.catenary.messenger_supports:
        points.append(point_number(line, support.wire, support.position))
        stiffness.append((0.0, support.stiffness, support.stiffness))
        damping.append((0.0, support.damping, support.damping))
    for arm in line.catenary.steady_arms:
        k = arm.vertical_stiffness or 0.0
        points.append(point_number(line, arm.wire, arm.position))
        stiffness.append((0.0, 0.0, k))
        damping.append(
            (0.0, 0.0, arm.vertical_damper + line.catenary.rayleigh(Kind.STEADY_ARM).stiffness_coefficient * k)
        )
    point = np.array(points, dtype=np.int64)
    return Springs(point, np.array(stiffness).T.copy(), np.array(damping).T.copy(), position[:, point].copy())
