"""Reasons why a quantity is not available. Each reason is shown as `skip` in a report."""


class QuantityUnavailable(ValueError):
    """The record does not support a quantity; the message states the reason to the reader of the report."""


class BandNotObservable(QuantityUnavailable):
    """The rate is too low, or the analysis section too short, for a frequency band: its RMS would be meaningless."""


class AlreadyFiltered(QuantityUnavailable):
    """The force was filtered before delivery: content above the cut-off was removed and cannot be graded as zero."""


class SectionNotCovered(QuantityUnavailable):
    """Partial coverage of the analysis section would yield the statistics of a different section."""


class ChannelMissing(QuantityUnavailable):
    """The record has no channel for the quantity."""


class SupportsMissing(ChannelMissing):
    """The uplift of a support of the analysis section is missing, and may be the largest one."""


class NoMeanForce(QuantityUnavailable):
    """The mean force is not positive: a ratio to it would give the worst record the lowest variation."""


class NotResampled(QuantityUnavailable):
    """The quantity has no bootstrap replicates, and therefore no uncertainty from the length of the record."""
