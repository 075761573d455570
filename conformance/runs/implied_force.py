"""Contact force that follows from the contact height, against the graded contact force.

The contact height moves mainly below 5 Hz. A force that lost its content near the cut-off explains this motion almost
as well as the true one. The dynamic stiffness D of the pantograph grows with the square of the frequency: the
difference between the recorded motion and the response to the force, times D, is the error of the force in newtons,

    F_implied - F  =  -D (z - z_response),        D = 1 / (H + c),

with the receptance H of the head and c = 0 for the height of the head, c = 1 / k for that of the wire (contact
stiffness k). It compares with the graded force itself, at every instant. A constant gain and lag of the force are
removed first: the check of the dynamics limits them.
"""

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import head_receptance
from pantocheck.conformance.quantities.bands import EXTENDED_BAND
from pantocheck.conformance.quantities.filters import Filter, is_observable
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
from pantocheck.conformance.runs.force_dynamics import (
    SAMPLES_PER_PERIOD,
    find_responses,
    find_unknown_motion,
    follows_wire,
    remove_free_motion,
)
from pantocheck.model.description.cubic_spline import evaluate_polynomials, fit_polynomials

FORCE_ERROR = Measure("largest error of the force up to the cut-off", "", {"doubt": 0.15})
"""Largest error of the force, over its standard deviation.

Simulated records have 0.03 or less at a time step of 2 ms; heights rounded to 0.1 mm have 0.1. A second pass of the
filter of 20 Hz gives 0.2 to 0.3 where the force has content at 20 Hz."""

EXTENDED_FORCE_ERROR = Measure("largest error of the force up to 50 Hz", "", {"doubt": 0.3})
"""The same up to 50 Hz; integration at 2 ms gives errors of 7 %, simulated records 0.09 at most."""

ROLLING_FORCE_ERROR = Measure("largest error of the force, lateral place of the wire at rest", "", {"doubt": 0.3})
"""The same in both bands where a strip rolls or bends with the place of the wire: its vibrations give up to 0.2."""

LARGEST_LAG_S = 0.005
"""Largest lag of the force that is removed [s]: one sample of a slow record."""

LAG_ITERATIONS = 3
"""Newton iterations of the lag; the force is not a straight line over a lag of 5 ms."""

MARGIN_PERIODS = 4
"""Periods of the cut-off that are compared before and after the analysis section; half of them are tapered."""

EXTENDED_QUANTITIES = frozenset({"std_force_50_N", "cov_50", EXTENDED_BAND.quantity})
"""Quantities with content above the cut-off of the case."""


def _check_implied_force(case: Case, signals: RecordSignals) -> Finding:
    record, low_pass = signals.record, case.file.filter
    if record.contact_height is None:
        return NAMED_ELSEWHERE  # by the dynamics
    bands = [(low_pass, FORCE_ERROR)]
    if not EXTENDED_QUANTITIES.isdisjoint(limit.quantity for limit in case.limits):
        bands.append((low_pass.change_cutoff(float(EXTENDED_BAND.high)), EXTENDED_FORCE_ERROR))
    findings = []
    for band, measure in bands:
        if not is_observable(band.cutoff_Hz, record.rate):
            continue  # its quantities are not available either
        for number in range(1, len(case.pantographs) + 1):
            if find_unknown_motion(case, signals, number) is not None:
                return NAMED_ELSEWHERE  # by the dynamics
            error = force_error(case, signals, number, band)
            chosen = ROLLING_FORCE_ERROR if follows_wire(case, number) else measure
            findings.append(_judge(number, chosen, error, band, record.contact_height[number - 1]))
    return worst_finding(findings)


def force_error(case: Case, signals: RecordSignals, number: int, low_pass: Filter) -> float:
    """Largest error of the filtered force over the analysis section, over the standard deviation of the force.

    Args:
        case: Case of the record.
        signals: Signals of a record with contact height.
        number: Number of the pantograph from 1.
        low_pass: Filter of the force.
    """
    file, record = case.pantographs[number - 1], signals.record
    assert record.contact_height is not None
    height, (start, end) = record.contact_height[number - 1], record.evaluated
    step, margin = 1 / (SAMPLES_PER_PERIOD * low_pass.cutoff_Hz), MARGIN_PERIODS / low_pass.cutoff_Hz
    entry, exit_ = np.interp([start, end], record.position[number - 1], record.time)
    time = np.arange(max(record.time[0], entry - margin), min(record.time[-1], exit_ + margin), step)
    taper = round(margin / 2 / step)
    inside = (time >= entry) & (time < exit_)
    inside[:taper] = inside[-taper:] = False

    def smooth(channel: RealArray) -> RealArray:
        filtered = low_pass(channel, record.rate)
        return evaluate_polynomials(record.time, fit_polynomials(record.time, filtered, "not a knot"), time)

    heights = [height]
    heights += [applied(height, record.rate) for applied in _stated_filters(low_pass, record.filter_applied_Hz)]
    force = smooth(record.force[number - 1])
    _, (response, free) = find_responses(case, signals, number, smooth, step)
    spread = max(float(force[inside].std()), TINY)
    errors = []
    for candidate in heights:
        motion = smooth(candidate)
        for compliance in (0.0, file.compliance(float(force.mean()))):
            difference = remove_free_motion(motion - response + compliance * (force - force.mean()), free)
            difference *= _taper_ends(force.size, min(taper, force.size / 2))
            error = _multiply_by_dynamic_stiffness(file, difference, step, compliance)
            errors.append(_largest_remainder(error, force, inside, step) / spread)
    return min(errors)


def _stated_filters(low_pass: Filter, applied_Hz: float | None) -> list[Filter]:
    """Filters that the force may have passed, but not the height; none if it was delivered unfiltered."""
    if applied_Hz is None:
        return []
    zero_or_case = low_pass.change_cutoff(applied_Hz)
    return [zero_or_case, zero_or_case.model_copy(update={"phase": "causal"})]


def _multiply_by_dynamic_stiffness(
    file: PantographFile, difference: RealArray, step: float, compliance: float
) -> RealArray:
    """Force that causes a difference of the motion [N]; its mean is not determined."""
    omega = 2 * np.pi * np.asarray(np.fft.rfftfreq(difference.size, step)[1:], dtype=np.float64)
    spectrum = np.fft.rfft(difference)
    spectrum[0] = 0.0
    spectrum[1:] /= -(head_receptance(file, omega) + compliance)
    return np.asarray(np.fft.irfft(spectrum, difference.size))


def _largest_remainder(error: RealArray, force: RealArray, inside: NDArray[np.bool_], step: float) -> float:
    """Largest error inside the analysis section that neither a gain, a constant nor a small lag explains [N]."""
    time = np.arange(force.size, dtype=np.float64) * step
    implied = fit_polynomials(time, force + error, "not a knot")
    known = np.column_stack([np.ones(force.size), force, np.gradient(force, step)])[inside]
    lag, remainder = 0.0, error[inside]
    for _ in range(LAG_ITERATIONS):
        lag += float(np.linalg.lstsq(known, remainder, rcond=None)[0][-1])
        lag = float(np.clip(lag, -LARGEST_LAG_S, LARGEST_LAG_S))
        remainder = evaluate_polynomials(time, implied, time[inside] - lag) - force[inside]
    remainder -= known[:, :2] @ np.linalg.lstsq(known[:, :2], remainder, rcond=None)[0]
    return float(np.abs(remainder).max())


def _taper_ends(size: int, width: float) -> RealArray:
    """Window of n samples: 1, with half a cosine from 0 over a width at both ends."""
    edge, window = width * (size - 1) / size, np.ones(size)
    rise = 0.5 - 0.5 * np.cos(np.pi * np.arange(int(edge) + 1) / edge)
    window[: rise.size], window[-rise.size :] = rise, rise[::-1]
    return window


def _judge(number: int, measure: Measure, error: float, low_pass: Filter, height: RealArray) -> Finding:
    band = f"up to {low_pass.cutoff_Hz:g} Hz"
    finding = measure.compare(
        error,
        f"pantograph {number}",
        f"pantograph {number}: the contact height implies another force {band}: the largest difference is "
        f"{100 * error:.0f} % of the standard deviation, as after a filter that is not stated, or where values were "
        "replaced",
    )
    if finding.kind == "confirmed":
        return finding
    step = rounding_step(height)
    if np.isinf(step):
        text = f"contact height of pantograph {number}: it is constant, so that it cannot confirm the force {band}"
        return report_missing(f"{text}; deliver the moving height of the contact point")
    if step >= COARSEST_STEP_M:
        return report_missing(
            f"contact height of pantograph {number}: its steps of {1e3 * step:.2g} mm are too coarse to confirm the "
            f"force {band}; deliver it to 0.1 mm",
        )
    return finding


IMPLIED_FORCE = Check(
    name="implied force",
    must_hold="at every instant, the contact height implies the graded force, up to the cut-off",
    purpose="a filter that is not stated, or a clipped peak, changes the extremes of the force, but hardly the motion",
    needs="contact force and contact height, to 0.1 mm",
    run=_check_implied_force,
    measures=(FORCE_ERROR, EXTENDED_FORCE_ERROR, ROLLING_FORCE_ERROR),
    causes=("not possible", "does not apply", "named by another check"),
)
