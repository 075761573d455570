"""Sources of a record in the time of the record: their clocks, compared with the passages at the supports.

The uplift of a source counts only if its pulses show the pantographs where the clock says they pass. Every support
keeps its own samples: those from the first pantograph 60 m before the support to the last one 60 m past it. A sample
that is missing there is kept as missing, so that the support is not evaluated.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.rounding import round_digits
from pantocheck.conformance.quantities.line_signals import (
    SUPPORT_TOLERANCE_M,
    UPLIFT_STRETCH_M,
    LineSignals,
    stack_supports,
    supports_inside,
)
from pantocheck.conformance.records.clock_join import PULSE_LENGTH_M, SMALLEST_MATCH, Clock, Passages, fit_clock
from pantocheck.conformance.records.record import ChannelRows
from pantocheck.conformance.records.uplift_sensor import find_inversion, find_uplift_fault

PULSE_SHIFT_M = 1.0
"""Largest distance of a pulse from its support in the simulated passages of the library [m]."""

PULSE_SCATTER_M = 0.25
"""Smallest standard deviation of this distance [m]."""

GAP_STEPS = 1.5
"""Smallest gap between two samples, over the median sampling interval [-]."""

PLAUSIBLE_DRIFT_PPM = (5.0, 1000.0)
"""Drift of a clock without a common time: a quartz has up to some hundred ppm."""

SupportRow = tuple[float, RealArray, RealArray]
"""Position of a support [m], uplift there, and position of the last pantograph at the same times, (n,) [m]."""

AlignmentState = Literal["confirmed", "unconfirmed", "contradicted"]


@dataclass(frozen=True)
class SourceSamples:
    """Uplift of one source at its supports."""

    name: str
    """Name of the file, with its number if several sources have the same."""
    kind: str
    """Kind of the join."""
    time: RealArray
    """Time by the clock of the source, increasing, (n,) [s]."""
    supports: RealArray
    """Positions of the supports, (s,) [m]."""
    uplift: RealArray
    """Uplift at the supports, (s, n) [m]; NaN where it is missing."""
    clock: Clock
    """Clock; of a passage, the stated offset and the range of the search."""


@dataclass(frozen=True)
class RecordSources:
    """Channels of the further sources of a record."""

    uplift: tuple[SourceSamples, ...] = ()
    """Sources of uplift with their own times."""
    rows: ChannelRows = field(default_factory=ChannelRows)
    """Speed and position at the times of the first file."""
    clocks: tuple[tuple[str, str, Clock], ...] = ()
    """Name, kind of the join and clock of the sources of speed and position."""

    @property
    def place_uncertainty_s(self) -> float:
        """Half-width of the 95 % interval of the time of speed and position [s]; 0: they are in the first file."""
        return max((clock.uncertainty for _, _, clock in self.clocks), default=0.0)


@dataclass(frozen=True)
class Tie:
    """Passage of a pantograph at a support."""

    support: float
    """Position of the support [m]."""
    pantograph: int
    """Number of the pantograph from 1."""
    passing: float
    """Time of the record at which the pantograph passes [s]."""
    pulse: float
    """Time of the pulse by the clock of the source [s]; NaN without a pulse."""


@dataclass(frozen=True)
class Alignment:
    """Source in the time of the record."""

    source: SourceSamples
    clock: Clock
    state: AlignmentState
    finding: str
    """Comparison of the pulses with the passages, in words."""
    ties: tuple[Tie, ...] = ()

    def describe(self) -> str:
        """State of the clock in a sentence."""
        words = {"confirmed": "is confirmed", "unconfirmed": "is not confirmed", "contradicted": "is wrong"}
        return f"the clock of {self.source.name} {words[self.state]}: {self.finding}"


@dataclass(frozen=True)
class PlacedTrain:
    """Positions of the pantographs in the time of the record, with 60 m at constant speed before and behind it."""

    time: RealArray
    """Time of the record, (n,) [s]."""
    position: RealArray
    """Positions of the pantographs, (p, n) [m]."""
    speed: float
    """Speed of the train [m/s]."""

    def place_ends(self, time: RealArray) -> tuple[RealArray, RealArray]:
        """Positions of the first and the last pantograph, (n,) [m] each, at constant speed before and behind it."""
        beyond = self.speed * (time - np.clip(time, self.time[0], self.time[-1]))
        ends = self.position.max(axis=0), self.position.min(axis=0)
        first, last = (np.interp(time, self.time, row) + beyond for row in ends)
        return first, last

    def find_times(self, place: float) -> RealArray:
        """Times at which the pantographs pass a place, (p,) [s]; NaN where they do not."""
        return np.array([np.interp(place, row, self.time, left=np.nan, right=np.nan) for row in self.position])


def extend_train(time: RealArray, position: RealArray, speed: float) -> PlacedTrain:
    """Train with the stretch that the uplift at the first and at the last support needs.

    Args:
        time: Time of the record, (n,) [s].
        position: Positions of the pantographs, (p, n) [m].
        speed: Nominal speed [m/s].
    """
    length = UPLIFT_STRETCH_M + SUPPORT_TOLERANCE_M
    longer = np.concatenate([[time[0] - length / speed], time, [time[-1] + length / speed]])
    return PlacedTrain(longer, np.column_stack([position[:, 0] - length, position, position[:, -1] + length]), speed)


def align_source(source: SourceSamples, train: PlacedTrain) -> Alignment:
    """Find the clock of a source, and compare it with the passages at its supports."""
    moments = np.array([train.find_times(place) for place in source.supports])
    if np.isnan(moments).all():
        low, high = train.position.min() + UPLIFT_STRETCH_M, train.position.max() - UPLIFT_STRETCH_M
        places = f"the train runs from x = {low:.0f} m to {high:.0f} m and passes none of its supports"
        hint = "support_km takes kilometres of the line, support_position_m takes x"
        return Alignment(source, source.clock, "unconfirmed", f"{places}; {hint}")
    passages = Passages(source.time, source.uplift, moments, train.speed)
    comparison, middle = passages.compare_patterns(), float(source.time.mean())
    stated, tolerance = source.clock.shift_at(middle), PULSE_LENGTH_M / train.speed + source.clock.uncertainty
    if source.kind == "passage":
        tolerance = source.clock.uncertainty
        found = comparison.list_passages(stated - tolerance, stated + tolerance)
        if len(found) > 1:
            places = " or ".join(f"{shift:.6g}" for shift in sorted(found))
            return Alignment(source, source.clock, "unconfirmed", f"several passages fit, with offset_s = {places}")
        shift, match = (found[0], 1.0) if found else (np.nan, 0.0)
    else:
        around = tolerance + comparison.neighbourhood
        shift, match = comparison.find_best(stated - around, stated + around)
    if match < SMALLEST_MATCH:
        shift = next(iter(comparison.list_passages(-np.inf, np.inf)), np.nan)
    if np.isnan(shift):
        return Alignment(source, source.clock, "unconfirmed", _describe_mismatch(source, moments))
    ties = list(_list_ties(source, passages, shift))
    if abs(shift - stated) > tolerance:
        return Alignment(source, source.clock, "contradicted", _describe_error(stated - shift, ties), tuple(ties))
    seen = [tie for tie in ties if np.isfinite(tie.pulse)]
    clock = source.clock
    if source.kind == "passage":
        scatter, common = PULSE_SCATTER_M / train.speed, (PULSE_SHIFT_M + SUPPORT_TOLERANCE_M) / train.speed
        times = np.array([(tie.pulse, tie.passing) for tie in seen]).T
        clock = fit_clock(times[0], times[1], scatter, common)
    residuals = [clock.convert(np.array([tie.pulse]))[0] - tie.passing for tie in seen]
    if source.kind == "passage" and len(seen) == 1:  # the clock was set by this pulse, so that none is left
        residuals = [clock.uncertainty]
    first, last = train.place_ends(clock.convert(source.time))
    rows = zip(source.supports, source.uplift, strict=True)
    inverted = [text for place, row in rows if (text := find_inversion(float(place), row, first, last)) is not None]
    if inverted:
        return Alignment(source, clock, "unconfirmed", "; ".join(inverted), tuple(ties))
    text = f"{len(seen)} of {len(ties)} passages show a pulse, within {1e3 * max(map(abs, residuals)):.2g} ms"
    return Alignment(source, clock, "confirmed", text, tuple(ties))


def _describe_mismatch(source: SourceSamples, moments: RealArray) -> str:
    """Pulses without a passage in words, with the passages, (s, p) [s], that the source holds by a stated clock."""
    begin, end = source.clock.convert(source.time[[0, -1]])
    held, total = int(((moments >= begin) & (moments <= end)).sum()), int(np.isfinite(moments).sum())
    text = "its pulses fit no passage of this train"
    if source.kind == "passage" or held == total:
        return f"{text}; it must hold the passage of each pantograph at each of its supports"
    return f"{text}; by its clock it holds {held} of the {total} passages of the pantographs at its supports"


def _list_ties(source: SourceSamples, passages: Passages, shift: float) -> Iterator[Tie]:
    for support, pulses, moments in zip(source.supports, passages.find_ties(shift), passages.moments, strict=True):
        for number, (pulse, moment) in enumerate(zip(pulses, moments, strict=True), 1):
            if np.isfinite(moment):
                yield Tie(float(support), number, float(moment), float(pulse))


def _describe_error(late: float, ties: Sequence[Tie]) -> str:
    """Error of a clock in words, with the drift that would explain it; `late` is the delay of the pulses [s]."""
    text = f"its pulses come {abs(late):.2f} s {'after' if late > 0 else 'before'} the pantographs pass"
    own = float(np.mean([tie.pulse for tie in ties if np.isfinite(tie.pulse)]))
    drift = round_digits(np.array([1e6 * abs(late / own) if own else np.inf]), 2)[0]
    low, high = PLAUSIBLE_DRIFT_PPM
    return f"{text}; a drift of {drift:g} ppm since its time 0 would explain it" if low <= drift <= high else text


def place_uplift(alignment: Alignment, train: PlacedTrain, shift: float = 0.0) -> Iterator[SupportRow]:
    """Uplift at each support of a source, with the positions of the last pantograph, (n,) [m] each.

    Args:
        alignment: Source in the time of the record.
        train: Positions of the pantographs.
        shift: Error of the clock that is assumed [s].
    """
    source = alignment.source
    time = alignment.clock.convert(source.time) + shift
    step = float(np.median(np.diff(time)))
    last = np.interp(time, train.time, train.position.min(axis=0))
    for place, uplift in zip(source.supports, source.uplift, strict=True):
        first_time = train.find_times(place - UPLIFT_STRETCH_M).min()
        last_time = train.find_times(place + UPLIFT_STRETCH_M).max()
        inside = np.flatnonzero((time >= first_time) & (time <= last_time))
        times = np.concatenate([[first_time], time[inside], [last_time]])
        if not inside.size or np.isnan(times).any() or (np.diff(times) > GAP_STEPS * step).any():
            yield float(place), np.full(2, np.nan), np.full(2, place)
        else:
            yield float(place), uplift[inside], last[inside]


def join_uplift(
    line: LineSignals, alignments: Sequence[Alignment], train: PlacedTrain, side: float = 0.0
) -> LineSignals:
    """Uplift of the record together with that of its sources, each support with its own samples.

    Args:
        line: Uplift of the first file.
        alignments: Sources; one at a support of the section whose clock is not confirmed makes the uplift unusable.
        train: Positions of the pantographs.
        side: Assumed error of every clock, over the half-width of its interval.
    """
    rows = [row for part in alignments for row in place_uplift(part, train, side * part.clock.uncertainty)]
    if not rows:
        return line
    if line.support_position is not None and line.support_uplift is not None and line.last_position is not None:
        for place, uplift in zip(line.support_position, line.support_uplift, strict=True):
            rows.append((float(place), uplift, line.last_position))
    rows.sort(key=lambda row: row[0])
    uplift, last = stack_supports([row[1:] for row in rows])
    used = [part for part in alignments if supports_inside(part.source.supports, line.section).any()]
    faults = [] if line.fault is None else [line.fault]
    faults += [part.describe() for part in used if part.state != "confirmed"]
    faults += [text for part in used for text in list_sensor_faults(part, train, line.section)]
    return replace(
        line,
        support_position=np.array([row[0] for row in rows]),
        support_uplift=uplift,
        last_position=last,
        fault="; ".join(faults) or None,
    )


def list_short_ends(alignments: Sequence[Alignment], train: PlacedTrain, section: tuple[float, float]) -> Iterator[str]:
    """Warnings of sources that cover a support of the section by their clock, but not at either end of its interval."""
    for part in alignments:
        if part.source.kind == "passage" and part.state != "confirmed":
            continue  # the clock is not known
        source, width = part.source, part.clock.uncertainty
        time = part.clock.convert(source.time[[0, -1]])
        gap = GAP_STEPS * float(np.median(np.diff(source.time)))
        for place in source.supports[supports_inside(source.supports, section)]:
            needed = (
                train.find_times(place - UPLIFT_STRETCH_M).min(),
                train.find_times(place + UPLIFT_STRETCH_M).max(),
            )
            for fault, side, spare in (
                ("begins {} s too late", "before", needed[0] - time[0] + gap),
                ("ends {} s too soon", "past", time[1] - needed[1] + gap),
            ):
                if 0 <= spare < width:
                    yield (
                        f"{source.name} {fault.format(f'{width - spare:.2g}')}: the uplift at {place:g} m needs "
                        f"{UPLIFT_STRETCH_M:g} m {side} the support and the uncertainty of the clock, {width:.2g} s"
                    )


def list_sensor_faults(alignment: Alignment, train: PlacedTrain, section: tuple[float, float]) -> Iterator[str]:
    """Faults of the sensors of a source at the supports of a section [m], by a clock that is stated or confirmed."""
    source = alignment.source
    usable = alignment.state == "confirmed" or (alignment.state == "unconfirmed" and source.kind != "passage")
    first, last = train.place_ends(alignment.clock.convert(source.time))
    inside = supports_inside(source.supports, section) & usable
    for place, row in zip(source.supports[inside], source.uplift[inside], strict=True):
        fault = find_uplift_fault(float(place), row, first, last)
        if fault is not None and fault not in alignment.finding:
            yield f"{source.name}: {fault}"


def list_drift_warnings(sources: RecordSources, alignments: Sequence[Alignment]) -> Iterator[str]:
    """Warnings of clocks that run faster or slower than that of the record, and were corrected."""
    clocks = [(name, clock) for name, _, clock in sources.clocks]
    for name, clock in [*clocks, *((part.source.name, part.clock) for part in alignments)]:
        if clock.drift and clock.drift_uncertainty is not None:
            yield (
                f"the clock of {name} runs {1e6 * abs(clock.drift):.0f} ppm {'slow' if clock.drift > 0 else 'fast'} "
                f"(uncertainty {1e6 * clock.drift_uncertainty:.0f} ppm) against that of the record; it was corrected"
            )
