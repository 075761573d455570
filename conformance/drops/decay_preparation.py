"""Preparation of a mass-drop record: release, linear decay of the vertical channels, lateral channels."""

from dataclasses import dataclass, replace

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.decay_kernel import FrequencyBand, filter_full_overlap, low_pass_taps
from pantocheck.conformance.drops.decay_search import SHORTEST_DECAY, DecaySearch
from pantocheck.conformance.drops.drop_record import DropChannel, DropRecord
from pantocheck.conformance.drops.noise_estimate import shows_motion
from pantocheck.conformance.records.force_checks import find_clipping

# Release of the mass: the first sustained movement of a sensor.
TRIGGER_TOLERANCE = 0.6
"""Time before the planned release, until which the record counts as rest [s]."""

ONSET = 8.0
"""Smallest motion over noise at rest that counts as release [-]."""

MIN_REST = 1.0
"""Shortest rest before the release for an estimate of the noise [s]."""


@dataclass(frozen=True)
class Release:
    """Measured release."""

    time: float
    """First motion of a sensor, in the time of the record [s]."""
    rest_end: float
    """End of the rest before the release [s]; 0 if the record has no rest."""
    warnings: tuple[str, ...] = ()
    """Caveats on the release."""


def find_release(signals: RealArray, rate: float, nominal: float | None, name: str) -> Release:
    """Find the release: the first lasting motion of a channel.

    Args:
        signals: Channels, (n, c).
        rate: Sampling rate [Hz].
        nominal: Planned release, in the time of the record [s]; None if unknown.
        name: Name of the record, for messages.

    Raises:
        InputError: No channel moves, the record ends too early, or it has neither a planned release nor a rest at its
            start.
    """
    n = signals.shape[0]
    if nominal is not None and nominal - TRIGGER_TOLERANCE < MIN_REST:
        return Release(nominal, 0.0, (f"{name}: no rest before the release; the planned time of release is used",))
    rest_end = int((nominal - TRIGGER_TOLERANCE) * rate) if nominal is not None else _quiet_start(signals, rate, name)
    if n - rest_end < rate:
        raise InputError(
            name,
            f"ends after {n / rate:.2f} s, but the release is planned at {nominal or rest_end / rate:.2f} s",
            "Record the whole decay, or correct trigger_nominal_s in the sidecar.",
        )
    rest = signals[:rest_end]
    displaced = signals - np.median(rest, axis=0)
    noise = 1.4826 * np.median(np.abs(displaced[:rest_end]), axis=0)
    noise_floor = np.maximum(noise, 1e-9 * np.abs(displaced).max(axis=0))
    beyond = np.any(np.abs(displaced[rest_end:]) > ONSET * noise_floor, axis=1)
    sustained = np.convolve(beyond, np.ones(5), mode="valid") >= 3
    if not sustained.any():
        raise InputError(
            name, "no channel moves after the planned release", "Check trigger_nominal_s, the channels and their units."
        )
    time = (rest_end + int(np.argmax(sustained)) + int(np.argmax(beyond[np.argmax(sustained) :]))) / rate
    late = nominal is not None and time > nominal + 1.0
    warnings = (f"{name}: the first motion is {time - (nominal or 0):.1f} s after the planned release",) if late else ()
    if n / rate - time < 1.0:
        raise InputError(name, f"ends {n / rate - time:.2f} s after the release", "Record the whole decay.")
    return Release(time, max(0.0, min(rest_end / rate, time - 0.1)), warnings)


def _quiet_start(signals: RealArray, rate: float, name: str) -> int:
    """Number of samples of rest at the start, until the standard deviation of half-second windows jumps."""
    width = max(int(0.5 * rate), 4)
    spread = signals[: signals.shape[0] // width * width].reshape(-1, width, signals.shape[1]).std(axis=1)
    floor = np.maximum(spread.min(axis=0, initial=np.inf), np.finfo(float).tiny)
    jump = np.any(spread > 4 * np.maximum(floor, 1e-6 * spread.max(axis=0, initial=0.0)), axis=1)
    if not jump.any() or int(np.argmax(jump)) * width < MIN_REST * rate:
        raise InputError(
            name, "has neither a planned release nor a rest at its start", "Give trigger_nominal_s in the sidecar."
        )
    return int(np.argmax(jump)) * width - width // 2


CLIPPED_EARLY = 0.15
"""Share of the decay after which a clipped channel is left out [-]."""

GUARD = 2.0
"""Estimated time from the release until all droppers are taut again [s]."""


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
    warnings: tuple[str, ...] = ()
    """Reasons why the decay is shorter than the record."""

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
    driven = shows_motion(record.signals[: int(release.rest_end * record.rate), columns], record.rate, band)
    search = use_whole_decay if driven else find_linear_decay
    linear = search(record, used, release, band, clipped_until)
    lateral = _filter_lateral(record, linear)
    return PreparedDecay(record, used, release, linear, lateral, (*warnings, *linear.warnings), driven)


def extend_decay(decay: PreparedDecay, band: FrequencyBand) -> PreparedDecay:
    """Decay of a record whose residual shows ambient motion: as a whole, without the search for disturbances."""
    linear = use_whole_decay(decay.record, decay.columns, decay.release, band, decay.linear.start)
    kept = tuple(text for text in decay.warnings if text not in decay.linear.warnings)
    return replace(decay, linear=linear, lateral=_filter_lateral(decay.record, linear), warnings=kept, driven=True)


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
    return _FilteredRecord(begin, samples, guard, taps, step)


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
    start, end, poles = DecaySearch(filtered.samples, filtered.guard, dt, band).find_linear_part()
    if clipped_until > release.time:
        start = max(start, filtered.guard)
    warnings = []
    if end < total:
        warnings.append(f"{name}: used up to {end * dt:.0f} s after the release; later it is not a free decay")
    if (end - start) * dt < SHORTEST_DECAY - filtered.taps.size / record.rate:
        raise InputError(
            name,
            f"is a free decay for only {(end - start) * dt:.1f} s",
            "Repeat the drop in calm weather and without traffic.",
        )
    if start * dt > GUARD + 1.0:
        warnings.append(f"{name}: the decay is linear only from {start * dt:.1f} s after the release")
    return _cut_record(record, filtered, start, end, poles, tuple(warnings))


def use_whole_decay(
    record: DropRecord, columns: tuple[int, ...], release: Release, band: FrequencyBand, clipped_until: float
) -> LinearDecay:
    """Decay from the estimated end of slack droppers to the end of the record; parameters as in `find_linear_decay`."""
    filtered = _filter_record(record, columns, release, band, clipped_until)
    none = np.zeros(0, dtype=np.complex128)
    return _cut_record(record, filtered, filtered.guard, filtered.samples.shape[0], none, ())


def _cut_record(
    record: DropRecord, filtered: _FilteredRecord, start: int, end: int, poles: ComplexArray, warnings: tuple[str, ...]
) -> LinearDecay:
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
        warnings=warnings,
    )
