"""Spectrum of a filtered force above the cut-off, against the filter it is stated to have gone through."""

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.check import Check, Finding, worst_finding
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE
from pantocheck.conformance.records.record_signals import RecordSignals

STOP_BAND = (2.0, 2.5)
"""Edges of the compared band, in cut-offs: high enough for orders to differ, low enough to stay above rounding."""

MIN_ROLL_OFF_LINES = 10
"""Smallest number of spectral lines in the band; with fewer, one peak decides."""

CONTRADICTION, DOUBT = 1.0, 0.5
"""RMS of the implied unfiltered force in the band, over its RMS below the cut-off.

The reference cases have a seventh. No contact force has as much in this band as everywhere below the cut-off."""


def _check_roll_off(case: Case, signals: RecordSignals) -> Finding | None:
    """Check that the unfiltered force implied by the delivered one is plausible.

    The spectrum is divided by the gain of the filter of the case. A force that was not filtered, or by a filter of
    too low an order, then has more content above the cut-off than any contact force.
    """
    record, low_pass = signals.record, case.file.filter.low_pass
    applied, cutoff = record.filter_applied_Hz, low_pass.cutoff_Hz
    if applied is None or abs(applied / cutoff - 1) > 1e-3:
        return None  # delivered unfiltered, or filtered again by the suite
    if STOP_BAND[1] * cutoff > HIGHEST_SHARE_OF_RATE * record.rate:
        return Finding("unchecked", f"the stated filter: a rate of {record.rate:g} Hz is too low")
    if (STOP_BAND[1] - STOP_BAND[0]) * cutoff * (record.time[-1] - record.time[0]) < MIN_ROLL_OFF_LINES:
        return Finding("unchecked", "the stated filter: the record is too short")
    frequency = np.asarray(np.fft.rfftfreq(record.time.size, 1 / record.rate), dtype=np.float64)
    below = (frequency > 0) & (frequency <= cutoff)
    above = (frequency > STOP_BAND[0] * cutoff) & (frequency <= STOP_BAND[1] * cutoff)
    gain = low_pass.gain(frequency[above], record.rate)
    window = np.hanning(record.time.size)
    findings = []
    for number, force in enumerate(record.force, 1):
        amplitude = np.abs(np.fft.rfft((force - force.mean()) * window))
        implied = np.sqrt(np.sum((amplitude[above] / gain) ** 2))
        share = float(implied / max(np.sqrt(np.sum(amplitude[below] ** 2)), np.finfo(float).tiny))
        if share > DOUBT:
            text = (
                f"the force of pantograph {number} is stated to be filtered at {applied:g} Hz with order "
                f"{low_pass.order}; the unfiltered force would then have {share:.2g} times as much content in "
                f"{STOP_BAND[0] * cutoff:g}-{STOP_BAND[1] * cutoff:g} Hz as below {cutoff:g} Hz: "
                "it was not filtered, or with a lower order; deliver it unfiltered"
            )
            findings.append(Finding("contradiction" if share > CONTRADICTION else "doubt", text))
    return worst_finding(findings)


ROLL_OFF = Check(
    name="roll-off",
    must_hold="a filtered force falls off above the cut-off like the stated filter",
    why="a weaker filter, or none, adds a few percent to the standard deviation",
    needs="filtered contact force",
    run=_check_roll_off,
)
