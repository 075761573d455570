"""Does a force that is said to be filtered fall off as its filter makes it fall?"""

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.finding import Finding
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE
from pantocheck.conformance.records.record import Record

STOP_BAND = (2.0, 2.5)
"""Band that is looked at, in cut-offs: far enough above for orders to differ, near enough to be clear of rounding."""
MIN_LINES = 10
"""Spectral lines in the band; with fewer, one peak decides."""
CONTRADICTION, DOUBT = 1.0, 0.5
"""Share of the rms below the cut-off that the unfiltered force may hold in the band. The reference cases hold a seventh
there; as much as everything below the cut-off is no contact force."""


def check_roll_off(case: Case, record: Record) -> list[Finding]:
    """The unfiltered force that a delivered one implies is plausible.

    What was divided out of the spectrum by the filter of the case is put back. A force that was not filtered, or by a
    filter of too low an order, then holds more above the cut-off than any contact force does.
    """
    low_pass, applied = case.file.filter.low_pass, record.filter_applied_Hz
    cutoff = low_pass.cutoff_Hz
    if applied is None or abs(applied / cutoff - 1) > 1e-3:
        return []  # delivered unfiltered, or filtered here once more
    if STOP_BAND[1] * cutoff > HIGHEST_SHARE_OF_RATE * record.rate:
        text = f"the filter said to be applied: a rate of {record.rate:g} Hz is too low"
        return [Finding("roll-off", "unchecked", text)]
    if (STOP_BAND[1] - STOP_BAND[0]) * cutoff * (record.time[-1] - record.time[0]) < MIN_LINES:
        return [Finding("roll-off", "unchecked", "the filter said to be applied: the record is too short")]
    frequency = np.asarray(np.fft.rfftfreq(record.time.size, 1 / record.rate), dtype=np.float64)
    below = (frequency > 0) & (frequency <= cutoff)
    above = (frequency > STOP_BAND[0] * cutoff) & (frequency <= STOP_BAND[1] * cutoff)
    gain = low_pass.gain(frequency[above], record.rate)
    window = np.hanning(record.time.size)
    for number, force in enumerate(record.force, 1):
        amplitude = np.abs(np.fft.rfft((force - force.mean()) * window))
        implied = np.sqrt(np.sum((amplitude[above] / gain) ** 2))
        share = float(implied / max(np.sqrt(np.sum(amplitude[below] ** 2)), np.finfo(float).tiny))
        if share > DOUBT:
            text = (
                f"the force of pantograph {number} is said to be filtered at {applied:g} Hz, but before an order "
                f"{low_pass.order} it would have held {share:.2g} times as much between "
                f"{STOP_BAND[0] * cutoff:g} and {STOP_BAND[1] * cutoff:g} Hz as in all below {cutoff:g} Hz: "
                "it was not filtered, or by a lower order; deliver it unfiltered"
            )
            return [Finding("roll-off", "contradiction" if share > CONTRADICTION else "doubt", text)]
    return []
