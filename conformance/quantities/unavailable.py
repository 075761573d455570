"""Why a quantity cannot be given: each reason becomes `skip` in a report, because a number would be believed."""


class QuantityUnavailable(ValueError):
    """The record cannot support a quantity; the message is the reason a reader of the report sees."""


class BandNotObservable(QuantityUnavailable):
    """The rate is too low, or the stretch too short, for a frequency band: its rms would describe something else."""


class AlreadyFiltered(QuantityUnavailable):
    """The force was filtered before it was delivered: what lies above the cut-off is gone, not zero."""


class StretchNotCovered(QuantityUnavailable):
    """The record does not reach over the evaluated stretch: statistics of a part of it are those of another case."""


class ChannelMissing(QuantityUnavailable):
    """The record has no channel for a quantity, so that nothing is known about it."""


class NoMeanForce(QuantityUnavailable):
    """The mean force is not positive: divided by it, the worst record of all would have the lowest variation."""
