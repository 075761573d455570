"""Velocity of the line after a release under several damping models (the study's Figure 10)."""

import time

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import ReleaseVelocity
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.outcome import Delivered, StudyResult
from pantocheck.conformance.results.results_format import Chart, Series, TextTable
from pantocheck.conformance.results.traces import thin_series
from pantocheck.conformance.simulation.drop_simulation import ORDER, SimulatedDrop, require_mass_drop, simulate_drop
from pantocheck.conformance.studies.vovan2015.damping_models import build_lines
from pantocheck.conformance.studies.vovan2015.provenance_table import build_provenance_table


def run_release_velocity(case: Case, study: ReleaseVelocity) -> Delivered:
    """Simulate the case's first drop under each damping model and draw the velocity in every window.

    Parameters
    ----------
    case : Case
        With a mass drop.
    study : ReleaseVelocity
        Models and windows.

    Raises
    ------
    InputError
        There is no such sensor, or a window lies outside the record.
    """
    begin = time.perf_counter()
    told, steps = require_mass_drop(case), case.file.discretisation
    if study.sensor > len(told.sensor):
        raise InputError(f"case '{case.id}', key study.sensor", f"there is no sensor {study.sensor}", "Count from 1.")
    latest = max(end for _, end in study.windows_s)
    if latest > told.record_s:
        raise InputError(
            f"case '{case.id}', key study.windows_s", f"a window ends at {latest:g} s", "Lengthen mass_drop.record_s."
        )
    runs = {name: simulate_drop(case, 1, line=line) for name, line in build_lines(case).items()}
    sensor = told.sensor[study.sensor - 1]
    where = f"{sensor.wire.replace('_', ' ')} at {sensor.x_m:g} m"
    rows = []
    for name, run in runs.items():
        rms = [float(np.sqrt(np.mean(_window(run, study, window)[1] ** 2))) for window in study.windows_s]
        rows.append([name, *(f"{1e3 * value:.4g} mm/s" for value in rms)])
    return Delivered(
        run=RunTable(
            simulated_s=len(runs) * (told.hanging_s + told.record_s),
            wall_s=time.perf_counter() - begin,
            dt_s=steps.time_step_s,
            element_m=steps.element_m,
        ),
        study=StudyResult(
            charts=tuple(_chart(runs, study, window, where) for window in study.windows_s),
            tables=(
                TextTable(
                    caption=f"RMS of the velocity of the {where}",
                    columns=["Damping", *(f"{start:g} s to {end:g} s" for start, end in study.windows_s)],
                    rows=rows,
                ),
                build_provenance_table(case),
            ),
        ),
    )


def _window(
    run: SimulatedDrop, study: ReleaseVelocity, window: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Time [s] and velocity [m/s] inside a window."""
    inside = (run.decay.time >= window[0]) & (run.decay.time <= window[1])
    return run.decay.time[inside], run.decay.motion[study.sensor - 1, inside, ORDER["velocity"]]


def _chart(runs: dict[str, SimulatedDrop], study: ReleaseVelocity, window: tuple[float, float], where: str) -> Chart:
    series = []
    for name, run in runs.items():
        moment, velocity = _window(run, study, window)
        series.append(Series(label=name, style="line", x=thin_series(moment), y=thin_series(1e3 * velocity)))
    return Chart(
        caption=f"Velocity of the {where} after the release, {window[0]:g} s to {window[1]:g} s.",
        alternative="Velocity over time under each damping model; the RMS of each is in the table.",
        x_label="time after the release [s]",
        y_label="velocity [mm/s]",
        series=series,
    )
