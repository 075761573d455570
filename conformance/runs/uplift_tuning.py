"""Tuning of the uplift forces to the mean contact forces that a case requires."""

import math
from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.lift_force import LiftForce
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.runs.static_quantities import sample_span
from pantocheck.model import DiscretisedLine, Pantograph
from pantocheck.model.description.failures import SimulationError
from pantocheck.model.description.pantograph import equilibrium
from pantocheck.model.discretisation.discretised_line import keep_with_line
from pantocheck.model.fem.beam import wave_speed
from pantocheck.model.statics.elasticity import rest_height, static_uplift

TOLERANCE = 0.02
"""Largest difference between a tuned mean contact force and its target [N]."""
MAX_RUNS = 12

START_SLOPE = 0.955
"""Change of the mean contact force per change of the uplift force before the second run [-].

Measured on the cases of EN 50318:2018 with one and two pantographs at 275 and 320 km/h: 0.945 to 0.975, middle 0.955.
"""


class TuningFailed(SimulationError):
    """No uplift force gives the target; a run with another mean contact force must not be graded."""


TunedRun = TypeVar("TunedRun")


def tune_uplift(
    run: Callable[[tuple[float, ...]], TunedRun],
    mean_forces: Callable[[TunedRun], RealArray],
    start: Sequence[float],
    targets: Sequence[float | None],
) -> TunedRun:
    """Tune the uplift forces by the secant method, each pantograph with its own slope.

    Args:
        run: Function that simulates the passage for given uplift forces [N].
        mean_forces: Function that gives the mean contact force of every pantograph of a run [N].
        start: Uplift forces of the first run [N].
        targets: Target of every mean contact force [N]; None: the uplift force remains.

    Returns:
        The run that meets the targets.

    Raises:
        TuningFailed: None of the first `MAX_RUNS` runs meets the targets.
    """
    target = np.array([np.nan if value is None else value for value in targets])
    has_target = np.isfinite(target)
    forces = np.array(start, dtype=float)
    slope = np.full(forces.size, START_SLOPE)
    tuned = run(tuple(map(float, forces)))
    means = mean_forces(tuned)
    for run_count in range(1, MAX_RUNS + 1):
        error = np.where(has_target, target - means, 0.0)
        if np.abs(error).max(initial=0.0) <= TOLERANCE:
            return tuned
        if run_count == MAX_RUNS:
            break
        change = error / slope
        forces = forces + change
        tuned = run(tuple(map(float, forces)))
        new_means = mean_forces(tuned)
        # A quotient far from 1 is an effect of the other pantographs, hence the clip.
        moved = np.abs(change) > TOLERANCE / 10
        quotient = np.divide(new_means - means, change, out=slope.copy(), where=moved)
        slope, means = np.clip(quotient, 0.5, 2.0), new_means
    worst = int(np.nanargmax(np.abs(target - means)))
    raise TuningFailed(
        f"pantograph {worst + 1}: after {MAX_RUNS} runs the mean contact force is {means[worst]:.2f} N, "
        f"its target_mean_force_N is {target[worst]:.2f} N"
    )


# Estimate of the uplift force that gives a mean contact force: the start of the tuning.
#
# A string of tension T and mass per length m lies on an elastic foundation of stiffness k. Under a force that moves at
# the speed v it has the tension T (1 - v^2 / c^2) in the moving frame, with c^2 = T / m. The deflection under the
# force, F / (2 sqrt(T k)) at rest, therefore grows by 1 / sqrt(1 - v^2 / c^2). The mean uplift of the contact wire is
# estimated as its mean static uplift times this factor. The uplift force follows from the equilibrium of the pantograph
# with its head at this mean height.
HIGHEST_SPEED_RATIO = 0.9
"""Highest speed over wave speed in the factor: near the wave speed it grows without limit, unlike a real uplift."""

FORCE_STEP = 1.0
"""Difference of two uplift forces, between which the contact force at a given height is linear [N]."""


def estimate_uplift_forces(case: Case, line: DiscretisedLine) -> tuple[float, ...]:
    """Uplift forces of a case: stated, or estimated from a stated mean contact force.

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
        return float(equilibrium(pantograph, wire + case.pantographs[index].penetration(target))[1].sum())

    at_target = contact_force(target)
    slope = (contact_force(target + FORCE_STEP) - at_target) / FORCE_STEP
    return target + (target - at_target) / slope


# Working height of the pantographs of a case: the static height of a head under its uplift force.
def build_pantographs(case: Case, line: DiscretisedLine, uplift_forces: Sequence[float]) -> tuple[Pantograph, ...]:
    """Pantographs of a case, each with its working height under its uplift force [N]."""
    nominal = nominal_wire_height(case)
    return tuple(
        build_pantograph(file, force, compute_working_height(case, line, file, force), nominal, lift.aerodynamic_force)
        for file, lift, force in zip(case.pantographs, case.lift_forces, uplift_forces, strict=True)
    )


def working_height_positions(case: Case) -> RealArray:
    """Positions of the mean uplift for the working height: those of the first span of the analysis section [m]."""
    return sample_span(*case.line.geometry.span(case.analysed_spans[0]))


def nominal_wire_height(case: Case) -> float:
    """Nominal height of the contact wire, the mean over `working_height_positions` [m].

    It is the mean of the straight lines between the supports, in an overlap of those of the lowest wire.
    """
    positions = working_height_positions(case)
    rises = [case.line.lowest_rise(float(x)) for x in positions]
    return float(case.line.layout.chord_height(positions).mean() + np.mean(rises))


def compute_working_height(case: Case, line: DiscretisedLine, file: PantographFile, uplift_force: float) -> float:
    """Static height of a head under its uplift force: nominal height of the wire, mean uplift, and penetration [m].

    The pre-sag of the line at rest is left out.

    Args:
        case: Case with a speed.
        line: Line of the case.
        file: Pantograph.
        uplift_force: Its uplift force [N].
    """
    uplift = mean_static_uplift(line, tuple(working_height_positions(case).tolist()), uplift_force)
    return nominal_wire_height(case) + (uplift + file.penetration(uplift_force))


@keep_with_line
def mean_static_uplift(line: DiscretisedLine, positions: tuple[float, ...], force: float) -> float:
    """Mean uplift under a static force [N] at each of some positions in turn [m]."""
    return float(static_uplift(line, np.array(positions), force).mean())
