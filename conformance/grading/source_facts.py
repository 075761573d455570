"""Sources of a record in results.json: clocks, passages, and the uplift drawn over the passages."""

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, Mark, Series
from pantocheck.conformance.records.clock_join import Clock
from pantocheck.conformance.records.record_preparation import PreparedRecord
from pantocheck.conformance.records.source_alignment import Alignment, Tie
from pantocheck.conformance.records.traces import thin_series
from pantocheck.conformance.results.case_facts_format import SourceFacts, SupportPassage

DRAWN_SUPPORTS = 3
"""Largest number of supports in a chart."""

DRAWN_S = 1.5
"""Time before the first and behind the last passage or pulse that is drawn [s]."""

LARGEST_DRAWN_ERROR_S = 30.0
"""Largest error of a clock whose pulses are drawn beside the passages [s]."""


def build_source_facts(graded: PreparedRecord | None, measured: PreparedRecord | None) -> list[SourceFacts]:
    """Facts on every further source of the graded record, and of a measured record that it is compared with."""
    placing = "places the record; the pulses of no uplift show this clock"
    facts = []
    for owner, record in (("graded", graded), ("measured", measured)):
        if record is not None:
            clocks = record.place_clocks
            found = [_describe(name, kind, clock, None, "unconfirmed", placing) for name, kind, clock in clocks]
            found += map(_describe_uplift, record.alignments)
            facts += [SourceFacts.model_validate({"record": owner, **values}) for values in found]
    return facts


def _describe(name: str, join: str, clock: Clock, rate: float | None, state: str, finding: str) -> dict[str, object]:
    width = clock.drift_uncertainty
    return {
        "name": name,
        "join": join,
        "rate_Hz": rate,
        "state": state,
        "finding": finding,
        "offset_s": clock.offset,
        "uncertainty_s": clock.uncertainty,
        "drift_ppm": 1e6 * clock.drift,
        "drift_uncertainty_ppm": None if width is None else 1e6 * width,
    }


def _describe_uplift(alignment: Alignment) -> dict[str, object]:
    source = alignment.source
    rate = float(f"{1 / float(np.median(np.diff(source.time))):.6g}")
    facts = _describe(source.name, source.kind, alignment.clock, rate, alignment.state, alignment.finding)
    passages = [
        SupportPassage(
            support_m=tie.support,
            pantograph=tie.pantograph,
            passing_s=tie.passing,
            pulse_s=tie.pulse if np.isfinite(tie.pulse) else None,
        )
        for tie in alignment.ties
    ]
    return {**facts, "passages": passages, "chart": _draw(alignment) if passages else None}


def _draw(alignment: Alignment) -> Chart:
    """Uplift over the time from the passing of the first pantograph at each support."""
    source, series = alignment.source, []
    time = alignment.clock.convert(source.time)
    by_support = {
        tie.support: [other for other in alignment.ties if other.support == tie.support] for tie in alignment.ties
    }
    shown = dict(list(by_support.items())[:DRAWN_SUPPORTS])
    for place, uplift in zip(source.supports, source.uplift, strict=True):
        if (ties := shown.get(float(place))) is not None:
            drawn = _select_times(alignment.clock, time, ties)
            x, y = thin_series(time[drawn] - ties[0].passing), thin_series(1e3 * uplift[drawn])
            series.append(Series(label=f"support at {place:g} m", style="line", x=x, y=y))
    times: dict[int, list[float]] = {}
    for ties in shown.values():
        for tie in ties:
            times.setdefault(tie.pantograph, []).append(tie.passing - ties[0].passing)
    marks = [Mark(label=f"passing of pantograph {n}", axis="x", low=float(np.mean(t))) for n, t in times.items()]
    caption = f"Uplift of {source.name} around the passings of the pantographs by their positions"
    return Chart(
        caption=f"{caption}.",
        alternative=f"{caption}: {alignment.finding}.",
        x_label="time [s]",
        y_label="uplift [mm]",
        series=series,
        marks=marks,
    )


def _select_times(clock: Clock, time: RealArray, ties: list[Tie]) -> NDArray[np.intp]:
    """Samples around the passages of a support, and around its pulses if they are near, that are known."""
    pulses = [float(clock.convert(np.array([tie.pulse]))[0]) for tie in ties if np.isfinite(tie.pulse)]
    moments = [tie.passing for tie in ties]
    moments += [pulse for pulse in pulses if min(abs(pulse - tie.passing) for tie in ties) <= LARGEST_DRAWN_ERROR_S]
    return np.flatnonzero((time >= min(moments) - DRAWN_S) & (time <= max(moments) + DRAWN_S))
