"""Contact height and uplift at the supports: while there is contact, the contact point lies on the wire.

When a pantograph passes a support, the contact height z, the uplift u of this support, the height z0 of the wire there
at rest and the penetration F / k differ by a constant, the datum of the height:

    z - F / k - u - z0  =  constant        (z - u - z0 if z is the height of the wire)

The constant is the same at every support, and for every pantograph of the same kind and uplift force. A channel that is
frozen, of another support or of another passage, and positions that are shifted, scatter. A gain of the uplift shows as
a trend with u. Supports inside an overlap of tension sections are left out: the uplift is that of one wire, and the
head may touch the other one.
"""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.check import (
    COARSEST_STEP_M,
    NAMED_ELSEWHERE,
    TINY,
    Check,
    Finding,
    Measure,
    report_missing,
    rounding_step,
    worst_finding,
)
from pantocheck.conformance.runs.support_passing import rest_heights

DEVIATION = Measure("difference of height less uplift between supports, beside the kink", "mm", {"doubt": 1.0})
"""Largest difference of the constant between supports, beside the kink within one sample.

Simulated records have 0.01 to 0.3 mm; a passage shifted by 10 m has 2 to 9 mm on extreme lines."""

DATUM = Measure("difference of height less uplift between equal pantographs", "mm", {"doubt": 5.0})
"""Largest difference of the constant between equal pantographs; 0.3 mm in simulated records."""

UPLIFT_GAIN = Measure("error of the gain of the uplift, beside three standard errors", "", {"doubt": 0.03})
"""Largest error of the gain of the uplift; 0.02 in simulated records."""

HOLD = Measure("longest constant part of an uplift", "s", {"doubt": 0.15})
"""Longest constant part of an uplift: in whole tenths of a millimetre, a turning point lasts a fifth of it."""

HELD_SPANS = 0.5
"""Distance behind a pantograph within which a wire moves [spans]; a simulation may hold the line farther behind."""


@dataclass(frozen=True)
class _Passages:
    """Passages of the supports by one pantograph in contact."""

    support: RealArray
    """Positions of the supports, (m,) [m]."""
    uplift: RealArray
    """Uplift of the support at its passage, (m,) [m]."""
    wire: RealArray
    """Height of the wire from the contact height, less its height at rest, (m,) [m]."""
    kink: float
    """Largest change of the uplift by the kink within one sample, or within the rounding by a stated filter [m]."""

    @property
    def constant(self) -> RealArray:
        """Height of the wire less the uplift (m,) [m]."""
        return self.wire - self.uplift


def _check_coincidence(case: Case, signals: RecordSignals) -> Finding:
    record = signals.record
    try:
        uplift = signals.delivered_line.uplift
    except QuantityUnavailable:
        return NAMED_ELSEWHERE  # by the support passing
    if record.contact_height is None:
        return NAMED_ELSEWHERE  # by the dynamics
    steps = [rounding_step(row) for row in (*uplift, *record.contact_height)]
    step = max((step for step in steps if np.isfinite(step)), default=0.0)
    if step >= COARSEST_STEP_M:
        text = f"steps of {1e3 * step:.2g} mm are too coarse; deliver both to 0.1 mm"
        return report_missing(f"contact height against uplift: {text}")
    passages = {number: _find_passages(case, signals, number) for number in signals.pantographs}
    rows = zip(signals.delivered_line.supports, uplift, strict=True)
    findings: list[Finding | None] = [_find_hold(case, signals, float(support), row) for support, row in rows]
    findings += [_compare_supports(number, passed) for number, passed in passages.items()]
    findings += [_compare_datums(case, passages), _compare_gain(passages, step)]
    return worst_finding(finding for finding in findings if finding is not None)


def _find_passages(case: Case, signals: RecordSignals, number: int) -> _Passages:
    record, line = signals.record, signals.delivered_line
    assert record.contact_height is not None
    wire = case.line.contact_wire
    position, force = record.position[number - 1], record.force[number - 1]
    height, file = record.contact_height[number - 1], case.pantographs[number - 1]
    rows = []
    for support, uplift in zip(line.supports, line.uplift, strict=True):
        in_overlap = any(start < support < end for start, end in case.line.overlaps)
        known = not in_overlap and np.isfinite(rest_heights(case, np.array([support])))[0]
        if position[0] <= support <= position[-1] and known:
            moment = np.interp(support, position, record.time)
            at_passage = [float(np.interp(moment, record.time, channel)) for channel in (force, height, uplift)]
            rows.append((float(support), *at_passage))
    support, load, z, u = (np.array([row[i] for row in rows]) for i in range(4))
    touching = load > 0
    z = z - rest_heights(case, support)
    candidates = [z - file.penetration(load), z]
    spreads = [np.ptp((candidate - u)[touching]) if touching.any() else 0.0 for candidate in candidates]
    best = candidates[int(np.argmin(spreads))]
    net = abs(wire.number * wire.tension_N - wire.number * wire.mass_kg_m * record.speed**2)
    duration = 1 / min(record.rate, 2 * np.pi * (record.filter_applied_Hz or np.inf))
    kink = float(load.max(initial=0.0)) * record.speed * duration / max(net, TINY) / 4
    return _Passages(support[touching], u[touching], best[touching], kink)


def _find_hold(case: Case, signals: RecordSignals, support: float, uplift: RealArray) -> Finding:
    """Find the longest part of an uplift that is constant after a passage."""
    record = signals.record
    distance = record.position - support
    behind = (distance >= 0) & (distance <= HELD_SPANS * case.line.geometry.shortest_span)
    moving = np.any(behind, axis=0, keepdims=True)[0]
    starts = np.append(0, np.flatnonzero(np.diff(uplift)) + 1)
    held = np.add.reduceat(moving.astype(np.int64), starts) / record.rate
    longest = int(held.argmax())
    text = f"the uplift at {support:g} m stays at {1e3 * uplift[starts[longest]]:.3g} mm for {held[longest]:.2g} s"
    return HOLD.compare(
        float(held[longest]), f"support at {support:g} m", f"{text} while a pantograph moves away from it"
    )


def _compare_supports(number: int, passages: _Passages) -> Finding | None:
    """Compare the constant of the supports that one pantograph passes."""
    if passages.support.size < 2:
        return None
    deviation = passages.constant - np.median(passages.constant)
    worst = int(np.abs(deviation).argmax())
    return DEVIATION.compare(
        1e3 * float(np.ptp(deviation) - passages.kink),
        f"pantograph {number}",
        f"pantograph {number} passes the supports at heights that differ by {1e3 * np.ptp(deviation):.2g} mm from the "
        f"uplift there, most at {passages.support[worst]:g} m: position, contact height and uplift do not belong "
        "together",
    )


def _compare_datums(case: Case, passages: dict[int, _Passages]) -> Finding:
    """Compare the constants of pantographs of the same kind and uplift force."""
    parts = zip(case.pantographs, case.lift_forces, strict=True)
    kinds, findings = [(file, lift.stated_uplift_force) for file, lift in parts], []
    for number, passed in passages.items():
        for other in range(1, number):
            if not (passed.support.size and passages[other].support.size):
                continue
            if kinds[number - 1] == kinds[other - 1]:
                difference = 1e3 * abs(float(np.median(passed.constant) - np.median(passages[other].constant)))
                text = (
                    f"at the supports, the contact heights of the equal pantographs {other} and {number} differ by "
                    f"{difference:.2g} mm from the uplift: position, contact height and uplift do not belong together"
                )
                findings.append(DATUM.compare(difference, f"pantographs {other} and {number}", text))
    return worst_finding(findings)


def _compare_gain(passages: dict[int, _Passages], step: float) -> Finding | None:
    """Compare the changes of the uplift between passages with those of the contact height."""
    several = [passed for passed in passages.values() if passed.support.size > 1]
    freedom = sum(passed.support.size - 1 for passed in several) - 1
    if freedom < 1:
        return None
    uplift = np.concatenate([passed.uplift - passed.uplift.mean() for passed in several])
    wire = np.concatenate([passed.wire - passed.wire.mean() for passed in several])
    if np.ptp(uplift) <= max(passed.kink for passed in several):
        return None  # equal passages do not determine a gain
    squares = max(float(uplift @ uplift), TINY)
    gain = float(wire @ uplift) / squares
    scatter = np.sqrt(float(((wire - gain * uplift) ** 2).sum()) / freedom)
    rounding = step / np.sqrt(6)  # of uplift and height
    error = np.hypot(scatter, rounding) / np.sqrt(squares)
    text = (
        f"between the supports, the contact height changes by {gain:.3g} times the uplift; check gain and unit of the "
        "uplift"
    )
    return UPLIFT_GAIN.compare(abs(gain - 1) - 3 * float(error), text=text)


COINCIDENCE = Check(
    name="coincidence",
    must_hold="in contact, contact height and uplift at the passage of each support agree up to one constant",
    purpose="an uplift that is frozen, scaled, of another support or of another run still shows a kink somewhere",
    needs="position, contact force, contact height and uplift at supports, to 0.1 mm",
    run=_check_coincidence,
    measures=(HOLD, DEVIATION, DATUM, UPLIFT_GAIN),
    causes=("not possible", "named by another check"),
)
