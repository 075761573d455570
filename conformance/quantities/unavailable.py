"""Reasons why a quantity is not available. Its criterion has the verdict `skip`, and the report shows the reason."""


class QuantityUnavailable(ValueError):
    """The record lacks data for a quantity; the message is the reason in the report."""


class BandNotObservable(QuantityUnavailable):
    """Sampling rate too low, or analysis section too short, for a frequency band: its RMS would have no meaning."""


class AlreadyFiltered(QuantityUnavailable):
    """Force filtered before delivery: content above the cut-off was removed and must not be graded as zero."""


class SectionNotCovered(QuantityUnavailable):
    """Analysis section covered only in part: the statistics would be those of another section."""


class ChannelMissing(QuantityUnavailable):
    """Channel missing in the record, without which the quantity cannot be computed."""


class SupportsMissing(ChannelMissing):
    """Uplift missing at a support of the analysis section; it may be the largest uplift."""


class NoMeanForce(QuantityUnavailable):
    """Mean force not positive: a ratio to it would be negative, and so lower than that of every good record."""
