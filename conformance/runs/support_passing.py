"""Support passing check: positions of the pantographs compared with the uplift at the supports.

The largest uplift of a support says little about the passage: reflections, lost contact and speeds near the wave speed
move it by tens of metres. Two facts hold on every line; either confirms the positions.

Kink. The contact force F bends the contact wire (tension T, mass per length m) into a kink that moves with the speed v.
The balance of momentum at the contact point gives the jump of the slope, -F / (T - m v^2), whatever happens elsewhere.
The velocity of the uplift of a support therefore jumps by -F v / (T - m v^2) when the pantograph passes, and

    u(t + L/v) - 2 u(t) + u(t - L/v)  =  -F L / (T - m v^2)  +  terms of order L^2:

downwards below the wave speed c = sqrt(T / m), upwards above it. Bending stiffness rounds the kink over some decimetres
and keeps it finite near c. The left side is computed for every pantograph, shifted by up to 1.2 spans, and summed over
the supports with the contact force as weight, so that a passage without contact does not count.

Coincidence. While there is contact, the contact point lies on the wire. At the passage, the contact height exceeds the
uplift of the support by the penetration F / k and by a constant, the datum of the height. Over the supports, the
difference scatters far less at the true passage than at other times.

The record is contradicted if the pantograph touches the wire at the stated passages without a kink there, and a clear
kink appears elsewhere. Without a clear kink, the coincidence confirms the record; otherwise the check is undecided.
"""

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.units import STANDARD_GRAVITY
from pantocheck.conformance.line.elements.line_layout import SpanLayout
from pantocheck.conformance.line.elements.tension_section import SectionRise
from pantocheck.conformance.quantities.filters import is_observable
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.check import (
    TINY,
    Check,
    Finding,
    Measure,
    report_low_rate,
    report_not_made,
    worst_finding,
)

PASSING_TOLERANCE_M = 5.0
"""Accepted distance between a support and the pantograph whose kink passes it [m]: the error of a measured position."""

KINK_SHIFT = Measure("shift at which the wire bends at the supports", "m", {"contradiction": PASSING_TOLERANCE_M})

COINCIDENCE_TOLERANCE_M = 0.5
"""Accepted shift of the coincidence [m]: two samples of a slow record."""

SCATTER = Measure("scatter of height less uplift at the passages", "", {"unchecked": 0.25})
"""Scatter at the passage, over the median of all shifts.

Most simulated records have 0.05; equal spans at 200 samples per second have 0.15."""

KINK_LENGTH_M = 1.5
"""Distance L [m]: above the rounding by bending, some decimetres, and below the distance of droppers."""

SHIFT_STEP_M, LARGEST_SHIFT_SPANS = 0.25, 1.2
"""Step [m] and range [spans] of the shifts; the range includes the neighbouring supports."""

SMALLEST_KINK = 0.25
"""Smallest kink that is recognised, over F L / T: 1 / |1 - (v/c)^2| in theory, 0.4 to 2.2 on extreme lines."""

CLEAR_RATIO = 2.5
"""Ratio of the kink elsewhere to that at the stated passage from which a shift is certain.

The largest on a correct record is 2.1: one dropper per span, uplift and force filtered at 20 Hz, contact lost for a
fifth of the time. A shift by 10 m gives 3 or more on most lines."""

SMALLEST_CONTACT = 0.25
"""Smallest sum of squared contact forces at the stated passages, over that of the best shift."""


def _check_support_passing(case: Case, signals: RecordSignals) -> Finding:
    record, cutoff = signals.record, case.file.filter.cutoff_Hz
    try:
        passages = _Passages(case, signals)
    except QuantityUnavailable as reason:
        return report_not_made("support passing", str(reason))
    if passages.length > PASSING_TOLERANCE_M or not is_observable(cutoff, record.rate):
        return report_low_rate("support passing", record.rate)
    near = np.abs(passages.shifts) <= PASSING_TOLERANCE_M
    unclear, findings = [], []
    for number in signals.pantographs:
        part = f"pantograph {number}"
        kink, contact = passages.kinks(number)
        best = int(kink.argmax())
        shift = passages.shifts[best]
        touching = contact >= SMALLEST_CONTACT * contact.max()
        if near[best] and touching[best] and kink[best] >= SMALLEST_KINK:
            findings.append(KINK_SHIFT.compare(abs(shift), part))
            continue
        if touching[near].any() and kink[best] >= max(SMALLEST_KINK, CLEAR_RATIO * kink[near].max()):
            text = (
                f"the position of {part} contradicts the uplift: the wire bends at a support when the "
                f"position is {abs(shift):.3g} m {'past' if shift > 0 else 'before'} it"
            )
            return KINK_SHIFT.compare(abs(shift), part, text)
        # On a periodic line other shifts coincide, too: a coincidence does not outweigh a clear kink elsewhere.
        finding = SCATTER.compare(passages.scatter(number), part)
        findings.append(finding)
        if finding.kind == "unchecked":
            unclear.append(str(number))
    if unclear:
        text = f"the uplift at the supports shows no clear passage of pantograph {', '.join(unclear)}"
        return report_not_made("support passing", text)
    return worst_finding(findings)


class _Passages:
    """Passages of the supports of the analysis section by shifted pantographs.

    Args:
        case: Case with the tension and the mass of the contact wires.
        signals: Signals of the record, with uplift at supports.
    """

    def __init__(self, case: Case, signals: RecordSignals) -> None:
        self._case, self._signals = case, signals
        line = signals.delivered_line
        self._supports, self._uplift = line.supports, line.uplift
        self.length = max(KINK_LENGTH_M, 2 * signals.record.speed / signals.record.rate)
        steps = round(LARGEST_SHIFT_SPANS * case.line.geometry.longest_span / SHIFT_STEP_M)
        self.shifts = SHIFT_STEP_M * np.arange(-steps, steps + 1)

    def kinks(self, number: int) -> tuple[RealArray, RealArray]:
        """Kink of the uplift over F L / T, positive in the expected direction, and sum of F^2 [N2], for every shift.

        Passages outside the record, without a known uplift, or while another pantograph passes the same support, do not
        count.
        """
        record, wire = self._signals.record, self._case.line.contact_wire
        time, delay = record.time, self.length / record.speed
        force = np.maximum(self._signals.pantographs[number].force.graded, 0.0)
        products, squares = np.zeros(self.shifts.size), np.zeros(self.shifts.size)
        for support, uplift in zip(self._supports, self._uplift, strict=True):
            moment = self._moment(number, support)
            before, passing, after = (np.interp(moment + step, time, uplift) for step in (-delay, 0.0, delay))
            counted = (moment >= time[0] + delay) & (moment <= time[-1] - delay)
            for other in np.delete(record.position, number - 1, axis=0):
                counted &= np.abs(np.interp(moment, time, other) - support) > PASSING_TOLERANCE_M
            bend = before - 2 * passing + after
            counted &= np.isfinite(bend)
            load = np.where(counted, np.interp(moment, time, force), 0.0)
            products += np.where(counted, bend, 0.0) * load
            squares += load**2
        expected = -np.sign(wire.tension_N - wire.mass_kg_m * record.speed**2) * self.length
        scale = wire.number * wire.tension_N / (expected or np.inf)
        return np.asarray(scale * products / np.maximum(np.sqrt(squares * squares.max()), TINY)), squares

    def scatter(self, number: int) -> float:
        """Scatter of contact height less uplift and penetration at the stated passages, over that of all shifts."""
        record, file = self._signals.record, self._case.pantographs[number - 1]
        if record.contact_height is None:
            return np.inf
        height, force = record.contact_height[number - 1], record.force[number - 1]
        rest, differences = rest_heights(self._case, self._supports), []
        for support, uplift, rest_height in zip(self._supports, self._uplift, rest, strict=True):
            moment = self._moment(number, support)
            load = np.interp(moment, record.time, force)
            gap = np.interp(moment, record.time, height) - np.interp(moment, record.time, uplift)
            gap -= file.penetration(load) + rest_height
            differences.append(np.where(np.isfinite(moment) & (load > 0), gap, np.nan))
        scatter = _scatter(np.array(differences))
        at_passage = scatter[np.abs(self.shifts) <= COINCIDENCE_TOLERANCE_M]
        if not (np.isfinite(scatter).any() and np.isfinite(at_passage).any()):
            return np.inf
        return float(np.nanmin(at_passage) / max(float(np.nanmedian(scatter)), TINY))

    def _moment(self, number: int, support: float) -> RealArray:
        """Time at which the pantograph, shifted, passes a support [s]; nan outside the record."""
        record = self._signals.record
        position = record.position[number - 1]
        return np.asarray(np.interp(support + self.shifts, position, record.time, left=np.nan, right=np.nan))


def _scatter(differences: RealArray) -> RealArray:
    """Standard deviation of each column; nan with fewer than three values, which scatter little by chance."""
    valid = np.isfinite(differences)
    count = valid.sum(axis=0)
    mean = np.nansum(differences, axis=0) / np.maximum(count, 1)
    variance = np.nansum((differences - mean) ** 2, axis=0) / np.maximum(count - 1, 1)
    return np.where(count >= 3, np.sqrt(variance), np.nan)


SUPPORT_PASSING = Check(
    name="support passing",
    must_hold=f"within {PASSING_TOLERANCE_M:g} m of each support, the pantograph bends the wire there or coincides "
    "with it",
    purpose="shifted positions hardly change the statistics",
    needs="position, contact force and uplift at supports",
    run=_check_support_passing,
    measures=(KINK_SHIFT, SCATTER),
)


# Heights of the contact wire at rest at the supports, from the data of the line alone.
def rest_heights(case: Case, supports: RealArray) -> RealArray:
    """Height of the contact wire at rest at supports (n,) [m], above the datum of the line.

    An arm that carries its share holds the wire at its height. Below another arm, the wire hangs between the nearest
    droppers: the sag of a string, q a b / 2T, at the distances a and b from them. In an overlap of tension sections it
    is the height of the lowest wire. The irregularity of the contact wire is added. Where the wire hangs in droppers
    with a tolerance of their lengths, its height is unknown: nan.

    Args:
        case: Case of a record.
        supports: Positions of supports, (n,) [m].
    """
    line, layout = case.line, case.line.layout
    sag = STANDARD_GRAVITY * line.contact_wire.mass_kg_m / (2 * line.contact_wire.tension_N)
    rises = [(place, line.section_rise(place)) for place in line.section_places]
    heights = []
    for support, before, after in zip(layout.supports, layout.spans[:-1], layout.spans[1:], strict=True):
        limit = support.limit
        found = [rise for place, rise in rises if place.first < limit.number < place.last]
        if line.steady_arm_at(support).static_share == "level":
            heights.append(min(limit.contact_wire_height + rise(limit.position) for rise in found))
        elif line.variation is not None and line.variation.droppers is not None:
            heights.append(np.nan)
        else:
            heights.append(min(_hanging_height(limit.position, before, after, sag, rise) for rise in found))
    places = np.array([support.limit.position for support in layout.supports])
    rest = np.array(heights)[np.abs(places[:, None] - supports).argmin(axis=0)]
    return np.asarray(rest + line.irregularity_at(supports))


def _hanging_height(position: float, before: SpanLayout, after: SpanLayout, sag: float, rise: SectionRise) -> float:
    """Height of the contact wire of a section between the droppers beside a support [m]; `sag` is q / 2T [1/m]."""
    ends = np.array([before.dropper_position[-1], after.dropper_position[0]])
    a, b = np.abs(ends - position)
    levels = (before.contact_wire_height[-1], after.contact_wire_height[0])
    heights = [level + rise(x) for level, x in zip(levels, ends, strict=True)]
    return float(np.interp(position, ends, heights) - sag * a * b)
