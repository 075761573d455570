"""Estimate of the uplift force that gives a mean contact force: the start of the tuning.

A string of tension T and mass per length m lies on an elastic foundation of stiffness k. Under a force that moves at
the speed v it has the tension T (1 - v^2 / c^2) in the moving frame, with c^2 = T / m. The deflection under the force,
F / (2 sqrt(T k)) at rest, therefore grows by 1 / sqrt(1 - v^2 / c^2). The mean uplift of the contact wire is estimated
as its mean static uplift times this factor. The uplift force follows from the equilibrium of the pantograph with its
head at this mean height.
"""

import math

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.lift_force import LiftForce
from pantocheck.conformance.simulation.working_height import build_pantographs, working_height_positions
from pantocheck.model import DiscretisedLine
from pantocheck.model.fem.beam import wave_speed
from pantocheck.model.pantograph import equilibrium
from pantocheck.model.statics.elasticity import rest_height, static_uplift

HIGHEST_SPEED_RATIO = 0.9
"""Highest speed over wave speed in the factor: near the wave speed it grows without limit, unlike a real uplift."""

FORCE_STEP = 1.0
"""Difference of two uplift forces, between which the contact force at a given height is linear [N]."""


def estimate_uplift_forces(case: Case, line: DiscretisedLine) -> tuple[float, ...]:
    """Estimate the uplift forces of a case: those that it states, and for a mean contact force the estimate.

    Args:
        case: Case with a speed.
        line: Line of the case.

    Returns:
        Uplift force of every pantograph [N].

    Raises:
        NoEquilibrium: The line has no equilibrium under a mean contact force.
    """
    return tuple(_estimate_uplift_force(case, line, index, lift) for index, lift in enumerate(case.lift_forces))


def moving_factor(speed: float, line: DiscretisedLine) -> float:
    """Mean uplift of the contact wire under a moving force over its static uplift [-]; speed in [m/s]."""
    wire = line.catenary.contact_wires[0]
    ratio = min(speed / wave_speed(wire.tension, wire.mass_per_length), HIGHEST_SPEED_RATIO)
    return 1 / math.sqrt(1 - ratio**2)


def _estimate_uplift_force(case: Case, line: DiscretisedLine, index: int, lift: LiftForce) -> float:
    """Stated or estimated uplift force of one pantograph [N]."""
    target = lift.target_mean_force
    if target is None or lift.stated_uplift_force is not None:
        return lift.uplift_force
    positions = working_height_positions(case)
    uplift = moving_factor(case.speed, line) * float(static_uplift(line, positions, target).mean())
    wire = float(rest_height(line, positions).mean()) + uplift

    def contact_force(uplift_force: float) -> float:
        """Contact force that holds the head at its mean height [N]."""
        pantograph = build_pantographs(case, line, [uplift_force] * len(case.lift_forces))[index]
        return equilibrium(pantograph, wire + target / pantograph.contact_stiffness)[1]

    at_target = contact_force(target)
    slope = (contact_force(target + FORCE_STEP) - at_target) / FORCE_STEP
    return target + (target - at_target) / slope
