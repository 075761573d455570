"""Velocity of the line after a release under several damping models (Vo Van, Balmes and Lorang 2015, Figure 10)."""

import time

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import ReleaseVelocity
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.results.figure_data import Chart, Series, TextTable
from pantocheck.conformance.results.outcome import Delivered, StudyResult
from pantocheck.conformance.results.traces import thin_series
from pantocheck.conformance.simulation.drop_simulation import ORDER, SimulatedDrop, require_mass_drop, simulate_drop
from pantocheck.conformance.studies.vovan2015.line_damping import build_drop_run_table, build_lines
from pantocheck.conformance.studies.vovan2015.paper_tables import build_provenance_table


def run_release_velocity(case: Case, study: ReleaseVelocity) -> Delivered:
    """Simulate the first drop of a case under each damping model and chart the velocity in every time window.

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
    drops = {name: simulate_drop(case, 1, line=line) for name, line in build_lines(case).items()}
    sensor = mass_drop.sensor[study.sensor - 1]
    place = f"{sensor.wire.replace('_', ' ')} at {sensor.x_m:g} m"
    return Delivered(
        run=build_drop_run_table(case, len(drops), begin),
        study=StudyResult(
            charts=tuple(_draw_velocity(drops, study, window, place) for window in study.windows_s),
            tables=(_rms_table(drops, study, place), build_provenance_table(case)),
        ),
    )


def _rms_table(drops: dict[str, SimulatedDrop], study: ReleaseVelocity, place: str) -> TextTable:
    rows = []
    for name, drop in drops.items():
        squares = [np.mean(_cut_window(drop, study, window)[1] ** 2) for window in study.windows_s]
        rows.append([name, *(f"{1e3 * float(np.sqrt(square)):.4g} mm/s" for square in squares)])
    return TextTable(
        caption=f"RMS of the velocity of the {place}",
        columns=["Damping", *(f"{start:g} s to {end:g} s" for start, end in study.windows_s)],
        rows=rows,
    )


def _cut_window(
    drop: SimulatedDrop, study: ReleaseVelocity, window: tuple[float, float]
) -> tuple[RealArray, RealArray]:
    """Time [s] and velocity [m/s] inside a time window."""
    inside = (drop.decay.time >= window[0]) & (drop.decay.time <= window[1])
    return drop.decay.time[inside], drop.decay.motion[study.sensor - 1, inside, ORDER["velocity"]]


def _draw_velocity(
    drops: dict[str, SimulatedDrop], study: ReleaseVelocity, window: tuple[float, float], place: str
) -> Chart:
    series = []
    for name, drop in drops.items():
        instant, velocity = _cut_window(drop, study, window)
        series.append(Series(label=name, style="line", x=thin_series(instant), y=thin_series(1e3 * velocity)))
    return Chart(
        caption=f"Velocity of the {place} after the release, {window[0]:g} s to {window[1]:g} s.",
        alternative="Velocity over time under each damping model; the RMS of each is in the table.",
        x_label="time after the release [s]",
        y_label="velocity [mm/s]",
        series=series,
    )
