"""Velocity of the line after a release under several damping models (Vo Van, Balmes and Lorang 2015, Figure 10)."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import ReleaseVelocity
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.quantities.evaluation import LINE, Value
from pantocheck.conformance.quantities.filters import LowPass
from pantocheck.conformance.results.figure_data import Chart, Series, TextTable
from pantocheck.conformance.results.outcome import Delivered, StudyResult
from pantocheck.conformance.results.traces import thin_series
from pantocheck.conformance.simulation.drop_simulation import ORDER, SimulatedDrop, require_mass_drop, simulate_drop
from pantocheck.conformance.studies.vovan2015.line_damping import build_drop_run_table, build_lines
from pantocheck.conformance.studies.vovan2015.paper_tables import build_provenance_table

MEDIUM_HZ = (5.0, 20.0)
"""Medium frequencies: the band of this name in Table 1 of the paper [Hz]."""
STEEP_ORDER = 12
"""Order of the filters between the bands: the group at 0.9 Hz, 30 times as strong, is attenuated to 1e-8."""


@dataclass(frozen=True)
class VelocityWindow:
    """Velocity of one sensor in a time window.

    Parameters
    ----------
    time, velocity, medium : (n,) ndarray
        Time after the release [s], velocity [m/s], and its part in the medium frequencies [m/s].
    """

    time: RealArray
    velocity: RealArray
    medium: RealArray


def run_release_velocity(case: Case, study: ReleaseVelocity) -> Delivered:
    """Simulate the first drop of a case under each damping model and compare the velocity in every time window.

    Parameters
    ----------
    case : Case
        Case with a mass drop.
    study : ReleaseVelocity
        Damping models, sensor and time windows.

    Returns
    -------
    Delivered
        Study without a record.

    Raises
    ------
    InputError
        The sensor does not exist, or a window lies outside the record.
    """
    begin, mass_drop = time.perf_counter(), require_mass_drop(case)
    if study.sensor > len(mass_drop.sensor):
        raise InputError(
            f"case '{case.id}', key study.sensor",
            f"there is no sensor {study.sensor}",
            f"The sensors are numbered from 1 to {len(mass_drop.sensor)}.",
        )
    latest = max(end for _, end in study.windows_s)
    if latest > mass_drop.record_s:
        raise InputError(
            f"case '{case.id}', key study.windows_s",
            f"a window ends at {latest:g} s, the record at {mass_drop.record_s:g} s",
            "Lengthen mass_drop.record_s.",
        )
    windows = {name: _cut_windows(simulate_drop(case, 1, line=line), study) for name, line in build_lines(case).items()}
    sensor = mass_drop.sensor[study.sensor - 1]
    place = f"{sensor.wire.replace('_', ' ')} at {sensor.x_m:g} m"
    charts = tuple(_draw_velocity(windows, number, place) for number in range(len(study.windows_s)))
    return Delivered(
        run=build_drop_run_table(case, len(windows), begin),
        study=StudyResult(
            findings={LINE: compare_velocities(*list(windows.values())[:3])},
            charts=charts,
            tables=(_rms_table(windows, study, place), build_provenance_table(case)),
        ),
    )


def compare_velocities(
    reference: Sequence[VelocityWindow], rayleigh: Sequence[VelocityWindow], modal: Sequence[VelocityWindow]
) -> dict[str, Value]:
    """Findings on the velocity in the first and in the last window.

    Parameters
    ----------
    reference, rayleigh, modal : sequence of VelocityWindow
        Velocity under the reference model, with the fitted Rayleigh damping, and with modal damping besides.

    Returns
    -------
    dict of str to Value
        Values by name of quantity.
    """
    first = rayleigh[0]
    return {
        "modal_velocity_difference_pct": 100 * _rms(modal[0].velocity - first.velocity) / _rms(first.velocity),
        "reference_residual_velocity_ratio": _rms(reference[-1].velocity) / _rms(rayleigh[-1].velocity),
        "medium_frequency_velocity_ratio": _rms(first.medium) / _rms(reference[0].medium),
    }


def _rms(signal: RealArray) -> float:
    return float(np.sqrt(np.mean(signal**2)))


def _rms_table(windows: dict[str, list[VelocityWindow]], study: ReleaseVelocity, place: str) -> TextTable:
    names = [f"{start:g} s to {end:g} s" for start, end in study.windows_s]
    band = f"{MEDIUM_HZ[0]:g}-{MEDIUM_HZ[1]:g} Hz"
    rows = [
        [model, *(f"{1e3 * _rms(signal):.4g} mm/s" for cut in cuts for signal in (cut.velocity, cut.medium))]
        for model, cuts in windows.items()
    ]
    return TextTable(
        caption=f"RMS of the velocity of the {place}, and of its part in {band}",
        columns=["Damping", *(text for name in names for text in (name, f"{name}, {band}"))],
        rows=rows,
    )


def _cut_windows(drop: SimulatedDrop, study: ReleaseVelocity) -> list[VelocityWindow]:
    """Velocity of the sensor of a study in each of its windows."""
    instant = drop.decay.time
    velocity = drop.decay.motion[study.sensor - 1, :, ORDER["velocity"]]
    rate = 1 / (instant[1] - instant[0])
    low, high = (LowPass(order=STEEP_ORDER, cutoff_Hz=edge)(velocity, rate) for edge in MEDIUM_HZ)
    inside = [(instant >= start) & (instant <= end) for start, end in study.windows_s]
    return [VelocityWindow(instant[cut], velocity[cut], (high - low)[cut]) for cut in inside]


def _draw_velocity(windows: dict[str, list[VelocityWindow]], number: int, place: str) -> Chart:
    cuts = {name: models[number] for name, models in windows.items()}
    start, end = next((cut.time[0], cut.time[-1]) for cut in cuts.values())
    series = [
        Series(label=name, style="line", x=thin_series(cut.time), y=thin_series(1e3 * cut.velocity))
        for name, cut in cuts.items()
    ]
    return Chart(
        caption=f"Velocity of the {place} after the release, {start:g} s to {end:g} s.",
        alternative="Velocity over time under each damping model; the RMS of each is in the table.",
        x_label="time after the release [s]",
        y_label="velocity [mm/s]",
        series=series,
    )
