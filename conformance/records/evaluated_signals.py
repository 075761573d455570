"""Evaluated signals in results.json: they are packed at their full rate, and give the quantities again."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.packed_samples import (
    MOST_SAMPLES,
    PackedDamaged,
    PackedSamples,
    PantographSamples,
    SignalSamples,
    SupportSamples,
    pack_samples,
)
from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.quantities.evaluation import Evaluation, evaluate_signals
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.line_signals import (
    UPLIFT_STRETCH_M,
    LineSignals,
    stack_supports,
    supports_inside,
)
from pantocheck.conformance.quantities.pantograph_signals import EXTENDED_CUTOFF_HZ, ForceChannel, PantographSignals
from pantocheck.conformance.quantities.stated_quantities import SignalsOutside, Stretch, evaluate_outside_overlaps
from pantocheck.conformance.quantities.unavailable import BandNotObservable, QuantityUnavailable
from pantocheck.conformance.records.record import LARGEST_NUMBER

REMAINDER = 1e-14
"""Share of a filter transient that remains at the analysis section."""

FilterAndSection = tuple[Filter, Stretch]
"""Filter and analysis section of an evaluation."""


def settling_samples(low_pass: Filter, rate: float) -> int:
    """Samples after which the transients of the filters of an evaluation have decayed to `REMAINDER`.

    A transient of a filter with the largest pole p decays with |p|^n.
    """
    edges = [(low_pass.cutoff_Hz, 0.0), (EXTENDED_CUTOFF_HZ, 0.0)]
    if low_pass.bands == "band-pass":
        edges += [(band.high, band.low) for band in BANDS]
    largest = 0.0
    for high, low in edges:
        try:
            sections = low_pass.change_cutoff(high).sections(rate, low)
        except BandNotObservable:
            continue
        largest = max(largest, *(float(np.abs(np.roots(section[3:])).max()) for section in sections))
    return int(np.ceil(np.log(REMAINDER) / np.log(largest))) if 0 < largest < 1 else 0


def pack_signals(
    pantographs: Mapping[int, PantographSignals],
    line: LineSignals,
    time: RealArray | None,
    readings: Sequence[FilterAndSection] = (),
    overlaps: Sequence[Stretch] = (),
    excluded: Sequence[Stretch] = (),
) -> SignalSamples | None:
    """Signals of a record for results.json; None if no pantograph covers the section, or if there are too many.

    Args:
        pantographs: Signals of the pantographs by number from 1.
        line: Uplift at the supports.
        time: Times of the uplift, (n,) [s]; None: not known.
        readings: Further evaluations of the same signals.
        overlaps: Overlaps of the tension sections of the line.
        excluded: Stretches that are left out of the statistics.
    """
    packed = {}
    for number, signals in pantographs.items():
        try:
            window = _find_window(signals, readings)
        except QuantityUnavailable:
            continue
        if window.stop - window.start > MOST_SAMPLES:
            return None
        height, channels = signals.contact_height, signals.arc_channels
        arcs, loaded = (None, None) if channels is None else map(pack_samples, channels[:, window])
        packed[str(number)] = PantographSamples(
            filter_applied_Hz=signals.filter_applied_Hz,
            position_m=pack_samples(signals.position[window]),
            force_N=pack_samples(signals.force.delivered[window]),
            contact_height_m=None if height is None else pack_samples(height[window]),
            front_strip_N=None if signals.front_strip is None else pack_samples(signals.front_strip[window]),
            arcs=arcs,
            loaded=loaded,
        )
    if not packed:
        return None
    first, starts = next(iter(pantographs.values())), [float(part.position[0]) for part in pantographs.values()]
    sections = [first.section, *(section for _, section in readings)]
    uplift = _pack_uplift(line, sections, max(starts) - min(starts))
    last_position = line.last_position if uplift and uplift[0].last_position_m is None else None
    return SignalSamples(
        rate_Hz=first.rate,
        evaluated_m=first.section,
        pantographs=packed,
        uplift=uplift,
        time_s=None if time is None or not uplift else pack_samples(time),
        last_position_m=None if last_position is None else pack_samples(last_position),
        line_supports_m=None if line.line_supports is None else list(map(float, line.line_supports)),
        overlaps_m=list(overlaps),
        excluded_m=list(excluded),
        shortest_loss_s=first.shortest_loss_s,
    )


def _find_window(signals: PantographSignals, readings: Sequence[FilterAndSection]) -> slice:
    """Samples of the sections of all evaluations, and those around them in which the filters settle."""
    inside, position = signals.inside, signals.position
    settling = settling_samples(signals.force.low_pass, signals.rate)
    first, last = inside.start - settling, inside.stop + settling
    for low_pass, (start, end) in readings:
        begin, stop = np.searchsorted(position, [start - 1e-9, end - 1e-9])
        settling = settling_samples(low_pass, signals.rate)
        first, last = min(first, int(begin) - settling), max(last, int(stop) + settling)
    # One sample more at each end: a section may begin between two samples.
    return slice(max(first - 1, 0), min(last + 1, position.size))


def _pack_uplift(line: LineSignals, sections: Sequence[Stretch], train_m: float) -> list[SupportSamples]:
    """Uplift at the supports of the sections: around the passage of a train of this length, and at its maximum."""
    positions, supports, uplift = line.last_position, line.support_position, line.support_uplift
    if supports is None or uplift is None or positions is None or line.fault or positions.shape[-1] > MOST_SAMPLES:
        return []
    packed = []
    inside = np.any([supports_inside(supports, section) for section in sections], axis=0)
    if positions.ndim == 2:
        for x, row, own in zip(supports[inside], uplift[inside], positions[inside], strict=True):
            kept = np.isfinite(own)
            last = pack_samples(own[kept])
            packed.append(SupportSamples(support_m=x, first=0, uplift_m=pack_samples(row[kept]), last_position_m=last))
        return packed
    for x, row in zip(supports[inside], uplift[inside], strict=True):
        counted = np.flatnonzero(positions <= x + UPLIFT_STRETCH_M)
        if not counted.size:
            continue
        end = int(counted[-1]) + 1
        known = np.where(np.isfinite(row[:end]), row[:end], -np.inf)
        first = min(int(np.searchsorted(positions, x - train_m - UPLIFT_STRETCH_M)), int(np.argmax(known)))
        packed.append(SupportSamples(support_m=float(x), first=first, uplift_m=pack_samples(row[first:end])))
    return packed


def _spread_uplift(support: SupportSamples, samples: int) -> RealArray:
    """Uplift over the whole record, (samples,) [m]; outside of the embedded part the lowest value of it."""
    embedded = support.uplift_m.unpack()
    known = embedded[np.isfinite(embedded)]
    uplift = np.full(samples, known.min() if known.size else np.nan)
    uplift[support.first : support.first + embedded.size] = embedded
    return uplift


@dataclass(frozen=True)
class UnpackedSignals:
    """Signals of results.json, ready for evaluation."""

    pantographs: dict[int, PantographSignals]
    """Signals by number from 1."""
    line: LineSignals
    """Uplift at the supports."""
    time: RealArray | None
    """Times of the uplift, (n,) [s]; None without uplift."""
    overlaps: Sequence[Stretch]
    excluded: Sequence[Stretch]

    @property
    def evaluation(self) -> Evaluation:
        """Quantities over the analysis section."""
        evaluated: dict[int, PantographSignals | SignalsOutside] = dict(self.pantographs)
        if self.excluded:
            evaluated = {number: SignalsOutside(part, self.excluded) for number, part in self.pantographs.items()}
        whole, (outside, _) = (
            evaluate_signals(evaluated, self.line),
            evaluate_outside_overlaps(self.pantographs, self.overlaps),
        )
        values = {owner: {**known, **outside.get(owner, {})} for owner, known in whole.values.items()}
        return Evaluation(values, whole.skipped)


def unpack_signals(samples: SignalSamples, low_pass: Filter, section: Stretch | None = None) -> UnpackedSignals:
    """Signals of results.json with the filter of an evaluation, over its analysis section or another one [m].

    Raises:
        PackedDamaged: Samples are damaged, or the channels of a pantograph have different lengths.
    """
    evaluated = section or samples.evaluated_m
    pantographs = {
        int(number): PantographSignals(
            position=_unpack_positions(part.position_m),
            force=ForceChannel(_unpack_finite(part.force_N), samples.rate_Hz, low_pass, part.filter_applied_Hz),
            section=evaluated,
            contact_height=None if part.contact_height_m is None else part.contact_height_m.unpack(),
            front_strip=None if part.front_strip_N is None else _unpack_finite(part.front_strip_N),
            arc_channels=None
            if part.arcs is None or part.loaded is None
            else np.vstack([part.arcs.unpack(), part.loaded.unpack()]),
            shortest_loss_s=samples.shortest_loss_s,
        )
        for number, part in samples.pantographs.items()
    }
    supports, positions, uplift = samples.line_supports_m, samples.last_position_m, samples.uplift
    own = [(part.uplift_m.unpack(), _unpack_finite(part.last_position_m)) for part in uplift if part.last_position_m]
    if own:
        rows, last = stack_supports(own)
    else:
        last = np.array([]) if positions is None else _unpack_finite(positions)
        rows = np.array([_spread_uplift(part, last.size) for part in uplift])
    line = LineSignals(
        section=evaluated,
        support_position=np.array([part.support_m for part in uplift]) if uplift else None,
        support_uplift=rows if uplift else None,
        line_supports=None if supports is None else tuple(supports),
        last_position=last if uplift else None,
    )
    time = None if samples.time_s is None else _unpack_finite(samples.time_s)
    return UnpackedSignals(pantographs, line, time, samples.overlaps_m, samples.excluded_m)


def _unpack_finite(packed: PackedSamples) -> RealArray:
    """Samples of a channel without gaps, as a record may have them."""
    samples = packed.unpack()
    if not (np.abs(samples) <= LARGEST_NUMBER).all():
        raise PackedDamaged("a sample is missing or impossible")
    return samples


def _unpack_positions(packed: PackedSamples) -> RealArray:
    position = _unpack_finite(packed)
    if not (np.diff(position) > 0).all():
        raise PackedDamaged("the positions of a pantograph do not increase")
    return position
