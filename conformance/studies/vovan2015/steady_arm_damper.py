"""Identified damping with and without a vertical damper at the steady arms' claws (the study's Figure 9)."""

import time
from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import SteadyArmDamper
from pantocheck.conformance.identification.identify import Identification, identify_modes
from pantocheck.conformance.quantities.evaluation import LINE, Value
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.outcome import Delivered, StudyResult
from pantocheck.conformance.results.results_format import Chart, Mark, Series, TextTable
from pantocheck.conformance.results.traces import thin_series
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.drop_simulation import require_mass_drop, simulate_drop
from pantocheck.conformance.studies.vovan2015.findings_table import build_findings_table
from pantocheck.conformance.studies.vovan2015.provenance_table import build_provenance_table

Bands = tuple[tuple[float, float], ...]


def run_steady_arm_damper(case: Case, study: SteadyArmDamper) -> Delivered:
    """Simulate and identify the case's drops without and with the damper, and compare band by band.

    Parameters
    ----------
    case : Case
        With a mass drop.
    study : SteadyArmDamper
        The damper and the bands.
    """
    begin = time.perf_counter()
    told, steps = require_mass_drop(case), case.file.discretisation
    plain = build_catenary(case.line)
    arms = tuple(replace(arm, vertical_damper=study.damper_N_s_m) for arm in plain.steady_arms)
    found = {}
    for name, line in (("without damper", plain), ("with damper", replace(plain, steady_arms=arms))):
        records = [simulate_drop(case, n, line=line).record for n in range(1, len(told.drop) + 1)]
        (found[name],) = identify_modes(tuple(records), told.highest_Hz)
    without, damped = found.values()
    medians = tuple(_medians(one, study.bands_Hz) for one in (without, damped))
    findings = {LINE: damping_gains(*medians)}
    return Delivered(
        run=RunTable(
            simulated_s=2 * len(told.drop) * (told.hanging_s + told.record_s),
            wall_s=time.perf_counter() - begin,
            dt_s=steps.time_step_s,
            element_m=steps.element_m,
        ),
        warnings=tuple(dict.fromkeys(text for one in found.values() for text in one.warnings)),
        study=StudyResult(
            findings=findings,
            charts=(_chart(found, study.bands_Hz[-1][0]),),
            tables=(
                build_findings_table(case.limits, findings, {}),
                _table(study.bands_Hz, *medians),
                build_provenance_table(case),
            ),
        ),
    )


def damping_gains(without: list[float], damped: list[float]) -> dict[str, Value]:
    """Gains of the bands' median damping [%], up to the first band without modes.

    Parameters
    ----------
    without, damped : list[float]
        Medians of the bands; NaN where a band holds no certain mode.
    """
    gain = [100 * (z / z0 - 1) for z0, z in zip(without, damped, strict=True)]
    known = tuple(gain[: next((i for i, value in enumerate(gain) if not np.isfinite(value)), len(gain))])
    found: dict[str, Value] = {"damping_gain_pct": known}
    if len(known) == len(gain) > 2:
        found["damping_gain_fading_pct"] = known[1] - known[-1]
    return found


def _medians(found: Identification, bands: Bands) -> list[float]:
    medians = []
    for low, high in bands:
        inside = [m.damping_ratio for m in found.modes if m.certain and not m.lateral and low <= m.frequency_Hz < high]
        medians.append(float(np.median(inside)) if inside else float("nan"))
    return medians


def _table(bands: Bands, without: list[float], damped: list[float]) -> TextTable:
    rows = [
        [f"{low:g} to {high:g} Hz", f"{100 * z0:.3f} %", f"{100 * z:.3f} %", f"{100 * (z / z0 - 1):+.1f} %"]
        for (low, high), z0, z in zip(bands, without, damped, strict=True)
    ]
    return TextTable(
        caption="Median identified damping ratio by band",
        columns=["Band", "Without damper", "With damper", "Gain"],
        rows=rows,
    )


def _chart(found: dict[str, Identification], last: float) -> Chart:
    series = []
    for name, one in found.items():
        certain = [mode for mode in one.modes if mode.certain and not mode.lateral]
        series.append(
            Series(
                label=name,
                style="points",
                x=thin_series(np.array([mode.frequency_Hz for mode in certain])),
                y=thin_series(np.array([100 * mode.damping_ratio for mode in certain])),
                error=thin_series(np.array([196 * mode.damping_ratio_std for mode in certain])),
            )
        )
    return Chart(
        caption="Identified damping ratios without and with a vertical damper at every claw, with 95 % intervals.",
        alternative="Damping ratio over frequency; the medians of the bands are in the table.",
        x_label="frequency [Hz]",
        y_label="damping ratio [%]",
        series=series,
        marks=[Mark(label=f"printed: no effect visible after {last:g} Hz", axis="x", low=last)],
    )
