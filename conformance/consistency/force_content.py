"""Content of the contact force above the cut-off, against the least content that kinks of the wire cause.

Force and contact height that pass the same filter still obey the equations of the pantograph. The filter shows in the
spectrum. The wire has kinks at droppers and supports. A kink passed at constant speed is a motion with the spectrum
1 / f^2. Pantograph, contact spring and wire in series turn it into the force

    F  ~  1 / [(H + 1 / k + W) f^2],        W = 1 / (2 i w sqrt(T m)),

with the receptance H of the head, the contact stiffness k and the receptance W of an infinite string with tension T and
mass m per length. Waves and loss of contact add content. A filter of order 6 falls by another factor of f^-6.

Bending rounds a kink over the length sqrt(EI / T). The content is compared only if the train passes this length fast
enough for 50 Hz.
"""

from dataclasses import replace

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.check import Check, Finding, worst_finding
from pantocheck.conformance.consistency.force_dynamics import TINY
from pantocheck.conformance.consistency.receptance import head_receptance
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record_signals import RecordSignals

LOWER_BAND_HZ = (5.0, 20.0)
"""Edges of the band of reference [Hz]."""

UPPER_BAND_HZ = (30.0, 50.0)
"""Edges of the compared band [Hz]; a low sampling rate cuts its upper edge."""

LOWEST_EDGE_HZ = 40.0
"""Smallest upper edge of the compared band [Hz]: 100 samples per second."""

SMALLEST_CONTENT = 0.08
"""Smallest content of the force over that of kinks.

Library cases have 0.9 to 2.0, extreme lines 0.4 or more, and 0.18 after a stated causal filter. A filter of order 6 at
15 Hz that is not stated leaves 0.014 to 0.03, one at 10 Hz that is stated as 20 Hz leaves 0.02 to 0.05."""

FREQUENCY_STEP_HZ = 0.1
"""Step of the frequencies at which the content of kinks is computed [Hz]; resonances are wider."""


def _check_content(case: Case, signals: RecordSignals) -> Finding | None:
    record = signals.record
    if record.speed < 2 * np.pi * UPPER_BAND_HZ[1] * bending_length(case):
        return None
    upper = min(UPPER_BAND_HZ[1], HIGHEST_SHARE_OF_RATE * record.rate)
    if upper < LOWEST_EDGE_HZ:
        return Finding("unchecked", f"the content check was not made: a rate of {record.rate:g} Hz is too low")
    findings = []
    for number in signals.pantographs:
        try:
            share = force_content(signals, number, upper) / kink_content(case, number, upper)
        except QuantityUnavailable:
            return None  # other checks state which channel is missing
        if share < SMALLEST_CONTENT:
            findings.append(
                Finding(
                    "doubt",
                    f"pantograph {number}: the force has {share:.1g} times the content at {UPPER_BAND_HZ[0]:g}-"
                    f"{upper:g} Hz that kinks of the wire cause, as after a filter that is not stated, or by a model "
                    "without droppers or with a coarse mesh; deliver force and contact height without a filter, or "
                    "refine the model",
                )
            )
    return worst_finding(findings)


def bending_length(case: Case) -> float:
    """Length over which bending rounds a kink of the contact wire, sqrt(EI / T) [m]."""
    wire = case.line.contact_wire
    return float(np.sqrt(wire.bending_stiffness_N_m2 / wire.tension_N))


def force_content(signals: RecordSignals, number: int, upper: float) -> float:
    """RMS of the force in the upper band over that in the lower band, before the stated filter [-].

    Args:
        signals: Signals of a record.
        number: Number of the pantograph from 1.
        upper: Upper edge of the upper band [Hz].
    """
    record, force = signals.record, signals.pantographs[number].delivered
    frequency = np.asarray(np.fft.rfftfreq(force.size, 1 / record.rate), dtype=np.float64)
    amplitude = np.abs(np.fft.rfft((force - force.mean()) * np.hanning(force.size)))
    frequency, amplitude = frequency[frequency <= upper], amplitude[frequency <= upper]
    stated = record.filter_applied_Hz
    if stated is not None and stated <= HIGHEST_SHARE_OF_RATE * record.rate:
        amplitude = amplitude / replace(signals.low_pass, cutoff_Hz=stated).gain(frequency, record.rate)
    return _compare_bands(frequency, amplitude)


def kink_content(case: Case, number: int, upper: float) -> float:
    """The same ratio of the force that a kink of the contact wire causes [-].

    Args:
        case: Case with line and pantographs.
        number: Number of the pantograph from 1.
        upper: Upper edge of the upper band [Hz].
    """
    file, wire = case.pantographs[number - 1], case.line.contact_wire
    frequency = np.arange(LOWER_BAND_HZ[0], upper, FREQUENCY_STEP_HZ)
    omega = 2 * np.pi * frequency
    string = 1 / (2j * omega * wire.number * np.sqrt(wire.tension_N * wire.mass_kg_m))
    compliance = head_receptance(file, omega) + 1 / file.contact.stiffness_N_m + string
    return _compare_bands(frequency, np.abs(1 / compliance) / frequency**2)


def _compare_bands(frequency: RealArray, amplitude: RealArray) -> float:
    """RMS above the lower edge of the upper band over that in the lower band [-]."""
    low, high = LOWER_BAND_HZ
    lower_rms = np.linalg.norm(amplitude[(frequency > low) & (frequency <= high)])
    return float(np.linalg.norm(amplitude[frequency > UPPER_BAND_HZ[0]]) / max(float(lower_rms), TINY))


CONTENT = Check(
    name="content",
    must_hold="at 30-50 Hz, the force has at least 0.08 times the content that kinks of the wire cause",
    why="force and contact height that pass the same filter still agree with each other",
    needs="contact force at 100 samples per second or more",
    run=_check_content,
)
