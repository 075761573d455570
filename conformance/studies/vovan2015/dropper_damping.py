"""Largest compensation force of a dropper against its stiffness coefficient.

Vo Van, Balmes and Lorang (2015), Figure 8. The matrices of the system hold every dropper as taut. While a dropper is
slack, a force compensates it. Two laws are compared:

* The elastic and the viscous force are compensated, as in the reference simulator: a slack dropper carries no force.
* Only the elastic force is compensated: the viscous force stays in the constant damping matrix. A large coefficient
  then locks the dropper, because its dashpot also resists compression.
"""

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DropperDamping
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, Mark, Series
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from pantocheck.conformance.quantities.evaluation import LINE, Value, ValuesByOwner
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.records.traces import thin_series
from pantocheck.conformance.runs.case_run import build_passage, build_run_table, integrate_passage, record_passage
from pantocheck.conformance.runs.system import Delivered, StudyResult
from pantocheck.conformance.studies.vovan2015.paper_tables import build_provenance_table
from pantocheck.model import Catenary, DiscretisedLine, Kind, Passage, Rayleigh, discretise
from pantocheck.model.discretisation.discretised_line import keep_viscous_part, with_damping

TRANSITION_SHARE = 0.1
"""Relative change of the force at the onset of the transition, and remaining share of the force at its end."""
KEPT_MARGIN_M = 5.0
"""Distance beyond the dropper to the end of the recorded motion, which a wave from the cut has reached [m]."""
SMALLEST_DRAWN_FORCE = 1.0
"""Smaller forces are drawn at this value on the logarithmic scale [N]."""
LAWS: dict[str, tuple[Callable[[DiscretisedLine], DiscretisedLine], float]] = {
    "slack dropper carries no force": (lambda line: line, 1.0),
    "only the elastic force is compensated": (keep_viscous_part, 0.0),
}
"""Compensation laws by name: function that gives a line the law, and compensated share of the viscous force."""
GRADED = "only the elastic force is compensated"


def run_dropper_damping(case: Case, study: DropperDamping) -> Delivered:
    """Run the passage of a case once for every coefficient and compensation law.

    Args:
        case: Passage with stated uplift forces.
        study: Dropper and its stiffness coefficients.

    Returns:
        Study with the record of the passage under the damping of the case.

    Raises:
        InputError: No dropper hangs at the position of the study, or a pantograph has no uplift force.
    """
    begin = time.perf_counter()
    discretisation, line = case.file.discretisation, build_catenary(case.line)
    dropper = _find_dropper(line, study, case.id)
    forces = tuple(lift.stated_uplift_force or 0.0 for lift in case.lift_forces)
    if not all(forces):
        raise InputError(
            f"case '{case.id}', key pantograph", "no uplift_force_N", "Give uplift_force_N of every pantograph."
        )
    mesh = discretise(line, discretisation.element_m)
    passage = _keep_dropper(build_passage(case, mesh, discretisation, forces), case.end, study.x_m)
    history = integrate_passage(mesh, passage)
    coefficients = np.array(study.coefficients_s)
    force = {
        law: np.array([_largest_force(mesh, passage, dropper, value, law) for value in coefficients]) for law in LAWS
    }
    record = record_passage(case, passage, history)
    damping = dict(line.damping) | {Kind.DROPPER: Rayleigh(stiffness_coefficient=float(coefficients[0]))}
    least_damped = integrate_passage(with_damping(mesh, damping), passage)
    bands = [_band_values(case, each) for each in (record, record_passage(case, passage, least_damped))]
    findings = {LINE: find_transition(coefficients, force[GRADED]) | compare_bands(*bands)}
    runs = 2 + len(LAWS) * coefficients.size
    return Delivered(
        record=record,
        run=build_run_table(discretisation, runs * passage.duration, begin),
        study=StudyResult(
            findings=findings,
            charts=(_draw_forces(case, study, force),),
            tables=(build_provenance_table(case),),
        ),
        notes=(
            "The paper does not print its compensation law. The graded law compensates only the elastic force: a "
            "large coefficient then locks the dropper, as in the paper. Under the law of the reference "
            "simulator it does not.",
        ),
    )


def find_transition(coefficient: RealArray, force: RealArray) -> dict[str, Value]:
    """Find the transition of the largest compensation force from its undamped value to locking.

    Args:
        coefficient: Stiffness coefficients in ascending order, (n,) [s].
        force: Largest compensation force at each coefficient, (n,) [N].

    Returns:
        Onset, middle and end of the transition [s] if reached, and force that remains at the largest coefficient [%],
        by name of quantity; empty if the first force is zero.
    """
    if force[0] == 0:
        return {}
    share = force / force[0]
    findings: dict[str, Value] = {"dropper_locked_force_pct": float(100 * share[-1])}
    change = np.abs(share - 1)
    levels = (("start", change, TRANSITION_SHARE, 1), ("middle", share, 0.5, -1), ("end", share, TRANSITION_SHARE, -1))
    for name, curve, level, sign in levels:
        crossing = _find_crossing(np.log(coefficient), sign * curve, sign * level)
        if crossing is not None:
            findings[f"dropper_transition_{name}_s"] = float(np.exp(crossing))
    return findings


def compare_bands(chosen: ValuesByOwner, least: ValuesByOwner) -> dict[str, Value]:
    """Largest change of the contact force in a band, of any pantograph, by small damping of the droppers.

    Args:
        chosen, least: Quantities with the damping of the case and with the smallest coefficient, by pantograph and
            name.

    Returns:
        Change [%] by name of quantity; empty without a band.
    """
    pairs = [
        (values.get(band), least.get(owner, {}).get(band))
        for owner, values in chosen.items()
        for band in BAND_QUANTITIES
    ]
    changes = [abs(new / old - 1) for new, old in pairs if isinstance(new, float) and isinstance(old, float)]
    return {"dropper_force_change_pct": 100 * max(changes)} if changes else {}


def _band_values(case: Case, record: Record) -> ValuesByOwner:
    return evaluate_record(record, case.file.filter, case.line.geometry.supports).values


def _find_crossing(x: RealArray, y: RealArray, level: float) -> float | None:
    """Abscissa at which a curve first reaches a level, by linear interpolation; None if it stays below."""
    i = int(np.argmax(y >= level))
    if y[i] < level:
        return None
    return float(x[0] if i == 0 else x[i - 1] + (level - y[i - 1]) / (y[i] - y[i - 1]) * (x[i] - x[i - 1]))


def _find_dropper(line: Catenary, study: DropperDamping, name: str) -> int:
    number = next((i for i, dropper in enumerate(line.droppers) if abs(dropper.position - study.x_m) < 1e-3), None)
    if number is None:
        problem = f"no dropper at {study.x_m:g} m"
        raise InputError(f"case '{name}', key study.x_m", problem, "Give the position of a dropper.")
    return number


def _keep_dropper(passage: Passage, end: float, position: float) -> Passage:
    """Passage whose active window still includes the dropper when the last pantograph is at its end [m, m]."""
    return replace(passage, kept_behind=max(passage.kept_behind, end - position + KEPT_MARGIN_M))


def _largest_force(mesh: DiscretisedLine, passage: Passage, number: int, coefficient: float, law: str) -> float:
    """Largest force [N] that compensates a dropper while it is slack, under the law of this name."""
    apply_law, viscous_share = LAWS[law]
    damping = dict(mesh.catenary.damping) | {Kind.DROPPER: Rayleigh(stiffness_coefficient=coefficient)}
    line = with_damping(mesh, damping)
    dropper, bars = mesh.catenary.droppers[number], line.connectors
    watched = ((dropper.upper, dropper.position), (dropper.lower, dropper.position))
    history = integrate_passage(apply_law(line), replace(passage, watched=watched))
    change = history.motion[0] - history.motion[1]
    taut = bars.preload[number] + bars.stiffness[number] * change[:, 0]
    taut += viscous_share * bars.damping[number] * change[:, 1]
    return float(max(0.0, -taut.min()))


def _draw_forces(case: Case, study: DropperDamping, force: dict[str, RealArray]) -> Chart:
    marks = [
        Mark(label="printed: transition", axis="x", low=limit.lower, high=limit.upper)
        for limit in case.limits
        if limit.quantity == "dropper_transition_middle_s" and limit.lower is not None
    ]
    coefficient = case.line.damping.droppers.stiffness_coefficient_s
    if coefficient > 0:
        marks.append(Mark(label="value of the paper", axis="x", low=coefficient))
    return Chart(
        caption=f"Largest compensation force of the dropper at {study.x_m:g} m against its stiffness coefficient; "
        f"values below {SMALLEST_DRAWN_FORCE:g} N are drawn at this value.",
        alternative="; ".join(f"{law}: {values[0]:.4g} N to {values[-1]:.4g} N" for law, values in force.items()),
        x_label="stiffness coefficient [s]",
        y_label="largest compensation force [N]",
        x_scale="log",
        y_scale="log",
        series=[
            Series(
                label=name,
                style="line",
                x=thin_series(np.array(study.coefficients_s)),
                y=thin_series(np.maximum(values, SMALLEST_DRAWN_FORCE)),
            )
            for name, values in force.items()
        ],
        marks=marks,
    )
