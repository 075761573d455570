"""From a record to the free decay of its vertical channels."""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.decay_filters import complete_overlap
from pantocheck.conformance.identification.linear_decay import FrequencyBand, LinearDecay, find_linear_decay
from pantocheck.conformance.identification.release import Release, find_release
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.clipping import find_clipping
from pantocheck.conformance.mass_drops.drop_record import DropRecord

CLIPPED_EARLY = 0.15  # share of the decay: a channel clipped beyond it is left out


@dataclass(frozen=True)
class PreparedDecay:
    """One record, ready to be identified.

    Parameters
    ----------
    record : DropRecord
        As read.
    columns : tuple[int, ...]
        Which of its channels are used (vertical ones).
    release : Release
        When the mass was released.
    stretch : LinearDecay
        Free decay of those channels.
    lateral : (n, l) ndarray
        Lateral channels over the same stretch, treated the same way.
    warnings : tuple[str, ...]
        What is doubtful.
    """

    record: DropRecord
    columns: tuple[int, ...]
    release: Release
    stretch: LinearDecay
    lateral: RealArray
    warnings: tuple[str, ...]

    @property
    def channel_names(self) -> tuple[str, ...]:
        """Names of the channels that are used."""
        return tuple(self.record.channels[c].name for c in self.columns)

    @property
    def test(self) -> tuple[object, ...]:
        """What repeats of one drop have in common."""
        r = self.record
        return (r.drop.mass, r.drop.wire, r.drop.position, tuple(r.channels[c] for c in self.columns), r.quantity)


def prepare_decay(record: DropRecord, band: FrequencyBand) -> PreparedDecay:
    """Find release and linear stretch of a record.

    Raises
    ------
    InputError
        It has no vertical channel, or no usable free decay.
    """
    name = record.name
    vertical = record.along("z")
    if not vertical:
        raise InputError(name, "has no vertical channel", "Give the direction +z or -z to the vertical channels.")
    release = find_release(record.signals[:, list(vertical)], record.rate, record.drop.trigger_nominal, name)
    warnings = [*record.warnings, *release.warnings]
    columns, clipped_until = [], 0.0
    for c in vertical:
        signal = record.signals[:, c]
        last = max((end for _, end in find_clipping(signal)), default=0)
        if last / record.rate > release.time + CLIPPED_EARLY * (record.duration - release.time):
            warnings.append(f"{name}: channel '{record.channels[c].name}' is clipped far into the decay and left out")
            continue
        clipped_until = max(clipped_until, last / record.rate)
        columns.append(c)
    if not columns:
        raise InputError(name, "every vertical channel is clipped", "Repeat the drop with a larger range.")
    if len(columns) == 1:
        warnings.append(f"{name}: a single sensor; modes with a node there cannot be seen, and no shape can be told")
    names = tuple(record.channels[c].name for c in columns)
    stretch = find_linear_decay(record.signals[:, columns], record.rate, release, band, name, names, clipped_until)
    return PreparedDecay(
        record, tuple(columns), release, stretch, _lateral(record, stretch), (*warnings, *stretch.warnings)
    )


def _lateral(record: DropRecord, stretch: LinearDecay) -> RealArray:
    begin = round(stretch.start * record.rate)
    n = stretch.samples.shape[0]
    step = round(stretch.dt * record.rate)
    signals = record.signals[begin : begin + (n - 1) * step + stretch.taps.size, list(record.along("y"))]
    return complete_overlap(signals, stretch.taps)[::step] if signals.shape[1] else np.zeros((n, 0))
