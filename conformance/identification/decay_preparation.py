"""Preparation of a record: release, linear decay of its vertical channels, lateral channels."""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.decay_filters import FrequencyBand, complete_overlap
from pantocheck.conformance.identification.linear_decay import LinearDecay, find_linear_decay
from pantocheck.conformance.identification.release import Release, find_release
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.clipping import find_clipping
from pantocheck.conformance.mass_drops.drop_record import DropChannel, DropRecord

CLIPPED_EARLY = 0.15
"""Share of the decay: a channel that is clipped later is left out [-]."""


@dataclass(frozen=True)
class PreparedDecay:
    """Record that is ready for identification.

    Parameters
    ----------
    record : DropRecord
        The record as read.
    columns : tuple of int
        Its vertical channels that are used.
    release : Release
        Release of the mass.
    linear : LinearDecay
        Linear decay of those channels.
    lateral : (n, l) ndarray
        Lateral channels over the same samples, filtered in the same way.
    warnings : tuple of str
        Doubts about the record.
    """

    record: DropRecord
    columns: tuple[int, ...]
    release: Release
    linear: LinearDecay
    lateral: RealArray
    warnings: tuple[str, ...]

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
        """Description of the drop, equal for repeats."""
        drop = self.record.drop
        return (drop.mass, drop.wire, drop.position, self.channels, self.record.quantity)


def prepare_decay(record: DropRecord, band: FrequencyBand) -> PreparedDecay:
    """Find the release and the linear decay of a record.

    Parameters
    ----------
    record : DropRecord
        The record.
    band : FrequencyBand
        Band of the identification.

    Raises
    ------
    InputError
        The record has no vertical channel, or no usable free decay.
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
            warnings.append(f"{name}: channel '{record.channels[c].name}' is clipped far into the decay and left out")
            continue
        clipped_until = max(clipped_until, last)
        columns.append(c)
    if not columns:
        raise InputError(name, "every vertical channel is clipped", "Repeat the drop with a larger range.")
    if len(columns) == 1:
        warnings.append(f"{name}: a single sensor; it misses modes with a node there and gives no mode shape")
    linear = find_linear_decay(record, tuple(columns), release, band, clipped_until)
    return PreparedDecay(
        record, tuple(columns), release, linear, _filter_lateral(record, linear), (*warnings, *linear.warnings)
    )


def _filter_lateral(record: DropRecord, linear: LinearDecay) -> RealArray:
    begin = round(linear.start * record.rate)
    n = linear.samples.shape[0]
    step = round(linear.dt * record.rate)
    signals = record.signals[begin : begin + (n - 1) * step + linear.taps.size, list(record.along("y"))]
    return complete_overlap(signals, linear.taps)[::step] if signals.shape[1] else np.zeros((n, 0))
