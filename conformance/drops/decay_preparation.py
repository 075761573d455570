"""Preparation of a mass-drop record: linear decay of the vertical channels, lateral channels."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.decay_kernel import FrequencyBand, filter_full_overlap, low_pass_taps
from pantocheck.conformance.drops.decay_search import CALM, SHORTEST_DECAY, DecaySearch, ResidualCourse
from pantocheck.conformance.drops.drop_record import DropChannel, DropRecord
from pantocheck.conformance.drops.noise_estimate import shows_motion
from pantocheck.conformance.drops.release import Release, find_release
from pantocheck.conformance.records.force_checks import find_clipping

CLIPPED_EARLY = 0.15
"""Share of the decay after which a clipped channel is left out [-]."""

NO_POLES: ComplexArray = np.zeros(0, dtype=np.complex128)

GUARD = 2.0
"""Estimated time from the release until all droppers are taut again [s]."""


@dataclass(frozen=True)
class StretchEvidence:
    """RMS of the residual over that of the motion at rest, in windows over the whole record."""

    time: RealArray
    """Middle of each window after the release, (w,) [s]."""
    ratio: RealArray
    """Median over the channels, (w,) [-]."""


NO_EVIDENCE = StretchEvidence(np.zeros(0), np.zeros(0))


@dataclass(frozen=True)
class LinearDecay:
    """Linear decay of one record, low-pass filtered and decimated, with unchanged poles."""

    samples: RealArray
    """Channels, (n, c) [unit of the record]."""
    dt: float
    """Sampling interval [s]."""
    taps: RealArray
    """Taps of the low-pass, at the original sampling rate, (t,)."""
    rate: float
    """Original sampling rate [Hz]."""
    start: float
    end: float
    """Start and end of the used part, in the time of the record [s]."""
    first: float
    """Time of the first sample, with the delay of the filter removed, in the time of the record [s]."""
    poles: ComplexArray
    """Poles of the search for the linear part, (m,) [1/s]. They are the start poles of an identification if its
    records have different sampling rates; otherwise start poles are searched in all records together.
    """
    evidence: StretchEvidence = NO_EVIDENCE
    """Residual over the whole record, by which the part was chosen."""
    warnings: tuple[str, ...] = ()
    """Measurements by which the decay is shorter than the record."""

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self.samples.shape[0] * self.dt)


@dataclass(frozen=True)
class PreparedDecay:
    """Record that is ready for identification."""

    record: DropRecord
    """The record as read."""
    columns: tuple[int, ...]
    """Indices of the vertical channels that are used."""
    release: Release
    """Release of the mass."""
    linear: LinearDecay
    """Linear decay of those channels."""
    lateral: RealArray
    """Lateral channels with the same filter, at the same times, (n, l)."""
    warnings: tuple[str, ...]
    """Caveats on the record."""
    driven: bool = False
    """Whether the line moves at rest before the release; its decay is used as a whole."""
    is_cut: bool = False
    """Whether its start is left out, because the modes differ from those of later parts."""

    @property
    def channels(self) -> tuple[DropChannel, ...]:
        """Channels that are used."""
        return tuple(self.record.channels[c] for c in self.columns)

    @property
    def channel_names(self) -> tuple[str, ...]:
        """Names of the channels that are used."""
        return tuple(channel.name for channel in self.channels)

    @property
    def test(self) -> tuple[object, ...]:
        """Properties of the drop, equal for repeated drops."""
        drop = self.record.drop
        return (drop.mass, drop.wire, drop.position, self.channels, self.record.quantity)


def prepare_decay(record: DropRecord, band: FrequencyBand) -> PreparedDecay:
    """Find the release and the linear decay of a record.

    Raises:
        InputError: The record has no vertical channel, or no usable free decay.
    """
    name = record.name
    vertical = record.along("z")
    if not vertical:
        raise InputError(name, "has no vertical channel", "Give the direction +z or -z to the vertical channels.")
    release = find_release(record.signals[:, list(vertical)], record.rate, record.drop.trigger_nominal, name)
    warnings = [*record.warnings, *release.warnings]
    columns, clipped_until = [], 0.0
    for c in vertical:
        last = max((end for _, end in find_clipping(record.signals[:, c])), default=0) / record.rate
        if last > release.time + CLIPPED_EARLY * (record.duration - release.time):
            channel = record.channels[c].name
            warnings.append(
                f"{name}: channel '{channel}' is left out, because it is clipped in a large part of the decay"
            )
            continue
        clipped_until = max(clipped_until, last)
        columns.append(c)
    if not columns:
        raise InputError(name, "all vertical channels are clipped", "Repeat the drop with a larger measuring range.")
    if len(columns) == 1:
        warnings.append(f"{name}: a single channel does not show modes with a node there, and gives no mode shape")
    used = tuple(columns)
    if release.onsets:
        release = replace(release, onsets=tuple(release.onsets[vertical.index(c)] for c in used))
    driven = shows_motion(record.signals[: int(release.rest_end * record.rate), columns], record.rate, band)
    search = use_whole_decay if driven else find_linear_decay
    linear = search(record, used, release, band, clipped_until)
    lateral = _filter_lateral(record, linear)
    return PreparedDecay(record, used, release, linear, lateral, (*warnings, *linear.warnings), driven)


def extend_decay(decay: PreparedDecay, band: FrequencyBand) -> PreparedDecay:
    """Decay of a record whose residual shows ambient motion, extended to the end of the record."""
    filtered = _filter_record(decay.record, decay.columns, decay.release, band, decay.linear.start)
    linear = _cut_record(decay.record, filtered, (filtered.guard, filtered.samples.shape[0]), decay.linear.evidence)
    kept = tuple(text for text in decay.warnings if text not in decay.linear.warnings)
    return replace(decay, linear=linear, lateral=_filter_lateral(decay.record, linear), warnings=kept, driven=True)


def prepare_again(decay: PreparedDecay, record: DropRecord, band: FrequencyBand) -> PreparedDecay:
    """Decay of a record whose clocks were corrected: the same part if it reaches the end of the record.

    An end before that is searched again: wrong clocks look like a disturbance.
    """
    if decay.linear.end < record.duration - 2 * decay.linear.dt:
        return prepare_decay(record, band)
    filtered = _filter_record(record, decay.columns, decay.release, band, 0.0)
    start = round((decay.linear.start - filtered.begin / record.rate) / decay.linear.dt)
    part = (start, filtered.samples.shape[0])
    linear = _cut_record(record, filtered, part, decay.linear.evidence, decay.linear.poles, decay.linear.warnings)
    return replace(decay, record=record, linear=linear, lateral=_filter_lateral(record, linear))


def _filter_lateral(record: DropRecord, linear: LinearDecay) -> RealArray:
    begin = round(linear.start * record.rate)
    n = linear.samples.shape[0]
    step = round(linear.dt * record.rate)
    signals = record.signals[begin : begin + (n - 1) * step + linear.taps.size, list(record.along("y"))]
    return filter_full_overlap(signals, linear.taps)[::step] if signals.shape[1] else np.zeros((n, 0))


@dataclass(frozen=True)
class _FilteredRecord:
    """Channels after the release, low-pass filtered and decimated: samples, (n, c), and the first linear one."""

    begin: int
    """First sample of the record after the release."""
    samples: RealArray
    rest: RealArray
    """Samples at rest, (r, c)."""
    guard: int
    """First of the samples that may be linear."""
    taps: RealArray
    step: int


def _filter_record(
    record: DropRecord, columns: tuple[int, ...], release: Release, band: FrequencyBand, clipped_until: float
) -> _FilteredRecord:
    signals, rate, name = record.signals[:, list(columns)], record.rate, record.name
    begin = int(release.time * rate)
    taps = low_pass_taps(rate, band.fitted, band.stop, 80.0)
    step = max(1, int(rate / (2.6 * band.stop)))
    available = (signals.shape[0] - begin) / rate
    if available - GUARD < SHORTEST_DECAY:
        raise InputError(
            name,
            f"ends {max(available, 0):.1f} s after the release",
            f"Record 120 to 240 s after the release; at least {SHORTEST_DECAY + GUARD:g} s are needed.",
        )
    samples = filter_full_overlap(signals[begin:], taps)[::step]
    dt, total, shortest = step / rate, samples.shape[0], SHORTEST_DECAY - taps.size / rate
    guard = max(int(GUARD / dt), int(np.ceil((clipped_until - release.time) / dt)) + 1)
    if (total - guard) * dt < shortest:
        raise InputError(name, "is clipped almost to its end", "Repeat the drop with a larger measuring range.")
    dead = np.flatnonzero(np.ptp(signals[begin + guard * step :], axis=0) == 0)
    if dead.size:
        raise InputError(
            f"{name}, channel '{record.channels[columns[dead[0]]].name}'",
            "is constant after the release",
            "Leave this channel out; its sensor failed.",
        )
    quiet = signals[: int(release.rest_end * rate)]
    rest = filter_full_overlap(quiet, taps)[::step] if quiet.shape[0] > taps.size else samples[:0]
    return _FilteredRecord(begin, samples, rest, guard, taps, step)


def find_linear_decay(
    record: DropRecord, columns: tuple[int, ...], release: Release, band: FrequencyBand, clipped_until: float
) -> LinearDecay:
    """Find the longest part after the release that equals a sum of decays within the noise.

    Args:
        record: The record.
        columns: Indices of the vertical channels that are used.
        release: Release of the mass.
        band: Band of the identification.
        clipped_until: Time of the last clipped sample [s]; 0: no sample is clipped.

    Raises:
        InputError: The linear decay is shorter than `SHORTEST_DECAY`, or a channel is constant after the release.
    """
    filtered = _filter_record(record, columns, release, band, clipped_until)
    name, total, dt = record.name, filtered.samples.shape[0], filtered.step / record.rate
    search = DecaySearch(filtered.samples, filtered.guard, dt, band, filtered.rest)
    start, end, poles = search.find_linear_part()
    course = search.follow_residual(end, poles)
    is_calm = course.level(max(start, search.begin), end) <= CALM
    if not is_calm and (begin := search.find_late_begin()) is not None:
        is_calm, search = True, replace(search, begin=begin)
        start, end, poles = search.find_linear_part()
        course = search.follow_residual(end, poles)
    if clipped_until > release.time:
        start = max(start, filtered.guard)
    if (end - start) * dt < SHORTEST_DECAY - filtered.taps.size / record.rate:
        raise InputError(
            name,
            f"is a free decay for only {(end - start) * dt:.1f} s",
            "Repeat the drop in calm weather and without traffic.",
        )
    names = [record.channels[c].name for c in columns]
    if not is_calm:
        _require_calm(name, course, names, (start, end), dt, band)
    warnings = _describe_ends(name, course, names, (start, end), total, dt)
    return _cut_record(record, filtered, (start, end), _build_evidence(course, dt), poles, warnings)


REMEDY = (
    "Record longer, or drop a smaller mass. Slack droppers are a frequent cause, which the record alone does not show."
)
"""Remedy of a record that no sum of decays fits."""

REFUSED = 30.0
"""Power of the residual over that of the motion at rest, above which a record is refused [-]."""


def _require_calm(
    name: str, course: ResidualCourse, channels: list[str], part: tuple[int, int], dt: float, band: FrequencyBand
) -> None:
    """Refuse a record whose residual is far above the motion at rest wherever decays are fitted.

    Raises:
        InputError: It is.
    """
    start, end = part
    if course.level(start, end) > REFUSED:
        inside = (course.starts >= start) & (course.starts + course.window <= end)
        levels = np.sqrt(np.median(course.ratio[inside], axis=0))
        raise InputError(
            name,
            f"has no part of {SHORTEST_DECAY:g} s or longer that is a free decay: from {start * dt:.0f} to "
            f"{end * dt:.0f} s after the release the residual from {band.low:g} to {band.fitted:g} Hz is "
            + ", ".join(f"{level:.0f}" for level in levels)
            + f" times {course.reference}, at {', '.join(channels)}",
            REMEDY,
        )


def _describe_ends(
    name: str, course: ResidualCourse, channels: list[str], part: tuple[int, int], total: int, dt: float
) -> tuple[str, ...]:
    """Sentences on the residual outside the used part, at its ends that are not those of the record."""
    start, end = part
    texts = []
    if start * dt > GUARD + 1.0:
        before = course.starts + course.window <= start
        texts.append(
            f"{name}: used from {start * dt:.1f} s after the release{_describe_part(course, channels, before)}"
        )
    if end < total:
        after = course.starts >= end
        texts.append(f"{name}: used up to {end * dt:.0f} s after the release{_describe_part(course, channels, after)}")
    return tuple(texts)


def _describe_part(course: ResidualCourse, channels: list[str], windows: NDArray[np.bool_]) -> str:
    """Largest residual in some windows, as the end of a sentence."""
    if not windows.any():
        return ""
    largest = np.sqrt(course.ratio[windows].max(axis=0))
    worst = channels[int(largest.argmax())]
    return f"; beyond, the residual reaches {largest.max():.2g} times {course.reference}, at channel {worst}"


def use_whole_decay(
    record: DropRecord, columns: tuple[int, ...], release: Release, band: FrequencyBand, clipped_until: float
) -> LinearDecay:
    """Decay of a line in motion from the guard to the end of the record; parameters as in `find_linear_decay`.

    The poles then show whether it begins later (`decay_onset`).
    """
    filtered = _filter_record(record, columns, release, band, clipped_until)
    search = DecaySearch(filtered.samples, filtered.guard, filtered.step / record.rate, band, filtered.rest)
    evidence = _build_evidence(search.follow_coarse_fit(), search.dt)
    return _cut_record(record, filtered, (filtered.guard, filtered.samples.shape[0]), evidence)


def _build_evidence(course: ResidualCourse, dt: float) -> StretchEvidence:
    return StretchEvidence(np.asarray((course.starts + course.window / 2) * dt), np.sqrt(course.middle))


def _cut_record(
    record: DropRecord,
    filtered: _FilteredRecord,
    part: tuple[int, int],
    evidence: StretchEvidence,
    poles: ComplexArray = NO_POLES,
    warnings: tuple[str, ...] = (),
) -> LinearDecay:
    start, end = part
    rate, dt, half_filter = record.rate, filtered.step / record.rate, (filtered.taps.size - 1) / 2 / record.rate
    return LinearDecay(
        samples=filtered.samples[start:end],
        dt=dt,
        taps=filtered.taps,
        rate=rate,
        start=filtered.begin / rate + start * dt,
        end=filtered.begin / rate + end * dt + 2 * half_filter,
        first=filtered.begin / rate + start * dt + half_filter,
        poles=poles,
        evidence=evidence,
        warnings=warnings,
    )


def choose_band(records: list[DropRecord], highest: float) -> FrequencyBand:
    """Band up to a frequency [Hz], or up to a lower one if the slowest record requires it.

    Raises:
        InputError: The sampling rate of a record is too low for any mode.
    """
    slowest = min(records, key=lambda record: record.rate)
    band = FrequencyBand.up_to(highest, slowest.rate)
    if band.high < min(2 * band.low, highest):
        raise InputError(
            slowest.name,
            f"the sampling rate of {slowest.rate:g} Hz is too low; it limits the modes to {band.high:.2g} Hz",
            "Export the record at its original sampling rate, usually 50 Hz or more.",
        )
    return band
