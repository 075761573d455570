"""Checks of the contact force: its content above the cut-off against that of kinks of the wire, and copied forces.

Force and contact height that pass the same filter still obey the equations of the pantograph. The filter shows in the
spectrum. The wire has kinks at droppers and supports. A kink passed at constant speed is a motion with the spectrum
1 / f^2. Pantograph, contact spring and wire in series turn it into the force

    F  ~  1 / [(H + 1 / k + W) f^2],        W = 1 / (2 i w sqrt(T m)),

with the receptance H of the head, the contact stiffness k and the receptance W of an infinite string with tension T and
mass m per length. Waves and loss of contact add content. A filter of order 6 falls by another factor of f^-6.

Bending rounds a kink over the length sqrt(EI / T). The content is compared only if the train passes this length fast
enough for 50 Hz.
"""

from dataclasses import dataclass
from itertools import permutations

import numpy as np
import scipy

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.pantograph.pantograph_model import head_receptance
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE
from pantocheck.conformance.quantities.line_signals import SUPPORT_TOLERANCE_M
from pantocheck.conformance.quantities.unavailable import BandNotObservable, QuantityUnavailable
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.check import (
    DOES_NOT_APPLY,
    NAMED_ELSEWHERE,
    TINY,
    Check,
    Finding,
    Measure,
    report_low_rate,
    report_not_made,
    windowed_spectrum,
    worst_finding,
)

LOWER_BAND_HZ = (5.0, 20.0)
"""Edges of the band of reference [Hz]."""

UPPER_BAND_HZ = (30.0, 50.0)
"""Edges of the compared band [Hz]; a low sampling rate cuts its upper edge."""

LOWEST_EDGE_HZ = 40.0
"""Smallest upper edge of the compared band [Hz]: 100 samples per second."""

KINK_SHARE = Measure("content of the force over that of kinks", "", {"doubt": 0.08}, "below")
"""Content of the force over that of kinks.

Library cases have 0.9 to 2.0, extreme lines 0.4 or more, and 0.18 after a stated causal filter. A filter of order 6 at
15 Hz that is not stated leaves 0.014 to 0.03, one at 10 Hz that is stated as 20 Hz leaves 0.02 to 0.05."""

FREQUENCY_STEP_HZ = 0.1
"""Step of the frequencies at which the content of kinks is computed [Hz]; resonances are wider."""


def _check_content(case: Case, signals: RecordSignals) -> Finding:
    record = signals.record
    if record.speed < 2 * np.pi * UPPER_BAND_HZ[1] * bending_length(case):
        return DOES_NOT_APPLY
    upper = min(UPPER_BAND_HZ[1], HIGHEST_SHARE_OF_RATE * record.rate)
    if upper < LOWEST_EDGE_HZ:
        return report_low_rate("content", record.rate)
    findings = []
    for number in signals.pantographs:
        try:
            share = force_content(signals, number, upper) / kink_content(case, number, upper)
        except QuantityUnavailable:
            return NAMED_ELSEWHERE
        text = (
            f"pantograph {number}: the force has {share:.1g} times the content at {UPPER_BAND_HZ[0]:g}-"
            f"{upper:g} Hz that kinks of the wire cause, as after a filter that is not stated, or by a model "
            "without droppers or with a coarse mesh; deliver force and contact height without a filter, or "
            "refine the model"
        )
        findings.append(KINK_SHARE.compare(share, f"pantograph {number}", text))
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
    frequency, amplitude = windowed_spectrum(force, record.rate)
    frequency, amplitude = frequency[frequency <= upper], amplitude[frequency <= upper]
    stated = record.filter_applied_Hz
    if stated is not None and stated <= HIGHEST_SHARE_OF_RATE * record.rate:
        amplitude = amplitude / signals.low_pass.change_cutoff(stated).gain(frequency, record.rate)
    return _compare_bands(frequency, amplitude)


def kink_content(case: Case, number: int, upper: float) -> float:
    """Ratio as in `force_content`, of the force that a kink of the contact wire causes [-].

    Args:
        case: Case with line and pantographs.
        number: Number of the pantograph from 1.
        upper: Upper edge of the upper band [Hz].
    """
    file, wire = case.pantographs[number - 1], case.line.contact_wire
    frequency = np.arange(LOWER_BAND_HZ[0], upper, FREQUENCY_STEP_HZ)
    omega = 2 * np.pi * frequency
    string = 1 / (2j * omega * wire.number * np.sqrt(wire.tension_N * wire.mass_kg_m))
    contact = file.compliance(case.lift_forces[number - 1].uplift_force)
    compliance = head_receptance(file, omega) + contact + string
    return _compare_bands(frequency, np.abs(1 / compliance) / frequency**2)


def _compare_bands(frequency: RealArray, amplitude: RealArray) -> float:
    """RMS above the lower edge of the upper band over that in the lower band [-]."""
    low, high = LOWER_BAND_HZ
    lower_rms = np.linalg.norm(amplitude[(frequency > low) & (frequency <= high)])
    return float(np.linalg.norm(amplitude[frequency > UPPER_BAND_HZ[0]]) / max(float(lower_rms), TINY))


CONTENT = Check(
    name="content",
    must_hold="at 30-50 Hz, the force has at least 0.08 times the content that kinks of the wire cause",
    purpose="force and contact height that pass the same filter still agree with each other",
    needs="contact force at 100 samples per second or more",
    run=_check_content,
    measures=(KINK_SHARE,),
    causes=("not possible", "does not apply", "named by another check"),
)


# Copied force: two pantographs of a train have the same contact force only where they meet the same line.
#
# The second pantograph meets the waves of the first. A record in which both have the force and the height of one of
# them obeys the equations of the pantograph all the same. The uplift does not: equal forces in the same part of a span
# need equal uplifts at the supports. Pantographs that a train at low speed or a long distance keeps apart meet this
# condition.
FORCE_REMAINDER = Measure("difference from the force of another pantograph", "", {"doubt": 0.01}, "below")
"""Remainder below which a force is a copy, over its standard deviation.

Forces rounded to 1 N at 200 samples per second leave 0.007. Simulated trains have 0.4 or more at the spacings of the
library; pantographs 880 m apart on a heavily damped line have 0.015."""

UPLIFT_DIFFERENCE = Measure("difference of the uplift at passages with the same force", "mm", {"doubt": 0.5})
"""Difference of the uplift at equal passages: five steps of 0.1 mm.

Where the forces of simulated trains differ by less than 0.1 of their standard deviation, it is 0.14 mm or less."""

SMALLEST_VARIANCE = 0.01
"""Smallest variance of a part over the largest variance of all parts: a part that hardly varies has no correlation."""

SMALLEST_SQUARE = 1e-12
"""Smallest square of a correlation remainder; rounding of the sums."""


@dataclass(frozen=True)
class Likeness:
    """Part of a force that is most like a part of another force."""

    remainder: float
    """Standard deviation of the difference after a fit of gain and constant, over the standard deviation [-]."""
    lag: float
    """Time of the part in the other force less that in the force [samples]."""


def _check_copy(case: Case, signals: RecordSignals) -> Finding:
    findings = []
    for number, other in permutations(signals.pantographs, 2):
        pantograph = signals.pantographs[number]
        try:
            likeness = find_likeness(pantograph.graded, signals.pantographs[other].force.graded)
            if likeness is None:
                continue
            finding = FORCE_REMAINDER.compare(likeness.remainder, f"pantograph {number}")
            if finding.kind == "confirmed":
                findings.append(finding)
                continue
            delay = (likeness.lag - pantograph.inside.start) / signals.record.rate
            differences = _compare_uplifts(case, signals, (number, other), delay)
        except BandNotObservable:
            return DOES_NOT_APPLY  # the section is too short for any statistics
        except QuantityUnavailable:
            return NAMED_ELSEWHERE
        findings.append(_judge((number, other), likeness.remainder, differences))
    return worst_finding(findings)


def find_likeness(part: RealArray, force: RealArray) -> Likeness | None:
    """Find the part of a force that is most like a part of another force.

    Args:
        part: Part of a force, (n,) [N].
        force: Other force, (m,) [N].

    Returns:
        The best part, between samples by a parabola; None if the force is shorter than the part, or the part constant.
    """
    n = part.size
    deviation, whole = part - part.mean(), force - force.mean()
    energy = float(deviation @ deviation)
    if n < 2 or n > force.size or energy == 0.0:
        return None
    size = scipy.fft.next_fast_len(force.size, real=True)
    spectra = np.fft.rfft(whole, size), np.fft.rfft(deviation, size)
    products = np.fft.irfft(spectra[0] * spectra[1].conj(), size)[: force.size - n + 1]
    sums, squares = (np.cumsum(np.concatenate([[0.0], values])) for values in (whole, whole**2))
    variance = squares[n:] - squares[:-n] - (sums[n:] - sums[:-n]) ** 2 / n
    varies = variance > SMALLEST_VARIANCE * variance.max()
    correlation = np.where(varies, products / np.sqrt(np.where(varies, variance, 1.0) * energy), -1.0)
    best = int(correlation.argmax())
    peak, shift = float(correlation[best]), 0.0
    if 0 < best < correlation.size - 1:
        before, after = correlation[best - 1], correlation[best + 1]
        curvature = before - 2 * peak + after
        if curvature < 0:
            shift = float((before - after) / (2 * curvature))
            peak -= float((before - after) ** 2 / (8 * curvature))
    return Likeness(float(np.sqrt(max(1 - np.clip(peak, 0.0, 1.0) ** 2, SMALLEST_SQUARE))), best + shift)


def _compare_uplifts(case: Case, signals: RecordSignals, pair: tuple[int, int], delay: float) -> RealArray:
    """Differences between the uplifts where both pantographs of a pair have the same force, (k,) [m].

    Where the first passes one of the k supports of the analysis section, the second, later by the delay [s], must pass
    a support too; otherwise the difference is infinite. It is NaN if the uplift is not recorded there.
    """
    record = signals.record
    inside = zip(signals.delivered_line.supports, signals.delivered_line.uplift, strict=True)
    position, other = (record.position[number - 1] for number in pair)
    recorded, channels = record.support_position, record.support_uplift
    assert recorded is not None
    assert channels is not None
    supports = np.asarray(case.line.geometry.span_limits)
    differences = []
    for support, uplift in inside:
        time = float(np.interp(support, position, record.time))
        place = float(np.interp(time + delay, record.time, other))
        nearest = int(np.abs(recorded - place).argmin())
        if abs(recorded[nearest] - place) <= SUPPORT_TOLERANCE_M:
            passage = float(np.interp(recorded[nearest], other, record.time))
            at_passage = np.interp(passage, record.time, channels[nearest])
            differences.append(abs(float(at_passage - np.interp(time, record.time, uplift))))
        else:
            passes = np.abs(supports - place).min() <= SUPPORT_TOLERANCE_M
            differences.append(np.nan if passes else np.inf)
    return np.array(differences)


def _judge(pair: tuple[int, int], remainder: float, differences: RealArray) -> Finding:
    """Finding on a force that equals that of the other pantograph of a pair: the uplifts must be equal as well."""
    (number, other), known = pair, 1e3 * differences[~np.isnan(differences)]
    largest, part = float(known.max(initial=0.0)), f"pantograph {number}"
    text = f"the force of {part} is a copy of that of pantograph {other}"
    if np.isinf(largest):
        return FORCE_REMAINDER.compare(remainder, part, f"{text}, in another part of the span")
    finding = UPLIFT_DIFFERENCE.compare(
        largest, part, f"{text}, with uplifts at the supports that differ by {largest:.2g} mm"
    )
    if finding.kind == "confirmed" and known.size < differences.size:
        return report_not_made(
            "copy",
            f"pantographs {number} and {other} have the same force, and the record lacks "
            f"the uplift at {differences.size - known.size} of {differences.size} supports to compare",
        )
    return finding


COPY = Check(
    name="copy",
    must_hold="pantographs have the same force only in the same part of a span, with the same uplift at the supports",
    purpose="force and height of the other pantograph agree with each other",
    needs="position, contact force and uplift at supports",
    run=_check_copy,
    measures=(FORCE_REMAINDER, UPLIFT_DIFFERENCE),
    causes=("not possible", "does not apply", "named by another check"),
)
