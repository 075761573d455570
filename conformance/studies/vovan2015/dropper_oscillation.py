"""Oscillation of a dropper after a release against its stiffness coefficient (Vo Van, Balmes and Lorang 2015).

The extension of the dropper beside the mass oscillates at high frequency. Its velocity is the difference between the
velocities of two sensors, on the contact wire and on the messenger wire at the dropper.
"""

import time
from dataclasses import replace
from itertools import pairwise

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DropperOscillation
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, Series, TextTable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_simulation import ORDER, require_mass_drop, simulate_drop
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.evaluation import LINE, Value
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.traces import thin_series
from pantocheck.conformance.runs.system import Delivered, StudyResult
from pantocheck.conformance.studies.vovan2015.line_damping import build_drop_run_table
from pantocheck.conformance.studies.vovan2015.paper_tables import build_provenance_table
from pantocheck.model import Kind, Rayleigh

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

    Returns:
        Study without a record.

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
        velocity.append(decay.motion[:2, :, ORDER["velocity"]])
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

    Args:
        motion: Velocity of the contact wire and of the messenger wire at the dropper, (2, m) [m/s].
        time: Time after the release, (m,) [s]; the mass still hangs before 0.
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

    Returns:
        Values by name of quantity.
    """
    remaining = [_window_rms(signal, time, LATE_S) / _window_rms(signal, time, EARLY_S) for signal in oscillation]
    changes = [_rms(other - velocity[0]) / _rms(velocity[0]) for other in velocity[1:]]
    early = _window_rms(oscillation[0], time, EARLY_S) / _window_rms(velocity[0], time, EARLY_S)
    return {
        "dropper_oscillation_pct": 100 * early,
        "dropper_oscillation_decay_ratio": max(b / a for a, b in pairwise(remaining)),
        "dropper_velocity_change_pct": tuple(100 * change for change in changes),
    }


def _rms(signal: RealArray) -> float:
    return float(np.sqrt(np.mean(signal**2)))


def _window_rms(signal: RealArray, time: RealArray, window: tuple[float, float]) -> float:
    return _rms(signal[(time >= window[0]) & (time < window[1])])


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
            Series(label=f"{value:g} s", style="line", x=thin_series(time[shown]), y=thin_series(1e3 * signal[shown]))
            for value, signal in zip(study.coefficients_s, oscillation, strict=True)
        ],
    )
