"""Roll-off check: above the cut-off, the spectrum of a filtered force must agree with the stated filter."""

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.check import Check, Finding, worst_finding
from pantocheck.conformance.quantities.filters import is_observable, is_same_cutoff
from pantocheck.conformance.records.record_signals import RecordSignals

STOP_BAND = (2.0, 2.5)
"""Edges of the compared band, in cut-offs: high enough for orders to differ, low enough to stay above rounding."""

MIN_ROLL_OFF_LINES = 10
"""Smallest number of spectral lines in the band; with fewer, one peak decides."""

CONTRADICTION, DOUBT = 1.0, 0.5
"""Thresholds of a ratio: RMS of the implied unfiltered force in the band, divided by its RMS below the cut-off.

The ratio of the reference cases is about 0.14. No contact force reaches a ratio of 1."""


def _check_roll_off(case: Case, signals: RecordSignals) -> Finding | None:
    """Check that the unfiltered force implied by the delivered one is plausible.

    The spectrum is divided by the gain of the filter of the case. A force that was not filtered, or by a filter of
    too low an order, then has more content above the cut-off than any contact force.
    """
    record, low_pass = signals.record, case.file.filter.low_pass
    applied, cutoff = record.filter_applied_Hz, low_pass.cutoff_Hz
    if applied is None or not is_same_cutoff(applied, cutoff):
        return None  # delivered unfiltered, or filtered again by the suite
    if not is_observable(STOP_BAND[1] * cutoff, record.rate):
        return Finding("unchecked", f"the roll-off check was not made: a rate of {record.rate:g} Hz is too low")
    if (STOP_BAND[1] - STOP_BAND[0]) * cutoff * (record.time[-1] - record.time[0]) < MIN_ROLL_OFF_LINES:
        return Finding("unchecked", "the roll-off check was not made: the record is too short")
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
                f"pantograph {number}: the stated filter of the force ({applied:g} Hz, order {low_pass.order}) is not "
                f"plausible; before this filter, the force would have {share:.2g} times as much content in "
                f"{STOP_BAND[0] * cutoff:g}-{STOP_BAND[1] * cutoff:g} Hz as below {cutoff:g} Hz; "
                "deliver the unfiltered force"
            )
            findings.append(Finding("contradiction" if share > CONTRADICTION else "doubt", text))
    return worst_finding(findings)


ROLL_OFF = Check(
    name="roll-off",
    must_hold="above the cut-off, a filtered force falls off like the stated filter",
    why="a weaker filter, or none, increases the standard deviation by a few percent",
    needs="filtered contact force",
    run=_check_roll_off,
)
