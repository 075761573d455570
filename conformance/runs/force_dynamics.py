"""Dynamics check: the pantograph of the case, driven by the recorded force, must move like the contact height.

A chain of masses M z'' + C z' + K z = f - F(t) e_head is linear. The motion of its head is the response to F from rest,
plus the free motion of an initial state, plus a constant. The last two are fitted. The response has no free parameter:
its amplitude and its lag reveal a wrong gain or unit of the force, or a shift in time.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy  # loads scipy.linalg when it is used

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.line.line_shape import find_deflection
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.quantities.filters import is_observable
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
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
from pantocheck.model.description.driven_head import drive_head
from pantocheck.model.description.pantograph import state_space

MISFIT = Measure("misfit of the motion", "", {"contradiction": 0.1})
"""Misfit over the response. Rounding, a filter of one channel or another integration scheme give less than 0.02."""

GAIN_ERROR = Measure("error of the gain of the force", "", {"contradiction": 0.03})
"""Relative error of the gain; correct records stay below 0.005."""

LATE_MISFIT, LATE_GAIN_ERROR = (
    replace(
        measure,
        name=f"{measure.name} behind a causal filter",
        thresholds={"doubt": measure.thresholds["contradiction"]},
        for_filtered=True,
    )
    for measure in (MISFIT, GAIN_ERROR)
)
"""The same where the force is late by no more than a causal filter delays it: a doubt."""

ROLLING_MISFIT, ROLLING_GAIN_ERROR = (
    replace(measure, name=f"{measure.name}, lateral place of the wire at rest", thresholds={"doubt": threshold})
    for measure, threshold in ((MISFIT, 0.1), (GAIN_ERROR, 0.06))
)
"""The same where a strip rolls or bends with the place of the wire: its vibrations across the track give 0.03 each."""

CLEAR = 0.05
"""Unexplained share below which the cause of a misfit is named."""

SMALLEST_MOTION_M = 0.001
"""Smallest RMS of the motion that can be compared [m]; heights are often rounded to a millimetre."""

LONGEST_S, LONGEST_LAG_S = 300.0, 0.5
"""Longest part of a record that is compared, and longest lag that is searched [s]."""

CAUSAL_DELAY_PERIODS = 0.75
"""Largest delay of a causal Butterworth filter of order 6, in periods of its cut-off: 0.62 at low frequencies."""

DRIVEN_RATE_HZ = 1000.0
"""Largest rate at which a head with friction or stops is followed [Hz]."""

SAMPLES_PER_PERIOD = 20
"""Samples per period of the cut-off: straight lines between them follow the force within a percent."""


@dataclass(frozen=True)
class ResponseFit:
    """Fit of the recorded motion by the response to the force."""

    misfit: float
    """RMS of motion minus response, over RMS of the response."""
    gain: float
    """Gain of the force that explains the motion best; 1 for a correct record."""
    unexplained: float
    """Share of the motion that remains with that gain."""
    motion: RealArray
    response: RealArray
    """Compared motions, without their free parts, (n,) [m]."""


def _check_force_dynamics(case: Case, signals: RecordSignals) -> Finding:
    record, low_pass = signals.record, case.file.filter
    if record.contact_height is None:
        return report_not_made("dynamics", "the record has no contact height")
    if not is_observable(low_pass.cutoff_Hz, record.rate):
        return report_low_rate("dynamics", record.rate)
    findings = []
    step = max(1, int(record.rate / (SAMPLES_PER_PERIOD * low_pass.cutoff_Hz)))
    for number, (file, pantograph) in enumerate(zip(case.pantographs, signals.pantographs.values(), strict=True), 1):
        if (reason := find_unknown_motion(case, signals, number)) is not None:
            findings.append(report_not_made("dynamics", reason))
            continue
        window = _compared_samples(pantograph)

        def smooth(channel: RealArray, window: slice = window) -> RealArray:
            return low_pass(channel, record.rate)[window][::step]

        forces, responses = find_responses(case, signals, number, smooth, step / record.rate)
        fit = compare_motion(file, forces, smooth(record.contact_height[number - 1]), responses)
        if fit is None:
            findings.append(report_not_made("dynamics", f"the head of pantograph {number} hardly moves"))
        else:
            rolls = follows_wire(case, number)
            measures = (ROLLING_MISFIT, ROLLING_GAIN_ERROR) if rolls else (MISFIT, GAIN_ERROR)
            confirmed = _compare(number, fit, measures=measures)
            is_wrong = confirmed.kind != "confirmed"
            diagnosis = (number, fit, step / record.rate, record.filter_applied_Hz, measures)
            findings.append(_diagnose(*diagnosis) if is_wrong else confirmed)
    return worst_finding(findings)


def find_unknown_motion(case: Case, signals: RecordSignals, number: int) -> str | None:
    """Reason why a record does not determine the motion of the head of a pantograph; None if it does."""
    file, line = case.pantographs[number - 1], case.line
    if file.fmu is not None and not file.fmu.is_linear:
        return f"the FMU of pantograph {number} is not linear"
    if file.strips > 1 and signals.record.front_strip is None:
        return f"the record has no forces of the strips of pantograph {number}"
    if file.head is not None and any(stop.between is None or "base" in stop.between for stop in file.head.stop):
        return f"the record does not state the height of pantograph {number} above its base, on which a stop acts"
    wires = line.contact_wire.number * len(line.section or (None,))
    if follows_wire(case, number) and (wires > 1 or line.curves):
        return f"the record does not state the place of the wire on pantograph {number}"
    return None


def is_linear(case: Case, number: int) -> bool:
    """Whether the motion of a pantograph is a sum of the responses to its forces, wherever the wire is."""
    file = case.pantographs[number - 1]
    return not (file.has_joints or follows_wire(case, number) or (file.fmu is not None and not file.fmu.is_linear))


def follows_wire(case: Case, number: int) -> bool:
    """Whether strips of a pantograph rise with the lateral position of a wire that leaves the axis."""
    return case.pantographs[number - 1].follows_stagger and case.line.layout.has_stagger


def find_responses(
    case: Case, signals: RecordSignals, number: int, smooth: Callable[[RealArray], RealArray], step: float
) -> tuple[RealArray, tuple[RealArray, RealArray]]:
    """Forces of the strips of a pantograph, and response of its head with its free motions, over compared samples.

    Friction, stops and the place of the wire act on the force as delivered, from the start of the record on.

    Args:
        case: Case of the record.
        signals: Signals of the record.
        number: Number of the pantograph from 1.
        smooth: Compared samples of a channel of the whole record.
        step: Time between them [s].
    """
    file, record = case.pantographs[number - 1], signals.record
    forces = list_strip_forces(file, signals, number)
    smoothed = np.array([smooth(force) for force in forces])
    response, free = head_responses(file, smoothed, step)
    if not is_linear(case, number):
        every = max(1, int(record.rate / DRIVEN_RATE_HZ))
        model = build_pantograph(file, float(np.mean(record.force[number - 1])), 0.0)
        offsets = np.array([[strip.offset] for strip in model.strips])
        place = record.position[number - 1, ::every] + offsets
        lateral = _place_wire(case, place) if follows_wire(case, number) else np.zeros(place.shape)
        driven = drive_head(model, np.array(forces)[:, ::every], lateral, every / record.rate)
        response = smooth(np.interp(record.time, record.time[::every], driven))
    return smoothed, (response, free)


def _place_wire(case: Case, position: RealArray) -> RealArray:
    """Lateral position of the only contact wire at rest [m]; its vibrations across the track are left out."""
    line = discretise_line(case.line, case.file.discretisation.element_m)
    return find_deflection(line, line.catenary.contact_wires[0].name, "y", position)


def list_strip_forces(file: PantographFile, signals: RecordSignals, number: int) -> list[RealArray]:
    """Contact forces of the strips of a pantograph over the whole record, as delivered [N]."""
    record, row = signals.record, number - 1
    if file.strips == 1 or record.front_strip is None or record.rear_strip is None:
        return [record.force[row]]
    return [record.front_strip[row], record.rear_strip[row]]


def compare_motion(
    file: PantographFile, force: RealArray, height: RealArray, responses: tuple[RealArray, RealArray]
) -> ResponseFit | None:
    """Compare a motion with the response of a pantograph.

    Args:
        file: Pantograph of the case.
        force: Contact force of each strip, (strips, n), or of a single one, (n,) [N].
        height: Height of the contact point, (n,) [m].
        responses: Response of the head to the force, and its free motions, as from `head_responses`.

    Returns:
        The fit; None if both the recorded and the computed motion are too small.
    """
    response, free = responses
    response, motion = remove_free_motion(response, free), remove_free_motion(height, free)
    if max(response.std(), motion.std()) < SMALLEST_MOTION_M:
        return None
    # The contact point is the head, or the wire, which the head penetrates by force over contact stiffness.
    head = _fit(motion, response)
    wire = _fit(
        remove_free_motion(height + file.contact.penetration(np.atleast_2d(force)).mean(axis=0), free), response
    )
    return wire if wire.unexplained < head.unexplained / 2 else head


def _fit(motion: RealArray, response: RealArray) -> ResponseFit:
    scale = float(motion @ response / max(float(response @ response), TINY))
    remainder = motion - scale * response
    return ResponseFit(
        misfit=float((motion - response).std() / max(float(response.std()), TINY)),
        gain=1 / scale if scale else np.inf,
        unexplained=float(remainder.std() / max(motion.std(), TINY)),
        motion=motion,
        response=response,
    )


def head_responses(file: PantographFile, force: RealArray, step: float) -> tuple[RealArray, RealArray]:
    """Response of the head to the force from rest, and its (n, k) free motions: a constant and the slow modes.

    Modes faster than the samples do not appear in filtered motions.

    Args:
        file: Pantograph of the case.
        force: Contact force of each strip, (strips, n), or of a single one, (n,) [N].
        step: Time between samples [s].
    """
    model, force = build_pantograph(file, 0.0, 0.0), np.atleast_2d(force)
    state, drives, head = state_space(model)
    time, response = step * np.arange(force.shape[1]), np.zeros(force.shape[1])
    for drive, part in zip(-drives.T, force, strict=True):
        response += _simulate(state, drive, part - part.mean(), step) @ head
    poles = np.linalg.eigvals(state)
    slow = poles[(poles.imag >= 0) & (np.abs(poles) < 2 * np.pi / (SAMPLES_PER_PERIOD * step))]
    modes = np.exp(time[:, None] * slow)
    drift = [time] if np.abs(poles).min() < 1e-3 else []  # without a spring to the base
    return response, np.column_stack([np.ones(time.size), *drift, modes.real, modes.imag])


def _simulate(matrix: RealArray, drive: RealArray, force: RealArray, step: float) -> RealArray:
    """States of a linear system from rest, (n, k); the force (n,) [N] is linear between its samples.

    The exponential of the system with force and rate of the force as further states gives the exact step.
    """
    k = drive.size
    extended = np.zeros((k + 2, k + 2))
    extended[:k, :k], extended[:k, k], extended[k, k + 1] = step * matrix, step * drive, 1.0
    exponential = scipy.linalg.expm(extended)
    advance, at_start, ramp = exponential[:k, :k], exponential[:k, k], exponential[:k, k + 1]
    driven = np.outer(force[:-1], at_start) + np.outer(np.diff(force), ramp)
    # The recursion x_(i+1) - A x_i = d_i is a lower triangular system whose band holds two states.
    band = np.zeros((2 * k, driven.size), order="F")
    band[0] = 1.0
    for row, column in np.ndindex(k, k):
        band[k + row - column, column::k] = -advance[row, column]
    states = scipy.linalg.lapack.dtbtrs(band, driven.ravel(), uplo="L", diag="U")[0]
    return np.vstack([np.zeros(k), states.reshape(-1, k)])


def remove_free_motion(signal: RealArray, free: RealArray) -> RealArray:
    """Residual of a signal after a least-squares fit of the free motions."""
    scaled = free / np.maximum(np.abs(free).max(axis=0), TINY)
    return np.asarray(signal - scaled @ np.linalg.lstsq(scaled, signal, rcond=1e-9)[0])


def _compared_samples(pantograph: PantographSignals) -> slice:
    first, last = np.searchsorted(pantograph.position, pantograph.section)
    return slice(int(first), min(int(last), int(first) + int(LONGEST_S * pantograph.force.rate)))


def _compare(
    number: int, fit: ResponseFit, text: str = "", measures: tuple[Measure, Measure] = (MISFIT, GAIN_ERROR)
) -> Finding:
    """Compare misfit and gain of a pantograph with their thresholds."""
    numbers = zip(measures, (fit.misfit, abs(1 / fit.gain - 1)), strict=True)
    return worst_finding(measure.compare(value, f"pantograph {number}", text) for measure, value in numbers)


def _diagnose(
    number: int,
    fit: ResponseFit,
    step: float,
    filter_applied_Hz: float | None,
    measures: tuple[Measure, Measure] = (MISFIT, GAIN_ERROR),
) -> Finding:
    mismatch = f"pantograph {number}: the contact force contradicts the contact height"
    if fit.unexplained < CLEAR:
        cause = f"the height corresponds to {1 / fit.gain:.3g} times the force; check gain and unit of the force"
        return _compare(number, fit, f"{mismatch}: {cause}", measures)
    samples, correlation = _find_lag(fit, round(LONGEST_LAG_S / step))
    delay = -samples * step
    if not samples or not correlation >= 1 - CLEAR:  # the correlation with a constant force is nan
        share = 100 * max(0.0, 1 - fit.unexplained)
        return _compare(number, fit, f"{mismatch}: the force explains only {share:.0f} % of the motion", measures)
    lags = delay > 0
    text = f"{mismatch}: the force {'lags' if lags else 'leads'} the height by about {abs(delay):.1g} s"
    if lags and filter_applied_Hz is not None and delay < CAUSAL_DELAY_PERIODS / filter_applied_Hz:
        return _compare(number, fit, f"{text}, as after a causal filter", (LATE_MISFIT, LATE_GAIN_ERROR))
    return _compare(number, fit, text, measures)


def _find_lag(fit: ResponseFit, longest: int) -> tuple[int, float]:
    """Lag of the motion behind the response [samples], and their correlation at this lag."""
    n = fit.motion.size
    limit = min(longest, n // 3)
    correlation = {}
    for lag in range(-limit, limit + 1):
        motion, response = fit.motion[max(0, lag) : n + min(0, lag)], fit.response[max(0, -lag) : n - max(0, lag)]
        with np.errstate(invalid="ignore"):
            correlation[lag] = float(np.corrcoef(motion, response)[0, 1])
    best = max(correlation, key=lambda lag: correlation[lag])
    return best, correlation[best]


DYNAMICS = Check(
    name="dynamics",
    must_hold="the pantograph of the case, driven by the force, moves like the contact height",
    purpose="a wrong gain, unit, sign or time of the force shows in the motion",
    needs="contact force and contact height",
    run=_check_force_dynamics,
    measures=(MISFIT, GAIN_ERROR, LATE_MISFIT, LATE_GAIN_ERROR, ROLLING_MISFIT, ROLLING_GAIN_ERROR),
)
