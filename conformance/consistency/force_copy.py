"""Copied force: two pantographs of a train have the same contact force only where they meet the same line.

The second pantograph meets the waves of the first. A record in which both have the force and the height of one of them
obeys the equations of the pantograph all the same. The uplift does not: equal forces in the same part of a span need
equal uplifts at the supports. Pantographs that a train at low speed or a long distance keeps apart meet this condition.
"""

from dataclasses import dataclass
from itertools import permutations

import numpy as np
from scipy.signal import correlate

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.check import Check, Finding, worst_finding
from pantocheck.conformance.quantities.line_signals import SUPPORT_TOLERANCE_M
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record_signals import RecordSignals

LARGEST_REMAINDER = 0.01
"""Remainder below which a force is a copy, over its standard deviation.

Forces rounded to 1 N at 200 samples per second leave 0.007. Simulated trains have 0.4 or more at the spacings of the
library; pantographs 880 m apart on a heavily damped line have 0.015."""

SMALLEST_DIFFERENCE_M = 0.5e-3
"""Smallest difference of the uplift at equal passages [m]: five steps of 0.1 mm.

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


def _check_copy(case: Case, signals: RecordSignals) -> Finding | None:
    findings = []
    for number, other in permutations(signals.pantographs, 2):
        pantograph = signals.pantographs[number]
        try:
            likeness = find_likeness(pantograph.graded, signals.pantographs[other].force.graded)
            if likeness is None or likeness.remainder > LARGEST_REMAINDER:
                continue
            delay = (likeness.lag - pantograph.inside.start) / signals.record.rate
            differences = _compare_uplifts(case, signals, (number, other), delay)
        except QuantityUnavailable:
            return None  # other checks state which channel is missing
        findings.append(_judge(number, other, differences))
    return worst_finding([finding for finding in findings if finding is not None])


def find_likeness(part: RealArray, force: RealArray) -> Likeness | None:
    """Find the part of a force that is most like a part of another force.

    Args:
        part: Part of a force, (n,) [N].
        force: Other force, (m,) [N].

    Returns:
        The best part, between samples by a parabola; None if the force is shorter than the part, or constant.
    """
    n = part.size
    deviation, whole = part - part.mean(), force - force.mean()
    energy = float(deviation @ deviation)
    if n < 2 or n > force.size or energy == 0.0:
        return None
    products = correlate(whole, deviation, mode="valid", method="fft")
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
    return Likeness(float(np.sqrt(max(1 - min(peak, 1.0) ** 2, SMALLEST_SQUARE))), best + shift)


def _compare_uplifts(case: Case, signals: RecordSignals, pair: tuple[int, int], delay: float) -> RealArray:
    """Differences between the uplifts where both pantographs of a pair have the same force, (k,) [m].

    Where the first passes one of the k supports of the analysis section, the second, later by the delay [s], must pass
    a support too; otherwise the difference is infinite. It is NaN if the uplift is not recorded there.
    """
    record = signals.record
    inside = zip(signals.line.supports, signals.line.uplift, strict=True)
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


def _judge(number: int, other: int, differences: RealArray) -> Finding | None:
    """Finding on a force that equals that of another pantograph; None if the uplifts are equal as well."""
    known = differences[~np.isnan(differences)]
    largest = float(known.max(initial=0.0))
    if largest > SMALLEST_DIFFERENCE_M:
        where = (
            f"with uplifts at the supports that differ by {1e3 * largest:.2g} mm"
            if np.isfinite(largest)
            else "in another part of the span"
        )
        return Finding("doubt", f"the force of pantograph {number} is a copy of that of pantograph {other}, {where}")
    if known.size < differences.size:
        return Finding(
            "unchecked",
            f"the copy check was not made: pantographs {number} and {other} have the same force, and the record lacks "
            f"the uplift at {differences.size - known.size} of {differences.size} supports to compare",
        )
    return None


COPY = Check(
    name="copy",
    must_hold="pantographs have the same force only in the same part of a span, with the same uplift at the supports",
    why="force and height of the other pantograph agree with each other",
    needs="position, contact force and uplift at supports",
    run=_check_copy,
)
