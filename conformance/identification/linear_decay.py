"""Linear decay of a record: the part that a sum of decays explains down to the noise."""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import ComplexArray, RealArray
from pantocheck.conformance.identification.decay_filters import FrequencyBand, complete_overlap, low_pass_decay
from pantocheck.conformance.identification.decay_search import SHORTEST_DECAY, DecaySearch
from pantocheck.conformance.identification.release import Release
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_record import DropRecord

GUARD = 2.0
"""First guess of the time after the release in which all droppers have become taut again [s]."""


@dataclass(frozen=True)
class LinearDecay:
    """Linear decay of one record, low-passed and decimated; every decay in it keeps its pole.

    Parameters
    ----------
    samples : (n, c) ndarray
        Channels [unit of the record].
    dt : float
        Sampling interval [s].
    taps : (t,) ndarray
        The low-pass at the original sampling rate.
    rate : float
        Original sampling rate [Hz].
    start, end : float
        Part of the record that was used, in the time of the record [s].
    first : float
        Time of the first sample after the delay of the filter, in the time of the record [s].
    poles : (m,) complex ndarray
        Poles of the search for the linear part [1/s]. An identification starts from them only if its records have
        different sampling rates; else it searches its start poles in all records together.
    warnings : tuple of str
        Reasons why it is shorter than the record.
    """

    samples: RealArray
    dt: float
    taps: RealArray
    rate: float
    start: float
    end: float
    first: float
    poles: ComplexArray
    warnings: tuple[str, ...] = ()

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self.samples.shape[0] * self.dt)


def find_linear_decay(
    record: DropRecord, columns: tuple[int, ...], release: Release, band: FrequencyBand, clipped_until: float = 0.0
) -> LinearDecay:
    """Find the longest part after the release that a sum of decays explains down to the noise.

    Parameters
    ----------
    record : DropRecord
        The record.
    columns : tuple of int
        Its channels that are used.
    release : Release
        Release of the mass.
    band : FrequencyBand
        Band of the identification.
    clipped_until : float
        Time of the last clipped sample [s].

    Raises
    ------
    InputError
        The linear decay is shorter than `SHORTEST_DECAY`, or a channel is constant after the release.
    """
    signals, rate, name = record.signals[:, list(columns)], record.rate, record.name
    begin = int(release.time * rate)
    taps = low_pass_decay(rate, band.fitted, band.stop, 80.0)
    step = max(1, int(rate / (2.6 * band.stop)))
    available = (signals.shape[0] - begin) / rate
    if available - GUARD < SHORTEST_DECAY:
        raise InputError(
            name,
            f"only {max(available, 0):.1f} s after the release",
            f"At least {SHORTEST_DECAY + GUARD:g} s are needed, and minutes for a damping ratio: record 120 to 240 s.",
        )
    samples = complete_overlap(signals[begin:], taps)[::step]
    dt, total, shortest = step / rate, samples.shape[0], SHORTEST_DECAY - taps.size / rate
    guard = max(int(GUARD / dt), int(np.ceil((clipped_until - release.time) / dt)) + 1)
    if (total - guard) * dt < shortest:
        raise InputError(name, "is clipped or disturbed almost to its end", "Repeat the drop with a larger range.")
    dead = np.flatnonzero(np.ptp(signals[begin + guard * step :], axis=0) == 0)
    if dead.size:
        raise InputError(
            f"{name}, channel '{record.channels[columns[dead[0]]].name}'",
            "never changes after the release",
            "The sensor was lost: remove this channel from the sidecar.",
        )
    start, end, poles = DecaySearch(samples, guard, dt, band).find_linear_part()
    if clipped_until > release.time:
        start = max(start, guard)
    warnings = []
    if end < total:
        warnings.append(f"{name}: used up to {end * dt:.0f} s after the release; the rest is not a free decay")
    if (end - start) * dt < shortest:
        raise InputError(
            name,
            f"is a free decay for only {(end - start) * dt:.1f} s",
            "Repeat the drop in calm weather and away from traffic.",
        )
    if start * dt > GUARD + 1.0:
        warnings.append(f"{name}: not a linear decay before {start * dt:.1f} s after the release")
    half_filter = (taps.size - 1) / 2 / rate
    return LinearDecay(
        samples=samples[start:end],
        dt=dt,
        taps=taps,
        rate=rate,
        start=begin / rate + start * dt,
        end=begin / rate + end * dt + 2 * half_filter,
        first=begin / rate + start * dt + half_filter,
        poles=poles,
        warnings=tuple(warnings),
    )
