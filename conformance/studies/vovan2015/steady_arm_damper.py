"""Identified damping with and without vertical dampers at the steady arms (Vo Van, Balmes, Lorang 2015, Figure 9)."""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise, takewhile

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import SteadyArmDamper
from pantocheck.conformance.core.figure_data import Chart, Mark, TextTable
from pantocheck.conformance.drops.population_analysis import rank_correlation
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.evaluation import LINE, Value
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.runs.system import Delivered, StudyResult
from pantocheck.conformance.studies.vovan2015.line_damping import (
    build_drop_run_table,
    draw_damping_ratios,
    identify_drops,
)
from pantocheck.conformance.studies.vovan2015.study_report import build_provenance_table, find_crossing

END_SHARE = 0.1
"""Share of the largest gain at which the effect of the dampers ends [-]."""

END_SHARES = (0.05, 0.1, 0.2, 0.3)
"""Shares of the table that shows how the end depends on its definition [-]."""

FrequencyBands = tuple[tuple[float, float], ...]


def run_steady_arm_damper(case: Case, study: SteadyArmDamper) -> Delivered:
    """Simulate and identify the drops of a case without and with the dampers, and compare the bands."""
    begin = time.perf_counter()
    line = build_catenary(case.line)
    arms = tuple(replace(arm, vertical_damper=study.damper_N_s_m) for arm in line.steady_arms)
    identified = {
        "without damper": identify_drops(case, line),
        "with damper": identify_drops(case, replace(line, steady_arms=arms)),
    }
    modes = {name: drops.certain_modes for name, drops in identified.items()}
    without, damped = (_band_medians(certain, study.bands_Hz) for certain in modes.values())
    centres = [(low + high) / 2 for low, high in study.bands_Hz]
    findings = {LINE: damping_gains(without, damped, centres)}
    gains = findings[LINE]["damping_gain_pct"]
    assert isinstance(gains, tuple)
    warnings = [text for drops in identified.values() for text in drops.identification.warnings]
    return Delivered(
        run=build_drop_run_table(case, sum(len(drops.drops) for drops in identified.values()), begin),
        warnings=tuple(dict.fromkeys(warnings)),
        study=StudyResult(
            findings=findings,
            charts=(_draw_damping(modes, study.bands_Hz[-1][0]),),
            tables=(
                _band_table(study.bands_Hz, without, damped),
                *([_tabulate_ends(gains, centres)] if gains else []),
                build_provenance_table(case),
            ),
        ),
    )


def damping_gains(without: Sequence[float], damped: Sequence[float], centres: Sequence[float]) -> dict[str, Value]:
    """Gains of the median damping ratio by the dampers, band by band, and their course over the frequency.

    The gain is proportional to the damper, so that ratios of gains do not depend on its size.

    Args:
        without, damped: Median damping ratio of every band without and with the dampers; NaN for a band without modes.
        centres: Frequency of every band [Hz].

    Returns:
        Values by name of quantity. The list of gains ends before the first band without modes; the other quantities
        need all bands, at least four, and a gain in the first.
    """
    gain = [100 * (z / z0 - 1) for z0, z in zip(without, damped, strict=True)]
    known = tuple(takewhile(math.isfinite, gain))
    findings: dict[str, Value] = {"damping_gain_pct": known}
    if len(known) < len(gain) or len(known) < 4 or known[0] <= 0:
        return findings
    findings["damping_gain_ratio"] = tuple(value / known[0] for value in known)
    findings["damping_gain_step"] = min(b / a for a, b in pairwise(known[:3]))
    correlation = rank_correlation(np.array(known[1:]))
    if correlation is not None:
        findings["damping_gain_correlation"] = correlation
    if (end := locate_end(known, centres, END_SHARE)) is not None:
        findings["damping_gain_end_Hz"] = end
    return findings


def locate_end(gains: Sequence[float], centres: Sequence[float], share: float) -> float | None:
    """Frequency [Hz] behind the largest gain where a share of it remains; None if the gains stay above.

    Args:
        gains: Gain of every band.
        centres: Frequency of every band [Hz].
        share: Remaining share [-].
    """
    largest, size = int(np.argmax(gains)), len(gains)
    return find_crossing(np.array(centres[largest:size]), -np.array(gains[largest:]), -share * gains[largest])


def _tabulate_ends(gains: Sequence[float], centres: Sequence[float]) -> TextTable:
    """End of the effect at other levels of its definition."""
    ends = {share: locate_end(gains, centres, share) for share in END_SHARES}
    rows = [[f"{100 * share:g} %", "-" if end is None else f"{end:.3g} Hz"] for share, end in ends.items()]
    return TextTable(
        caption="End of the effect by the level of its definition",
        columns=["Share of the largest gain", "End"],
        rows=rows,
    )


def _band_medians(modes: Sequence[Mode], bands: FrequencyBands) -> list[float]:
    """Median damping ratio of every band; NaN for a band without modes."""
    ratios = [[mode.damping_ratio for mode in modes if low <= mode.frequency_Hz < high] for low, high in bands]
    return [float(np.median(inside)) if inside else math.nan for inside in ratios]


def _band_table(bands: FrequencyBands, without: list[float], damped: list[float]) -> TextTable:
    rows = [
        [f"{low:g} to {high:g} Hz", f"{100 * z0:.3f} %", f"{100 * z:.3f} %", f"{100 * (z / z0 - 1):+.1f} %"]
        for (low, high), z0, z in zip(bands, without, damped, strict=True)
    ]
    return TextTable(
        caption="Median identified damping ratio by band",
        columns=["Band", "Without damper", "With damper", "Gain"],
        rows=rows,
    )


def _draw_damping(modes: Mapping[str, Sequence[Mode]], last: float) -> Chart:
    return Chart(
        caption="Identified damping ratios without and with a vertical damper at every steady arm, with nominal 95 % "
        "intervals.",
        alternative="Damping ratio over frequency; the medians of the bands are in the table.",
        x_label="frequency [Hz]",
        y_label="damping ratio [%]",
        series=[draw_damping_ratios(name, certain) for name, certain in modes.items()],
        marks=[Mark(label=f"printed: no visible effect above {last:g} Hz", axis="x", low=last)],
    )
