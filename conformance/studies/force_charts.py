"""Charts of contact forces under two damping models."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DampingChange
from pantocheck.conformance.quantities.evaluation import LINE, Value
from pantocheck.conformance.quantities.signals import EXTENDED_CUTOFF_HZ, ForceChannel
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.results.outcome import Delivered
from pantocheck.conformance.results.results_format import Chart, Series
from pantocheck.conformance.results.traces import thin_series


def draw_band_bars(
    values: Mapping[str, Mapping[int, Mapping[str, Value]]],
    printed: Mapping[tuple[str, int], Mapping[str, float]],
    bands: Sequence[str],
) -> tuple[Chart, ...]:
    """RMS of the bands, computed and printed, one chart for each pantograph.

    Parameters
    ----------
    values : Mapping[str, Mapping[int, Mapping[str, Value]]]
        Computed, by damping model, pantograph and name.
    printed : Mapping[tuple[str, int], Mapping[str, float]]
        By damping model and pantograph, and name; may be empty.
    bands : Sequence[str]
        Names of the quantities.
    """
    how = "computed on the assumed line and printed" if printed else "computed under each damping model"
    table = "computed beside printed values" if printed else "the same run under several damping models"
    charts = []
    for p in sorted({p for of in values.values() for p in of if p != LINE}):
        series = [_bars(f"computed, {model}", of.get(p, {}), bands) for model, of in values.items()]
        series += [_bars(f"printed, {model}", printed[model, p], bands) for model in values if (model, p) in printed]
        charts.append(
            Chart(
                caption=f"Pantograph {p}: RMS of the contact force by band, {how}.",
                alternative=f"Bars of the numbers in the table of {table}.",
                x_label="band [Hz]",
                y_label="RMS [N]",
                ticks=[band.removeprefix("rms_").removesuffix("_N").replace("_", "–") for band in bands],
                series=[one for one in series if one.x],
            )
        )
    return tuple(charts)


def _bars(label: str, values: Mapping[str, Value], bands: Sequence[str]) -> Series:
    there = [(float(i), value) for i, band in enumerate(bands) if isinstance(value := values.get(band), float)]
    return Series(label=label, style="bars", x=[i for i, _ in there], y=[value for _, value in there])


def trailing_force(case: Case, study: DampingChange, runs: Mapping[str, Delivered]) -> tuple[Chart, ...]:
    """Contact force of the last pantograph over one span, low-passed at 20 and at 50 Hz (the study's Figure 11).

    Parameters
    ----------
    case, study : Case or DampingChange
        Which span.
    runs : Mapping[str, Delivered]
        Outcome by damping model.
    """
    start, end = case.line.geometry.span(study.span)
    charts = []
    for cutoff in (case.file.filter.cutoff_Hz, EXTENDED_CUTOFF_HZ):
        series = []
        for name, outcome in runs.items():
            record = outcome.record
            if record is None:
                continue
            try:
                low_pass = replace(case.file.filter.low_pass, cutoff_Hz=cutoff)
                force = ForceChannel(record.force[-1], record.rate, low_pass, record.filter_applied_Hz).graded
            except QuantityUnavailable:
                continue
            inside = np.flatnonzero((record.position[-1] >= start) & (record.position[-1] <= end))
            series.append(
                Series(
                    label=name, style="line", x=thin_series(record.position[-1][inside]), y=thin_series(force[inside])
                )
            )  # fmt: skip
        if series:
            charts.append(
                Chart(
                    caption=f"Contact force of the last pantograph, span {study.span}, low-passed at {cutoff:g} Hz.",
                    alternative=f"Contact force from {start:g} m to {end:g} m under the two damping models.",
                    x_label="position along the track [m]",
                    y_label="contact force [N]",
                    series=series,
                )
            )
    return tuple(charts)
