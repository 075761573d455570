"""Do contact force and contact height belong together? The pantograph of the case, driven by the force, must say so.

A chain of masses M z'' + C z' + K z = f - F(t) e_head is linear: its head moves as the response to F from rest, plus
the free motion of some initial state, plus a constant. The latter two are fitted; the first has nothing left to fit, so
that its amplitude and its lag tell a wrong gain or unit of the force, or a shift in time, from a right one.
"""

from dataclasses import dataclass

import numpy as np
from scipy.signal import lsim

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.consistency.finding import Finding
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE
from pantocheck.conformance.records.record import Record

LARGEST_MISFIT = 0.1
"""Share of the motion that may stay unexplained. Rounding, a filter on one channel, another integration: below 0.02."""
LARGEST_GAIN_ERROR = 0.03
"""Relative; the gain is met within 0.005 by records that are right."""
CLEAR = 0.05
"""Share left unexplained below which the reason of a misfit may be named."""
SMALLEST_MOTION_M = 0.001
"""rms of the motion that the check needs; heights are often rounded to a millimetre [m]."""
LONGEST_S, LONGEST_LAG_S = 30.0, 0.5
CAUSAL_DELAY_PERIODS = 0.75
"""Delay of a causal Butterworth filter of order 6, in periods of its cut-off: 0.62 at low frequencies."""
TINY = float(np.finfo(float).tiny)
SAMPLES_PER_PERIOD = 20
"""At the cut-off: the force is then met by straight lines within a percent."""


@dataclass(frozen=True)
class ResponseFit:
    """How the motion recorded follows from the force.

    Parameters
    ----------
    misfit : float
        Rms of motion minus response, over rms of the response.
    gain : float
        Of the force that explains the motion best, 1 if all is right.
    unexplained : float
        Share of the motion that remains with that gain.
    motion, response : (n,) ndarray
        What is compared [m].
    """

    misfit: float
    gain: float
    unexplained: float
    motion: RealArray
    response: RealArray


def check_force_dynamics(case: Case, record: Record) -> list[Finding]:
    """The pantograph of the case, driven by the force, moves as the contact height says."""
    if record.contact_height is None:
        return [Finding("dynamics", "unchecked", "force against motion: the record has no contact height")]
    cutoff = case.file.filter.cutoff_Hz
    if cutoff > HIGHEST_SHARE_OF_RATE * record.rate:
        return [Finding("dynamics", "unchecked", f"force against motion: a rate of {record.rate:g} Hz is too low")]
    still = False
    for number, file in enumerate(case.pantographs, 1):
        step = max(1, int(record.rate / (SAMPLES_PER_PERIOD * cutoff)))
        window = _window(record, number)
        low_pass = case.file.filter.low_pass
        channels = (record.force, record.contact_height)
        force, height = (low_pass(channel[number - 1], record.rate)[window][::step] for channel in channels)
        fit = fit_motion(file, force, height, step / record.rate)
        still = still or fit is None
        if fit is None:
            continue
        if fit.misfit > LARGEST_MISFIT or abs(1 / fit.gain - 1) > LARGEST_GAIN_ERROR:
            return [_diagnosis(number, fit, step / record.rate, record.filter_applied_Hz)]
    return [Finding("dynamics", "unchecked", "force against motion: the contact point hardly moves")] if still else []


def fit_motion(file: PantographFile, force: RealArray, height: RealArray, step: float) -> ResponseFit | None:
    """Compare a motion with the response of a pantograph.

    Parameters
    ----------
    file : PantographFile
        The pantograph.
    force, height : (n,) ndarray
        Contact force [N] and height of the contact point [m].
    step : float
        Between samples [s].

    Returns
    -------
    ResponseFit or None
        The fit; None if the head hardly moves, and would hardly move.
    """
    response, free = _responses(file, force, step)
    response, motion = _without(response, free), _without(height, free)
    if max(response.std(), motion.std()) < SMALLEST_MOTION_M:
        return None
    # The contact point is the head itself, or the wire, into which the head has sunk by force over contact stiffness.
    head = _fit(motion, response)
    wire = _fit(_without(height + force / file.contact.stiffness_N_m, free), response)
    return wire if wire.unexplained < head.unexplained / 2 else head


def _fit(motion: RealArray, response: RealArray) -> ResponseFit:
    scale = float(motion @ response / max(float(response @ response), TINY))
    left = motion - scale * response
    return ResponseFit(
        misfit=float((motion - response).std() / max(float(response.std()), TINY)),
        gain=1 / scale if scale else np.inf,
        unexplained=float(left.std() / max(motion.std(), TINY)),
        motion=motion,
        response=response,
    )


def _responses(file: PantographFile, force: RealArray, step: float) -> tuple[RealArray, RealArray]:
    """Head's response to the force from rest, and the (n, k) motions that are free: a constant and its modes.

    Modes that decay or swing faster than the samples can follow have no part in filtered motions.
    """
    from pantocheck.conformance.simulation.pantograph_model import build_pantograph

    model = build_pantograph(file, 0.0, 0.0)
    m = model.head.size
    inverse = np.linalg.inv(model.mass)
    state = np.block([[np.zeros((m, m)), np.eye(m)], [-inverse @ model.stiffness, -inverse @ model.damping]])
    drive = np.concatenate([np.zeros(m), -inverse @ model.head])[:, None]
    head = np.concatenate([model.head, np.zeros(m)])[None]
    time = step * np.arange(force.size)
    response = lsim((state, drive, head, np.zeros((1, 1))), force - force.mean(), time)[1]
    poles = np.linalg.eigvals(state)
    slow = poles[(poles.imag >= 0) & (np.abs(poles) < 2 * np.pi / (SAMPLES_PER_PERIOD * step))]
    modes = np.exp(time[:, None] * slow)
    drift = [time] if np.abs(poles).min() < 1e-3 else []  # without a spring to the base
    return np.asarray(response), np.column_stack([np.ones(force.size), *drift, modes.real, modes.imag])


def _without(signal: RealArray, free: RealArray) -> RealArray:
    """A signal without what free motions explain of it."""
    scaled = free / np.maximum(np.abs(free).max(axis=0), TINY)
    return np.asarray(signal - scaled @ np.linalg.lstsq(scaled, signal, rcond=1e-9)[0])


def _window(record: Record, number: int) -> slice:
    first, last = np.searchsorted(record.position[number - 1], record.evaluated)
    return slice(int(first), min(int(last), int(first) + int(LONGEST_S * record.rate)))


def _diagnosis(number: int, fit: ResponseFit, step: float, filter_applied_Hz: float | None) -> Finding:
    said = f"pantograph {number}: contact force and contact height do not belong together"
    if fit.unexplained < CLEAR:
        text = f"{said}: the height follows from {1 / fit.gain:.3g} times the force; is its gain or unit right?"
        return Finding("dynamics", "contradiction", text)
    samples, likeness = _lag(fit, round(LONGEST_LAG_S / step))
    late = -samples * step
    if not samples or not likeness >= 1 - CLEAR:  # also of a force without any change, which is like nothing
        share = 100 * max(0.0, 1 - fit.unexplained)
        return Finding("dynamics", "contradiction", f"{said}: the force explains {share:.0f} % of the motion")
    side = "later" if late > 0 else "earlier"
    text = f"{said}: the force is about {abs(late):.1g} s {side} than the height that follows from it"
    if filter_applied_Hz is not None and 0 < late < CAUSAL_DELAY_PERIODS / filter_applied_Hz:
        return Finding("dynamics", "doubt", f"{text}, as after a filter that runs forwards only")
    return Finding("dynamics", "contradiction", text)


def _lag(fit: ResponseFit, most: int) -> tuple[int, float]:
    """Samples by which the motion comes after the response, and their correlation then."""
    n = fit.motion.size
    likeness = {}
    for lag in range(-min(most, n // 3), min(most, n // 3) + 1):
        motion, response = fit.motion[max(0, lag) : n + min(0, lag)], fit.response[max(0, -lag) : n - max(0, lag)]
        with np.errstate(invalid="ignore"):
            likeness[lag] = float(np.corrcoef(motion, response)[0, 1])
    best = max(likeness, key=lambda lag: likeness[lag])
    return best, likeness[best]
