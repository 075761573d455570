"""Charts of contact forces under several damping models."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DampingChange
from pantocheck.conformance.quantities.evaluation import LINE, Value, ValuesByOwner
from pantocheck.conformance.quantities.signals import EXTENDED_CUTOFF_HZ, ForceChannel
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.results.outcome import Delivered
from pantocheck.conformance.results.results_format import Chart, Series
from pantocheck.conformance.results.traces import thin_series

PrintedValues = Mapping[tuple[str, int], Mapping[str, float]]
"""Values that a publication prints, by damping model and pantograph, and by name."""


def draw_band_bars(
    values: Mapping[str, ValuesByOwner], printed: PrintedValues, bands: Sequence[str]
) -> tuple[Chart, ...]:
    """Bar charts of the RMS of the bands, computed and printed, one for each pantograph.

    Parameters
    ----------
    values : mapping of str to ValuesByOwner
        Computed values by damping model.
    printed : PrintedValues
        Printed values; may be empty.
    bands : sequence of str
        Names of the quantities.
    """
    origin = "computed on the assumed line and printed" if printed else "computed under each damping model"
    table = "computed beside printed values" if printed else "the same run under several damping models"
    charts = []
    pantographs = sorted({number for model_values in values.values() for number in model_values if number != LINE})
    for p in pantographs:
        series = [_bars(f"computed, {model}", computed.get(p, {}), bands) for model, computed in values.items()]
        series += [_bars(f"printed, {model}", printed[model, p], bands) for model in values if (model, p) in printed]
        charts.append(
            Chart(
                caption=f"Pantograph {p}: RMS of the contact force by band, {origin}.",
                alternative=f"Bars of the numbers in the table of {table}.",
                x_label="band [Hz]",
                y_label="RMS [N]",
                ticks=[band.removeprefix("rms_").removesuffix("_N").replace("_", "–") for band in bands],
                series=[bars for bars in series if bars.x],
            )
        )
    return tuple(charts)


def _bars(label: str, values: Mapping[str, Value], bands: Sequence[str]) -> Series:
    known = [(float(i), value) for i, band in enumerate(bands) if isinstance(value := values.get(band), float)]
    return Series(label=label, style="bars", x=[i for i, _ in known], y=[value for _, value in known])


def draw_trailing_force(case: Case, study: DampingChange, runs: Mapping[str, Delivered]) -> tuple[Chart, ...]:
    """Charts of the contact force of the last pantograph over one span, low-passed at 20 Hz and at 50 Hz.

    As Figure 11 of Vo Van, Balmes and Lorang (2015).

    Parameters
    ----------
    case : Case
        Passage of a train.
    study : DampingChange
        Number of the span.
    runs : mapping of str to Delivered
        Runs by damping model.
    """
    start, end = case.line.geometry.span(study.span)
    charts = []
    for cutoff in (case.file.filter.cutoff_Hz, EXTENDED_CUTOFF_HZ):
        series = []
        for name, run in runs.items():
            record = run.record
            if record is None:
                continue
            try:
                low_pass = replace(case.file.filter.low_pass, cutoff_Hz=cutoff)
                force = ForceChannel(record.force[-1], record.rate, low_pass, record.filter_applied_Hz).graded
            except QuantityUnavailable:
                continue
            inside = np.flatnonzero((record.position[-1] >= start) & (record.position[-1] <= end))
            x, y = thin_series(record.position[-1][inside]), thin_series(force[inside])
            series.append(Series(label=name, style="line", x=x, y=y))
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
