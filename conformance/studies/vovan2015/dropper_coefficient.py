"""Stiffness coefficient of the droppers: compensation force in a passage, and oscillation after a release.

Vo Van, Balmes and Lorang (2015), Figure 8. The matrices of the system hold every dropper as taut. While a dropper is
slack, a force compensates it. Two laws are compared:

* The elastic and the viscous force are compensated, as in the reference simulator: a slack dropper carries no force.
* Only the elastic force is compensated: the viscous force stays in the constant damping matrix. A large coefficient
  then locks the dropper, because its dashpot also resists compression.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DropperDamping, DropperOscillation
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, Mark, TextTable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_record import MOTION_ORDER
from pantocheck.conformance.drops.drop_simulation import require_mass_drop, simulate_drop
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from pantocheck.conformance.quantities.evaluation import LINE, Value, ValuesByOwner
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.runs.case_run import build_passage, build_run_table, integrate_passage, record_passage
from pantocheck.conformance.runs.system import Delivered, StudyResult
from pantocheck.conformance.studies.vovan2015.line_damping import build_drop_run_table
from pantocheck.conformance.studies.vovan2015.study_report import build_provenance_table, draw_curve, find_crossing, rms
from pantocheck.model import Catenary, DiscretisedLine, Kind, Passage, Rayleigh, discretise
from pantocheck.model.discretisation.discretised_line import keep_viscous_part, with_damping

TRANSITION_SHARE = 0.1
"""Relative change of the force at the onset of the transition, and remaining share of the force at its end."""
OTHER_SHARES = (0.02, 0.05, 0.1, 0.2, 0.5)
"""Levels of the onset and of the end in the table of both."""
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
            f"case '{case.id}', key pantograph", "uplift_force_N is missing", "Give uplift_force_N of every pantograph."
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
            tables=(
                *([_tabulate_levels(coefficients, force[GRADED])] if force[GRADED][0] > 0 else []),
                build_provenance_table(case),
            ),
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
        Onset and end of the transition [s] if reached, and force that remains at the largest coefficient [%],
        by name of quantity; empty if the first force is zero.
    """
    if force[0] == 0:
        return {}
    findings: dict[str, Value] = {"dropper_locked_force_pct": float(100 * force[-1] / force[0])}
    for name, value in locate_transition(coefficient, force, TRANSITION_SHARE).items():
        if value is not None:
            findings[f"dropper_transition_{name}_s"] = value
    return findings


def locate_transition(coefficient: RealArray, force: RealArray, level: float) -> dict[str, float | None]:
    """Onset, where a force has changed by a level, and end, where this share of it remains [s]; None if not reached.

    Coefficients and force as in `find_transition`.
    """
    share, x = force / force[0], np.log(coefficient)
    found = {"start": find_crossing(x, np.abs(share - 1), level), "end": find_crossing(x, -share, -level)}
    return {name: None if crossing is None else float(np.exp(crossing)) for name, crossing in found.items()}


def _tabulate_levels(coefficient: RealArray, force: RealArray) -> TextTable:
    """Onset and end of the transition at other levels of their definition."""
    rows = []
    for level in OTHER_SHARES:
        places = locate_transition(coefficient, force, level).values()
        rows.append([f"{100 * level:g} %", *("-" if place is None else f"{place:.2g} s" for place in places)])
    columns = ["Level", "Onset: force changed by the level", "End: share of the force that remains"]
    return TextTable(caption="Transition of the graded law by the level of its definition", columns=columns, rows=rows)


def compare_bands(chosen: ValuesByOwner, least: ValuesByOwner) -> dict[str, Value]:
    """Largest change of the contact force in a band, of any pantograph, by the chosen damping of the droppers [%].

    The reference is the smallest damping; the change is by name of quantity, and empty without a band.
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
        Mark(label=f"printed {name}, times or divided by three", axis="x", low=limit.lower, high=limit.upper)
        for limit in case.limits
        for name, quantity in (("onset", "dropper_transition_start_s"), ("end", "dropper_transition_end_s"))
        if limit.quantity == quantity and limit.lower is not None
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
            draw_curve(name, np.array(study.coefficients_s), np.maximum(values, SMALLEST_DRAWN_FORCE))
            for name, values in force.items()
        ],
        marks=marks,
    )


# Oscillation of a dropper after a release against its stiffness coefficient (Vo Van, Balmes and Lorang 2015).
#
# The extension of the dropper beside the mass oscillates at high frequency. Its velocity is the difference between the
# velocities of two sensors, on the contact wire and on the messenger wire at the dropper.
HIGH_HZ = 50.0
"""High frequencies: above the bands of the contact force [Hz]."""
EARLY_S, LATE_S = (0.0, 0.1), (0.8, 1.6)
"""Windows after the release between which the decay is measured [s]."""
CONTACT, MESSENGER = 0, 1
"""Sensors at the dropper, on the contact wire and on the messenger wire."""


def run_dropper_oscillation(case: Case, study: DropperOscillation) -> Delivered:
    """Simulate the first drop of a case once for every stiffness coefficient of the droppers.

    Args:
        case: Case with a mass drop, and with sensors on contact and messenger wire at a dropper.
        study: Stiffness coefficients, ascending.

    Raises:
        InputError: The first two sensors are not on contact and messenger wire at one position.
    """
    begin, line = time.perf_counter(), build_catenary(case.line)
    sensors = require_mass_drop(case).sensor
    places = [(sensor.wire, sensor.x_m) for sensor in sensors[:2]]
    if len({x for _, x in places}) != 1 or [wire for wire, _ in places] != ["contact_wire", "messenger_wire"]:
        raise InputError(
            f"case '{case.id}', key mass_drop.sensor",
            "the first two sensors are not at one dropper",
            "Place sensor 1 on the contact wire and sensor 2 on the messenger wire, both at the position of a dropper.",
        )
    velocity = []
    for coefficient in study.coefficients_s:
        damping = dict(line.damping) | {Kind.DROPPER: Rayleigh(stiffness_coefficient=coefficient)}
        decay = simulate_drop(case, 1, line=replace(line, damping=damping)).decay
        velocity.append(decay.motion[:2, :, MOTION_ORDER["velocity"]])
    after = decay.time >= 0
    oscillation = [find_oscillation(motion, decay.time) for motion in velocity]
    findings = compare_oscillations(oscillation, [motion[CONTACT, after] for motion in velocity], decay.time[after])
    place = f"{sensors[0].x_m:g} m"
    return Delivered(
        run=build_drop_run_table(case, len(velocity), begin),
        study=StudyResult(
            findings={LINE: findings},
            charts=(_draw_oscillation(study, oscillation, decay.time[after], place),),
            tables=(_rms_table(study, oscillation, decay.time[after]), build_provenance_table(case)),
        ),
    )


def find_oscillation(motion: RealArray, time: RealArray) -> RealArray:
    """High-frequency velocity of the extension of a dropper from the release on, (n,) [m/s].

    The motion is that of contact and messenger wire at the dropper, (2, m) [m/s]; time is 0 at the release, (m,) [s].
    """
    extension = motion[MESSENGER] - motion[CONTACT]
    low = Filter(cutoff_Hz=HIGH_HZ)(extension, 1 / (time[1] - time[0]))
    return np.asarray((extension - low)[time >= 0])


def compare_oscillations(oscillation: list[RealArray], velocity: list[RealArray], time: RealArray) -> dict[str, Value]:
    """Findings on the oscillation of a dropper.

    Args:
        oscillation: High-frequency velocity of its extension, one array per coefficient in ascending order, the first
            without damping, each (n,) [m/s].
        velocity: Velocity of the contact wire at the dropper, in the same order, each (n,) [m/s].
        time: Time after the release, (n,) [s].
    """
    remaining = [_window_rms(signal, time, LATE_S) / _window_rms(signal, time, EARLY_S) for signal in oscillation]
    changes = [rms(other - velocity[0]) / rms(velocity[0]) for other in velocity[1:]]
    early = _window_rms(oscillation[0], time, EARLY_S) / _window_rms(velocity[0], time, EARLY_S)
    return {
        "dropper_oscillation_pct": 100 * early,
        "dropper_oscillation_decay_ratio": max(b / a for a, b in pairwise(remaining)),
        "dropper_velocity_change_pct": tuple(100 * change for change in changes),
    }


def _window_rms(signal: RealArray, time: RealArray, window: tuple[float, float]) -> float:
    return rms(signal[(time >= window[0]) & (time < window[1])])


def _rms_table(study: DropperOscillation, oscillation: list[RealArray], time: RealArray) -> TextTable:
    rows = [
        [f"{value:g} s", *(f"{1e3 * _window_rms(signal, time, window):.3g} mm/s" for window in (EARLY_S, LATE_S))]
        for value, signal in zip(study.coefficients_s, oscillation, strict=True)
    ]
    return TextTable(
        caption=f"RMS of the velocity of the dropper's extension above {HIGH_HZ:g} Hz",
        columns=["Stiffness coefficient", *(f"{start:g} s to {end:g} s" for start, end in (EARLY_S, LATE_S))],
        rows=rows,
    )


def _draw_oscillation(study: DropperOscillation, oscillation: list[RealArray], time: RealArray, place: str) -> Chart:
    shown = time <= LATE_S[0]
    return Chart(
        caption=f"Velocity of the extension of the dropper at {place} above {HIGH_HZ:g} Hz, after the release.",
        alternative="Velocity over time for each stiffness coefficient; the table has its RMS in two windows.",
        x_label="time after the release [s]",
        y_label="velocity [mm/s]",
        series=[
            draw_curve(f"{value:g} s", time[shown], 1e3 * signal[shown])
            for value, signal in zip(study.coefficients_s, oscillation, strict=True)
        ],
    )
