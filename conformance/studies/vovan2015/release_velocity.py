"""Velocity of the line after a release under several damping models (Vo Van, Balmes and Lorang 2015, Figure 10).

The drop under one of the models takes the place of the measured record; the others are compared with it as
`pantocheck drop compare` does.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import ReleaseVelocity
from pantocheck.conformance.comparison.drop_motion import (
    GRAPHIC_BAND,
    MOTION_BANDS,
    TAPER_S,
    DropMotion,
    DropSimulation,
    simulate_models,
)
from pantocheck.conformance.comparison.drop_statistics import compute_statistics, select_window
from pantocheck.conformance.comparison.recorded_drop import locate_drop
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, TextTable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_simulation import require_mass_drop, simulate_drop
from pantocheck.conformance.quantities.evaluation import LINE, Value
from pantocheck.conformance.quantities.filters import is_observable
from pantocheck.conformance.results.drop_comparison_format import ModelAgreement
from pantocheck.conformance.runs.system import Delivered, StudyResult
from pantocheck.conformance.studies.vovan2015.line_damping import build_drop_run_table, build_lines
from pantocheck.conformance.studies.vovan2015.study_report import build_provenance_table, draw_curve, rms

MEDIUM = MOTION_BANDS[1]
"""Medium frequencies, 5 to 20 Hz as in Table 1 of the paper."""


@dataclass(frozen=True)
class VelocityWindow:
    """Velocity of one sensor in a time window."""

    time: RealArray
    velocity: RealArray
    medium: RealArray
    """Time after the release [s], velocity below 20 Hz, and its part in the medium frequencies [m/s], (n,)."""


def run_release_velocity(case: Case, study: ReleaseVelocity) -> Delivered:
    """Simulate the first drop of a case under each damping model and compare the velocity in every time window.

    Raises:
        InputError: The sensor or the model in place of the record does not exist, or a window lies outside the record.
    """
    begin, mass_drop = time.perf_counter(), require_mass_drop(case)
    if study.sensor > len(mass_drop.sensor):
        raise InputError(
            f"case '{case.id}', key study.sensor",
            f"there is no sensor {study.sensor}",
            f"The sensors are numbered from 1 to {len(mass_drop.sensor)}.",
        )
    latest = max(end for _, end in study.windows_s)
    if latest + TAPER_S > mass_drop.record_s:
        raise InputError(
            f"case '{case.id}', key study.windows_s",
            f"a window ends at {latest:g} s, the record at {mass_drop.record_s:g} s",
            f"Lengthen mass_drop.record_s to at least {latest + TAPER_S:g} s.",
        )
    motion = _simulate_drops(case, study, latest)
    windows = cut_windows(motion, study)
    sensor = mass_drop.sensor[study.sensor - 1]
    place = f"{sensor.wire.replace('_', ' ')} at {sensor.x_m:g} m"
    charts = tuple(
        _draw_velocity({name: cuts[number] for name, cuts in windows.items()}, window, place)
        for number, window in enumerate(study.windows_s)
    )
    return Delivered(
        run=build_drop_run_table(case, len(windows), begin),
        study=StudyResult(
            findings={LINE: compare_velocities(*list(windows.values())[:4])},
            charts=charts,
            tables=(
                _rms_table(windows, study, place),
                _agreement_table(motion, study, place),
                build_provenance_table(case),
            ),
        ),
    )


def _simulate_drops(case: Case, study: ReleaseVelocity, latest: float) -> DropMotion:
    """Motion of the drop in place of the record, and of the other models beside it."""
    models, mass_drop = build_lines(case), require_mass_drop(case)
    if study.test not in models:
        raise InputError(f"case '{case.id}', key study.test", f"no model '{study.test}'", "Name one of study.models.")
    record = simulate_drop(case, 1, line=models.pop(study.test)).record
    steps = case.file.discretisation
    settings = DropSimulation(steps.element_m, steps.time_step_s, mass_drop.drop[0].release_s, latest)
    return simulate_models(locate_drop(record, next(iter(models.values()))), models, settings)


def compare_velocities(
    record: Sequence[VelocityWindow],
    reference: Sequence[VelocityWindow],
    rayleigh: Sequence[VelocityWindow],
    modal: Sequence[VelocityWindow],
) -> dict[str, Value]:
    """Findings on the velocity in all windows, in the first and in the last.

    Args:
        record, reference, rayleigh, modal: Velocity of the record, under the reference model, with the fitted Rayleigh
            damping, and with modal damping besides.
    """
    first = rayleigh[0]
    return {
        "modal_velocity_difference_pct": tuple(
            100 * rms(with_modal.velocity - without.velocity) / rms(without.velocity)
            for with_modal, without in zip(modal, rayleigh, strict=True)
        ),
        "reference_residual_velocity_ratio": rms(reference[-1].velocity) / rms(record[-1].velocity),
        "medium_frequency_velocity_ratio": rms(first.medium) / rms(reference[0].medium),
    }


def _rms_table(windows: dict[str, list[VelocityWindow]], study: ReleaseVelocity, place: str) -> TextTable:
    names = [f"{start:g} s to {end:g} s" for start, end in study.windows_s]
    band = MEDIUM.text
    rows = [
        [model, *(f"{1e3 * rms(signal):.4g} mm/s" for cut in cuts for signal in (cut.velocity, cut.medium))]
        for model, cuts in windows.items()
    ]
    return TextTable(
        caption=f"RMS of the velocity of the {place}, and of its part in {band}",
        columns=["Damping", *(text for name in names for text in (name, f"{name}, {band}"))],
        rows=rows,
    )


def _agreement_table(motion: DropMotion, study: ReleaseVelocity, place: str) -> TextTable:
    """Each model beside the drop in place of the record, by window and band."""
    bands = tuple(band for band in MOTION_BANDS if is_observable(band.high, motion.rate))
    places = tuple(f"sensor {number}" for number in range(1, motion.record.shape[1] + 1))
    rows = [
        [
            f"{row.window_s[0]:g} s to {row.window_s[1]:g} s, {row.band_Hz[0]:g}-{row.band_Hz[1]:g} Hz",
            *(_describe_agreement(model) for model in row.models),
        ]
        for row in compute_statistics(motion, places, study.windows_s, bands)
        if row.place == places[study.sensor - 1] and row.motion == "velocity"
    ]
    return TextTable(
        caption=f"Velocity of the {place} beside that of {study.test}: ratio of the RMS, and correlation",
        columns=["Window and band", *motion.models],
        rows=rows,
    )


def _describe_agreement(model: ModelAgreement) -> str:
    if model.rms_ratio is None or model.correlation is None:
        return "-"
    return f"{model.rms_ratio:.3f}, {model.correlation:.3f}"


def cut_windows(motion: DropMotion, study: ReleaseVelocity) -> dict[str, list[VelocityWindow]]:
    """Velocity of the sensor of a study in each of its windows, by name of the model; the record comes first."""
    filters = {study.test: motion.filter_record} | {name: partial(motion.filter_model, name) for name in motion.models}
    sensor, inside = study.sensor - 1, [select_window(motion, window) for window in study.windows_s]
    found = {}
    for name, filter_velocity in filters.items():
        whole, medium = (filter_velocity("velocity", band)[:, sensor] for band in (GRAPHIC_BAND, MEDIUM))
        found[name] = [VelocityWindow(motion.time[cut], whole[cut], medium[cut]) for cut in inside]
    return found


def _draw_velocity(cuts: dict[str, VelocityWindow], window: tuple[float, float], place: str) -> Chart:
    return Chart(
        caption=f"Velocity of the {place} after the release, {window[0]:g} s to {window[1]:g} s.",
        alternative="Velocity over time under each damping model; the RMS of each is in the table.",
        x_label="time after the release [s]",
        y_label="velocity [mm/s]",
        series=[draw_curve(name, cut.time, 1e3 * cut.velocity) for name, cut in cuts.items()],
    )
