"""Topic: time integration of free vibrations, with the element length and alone."""

import numpy as np
from scipy.linalg import eigh

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.model import DiscretisedLine, Kind, Rayleigh, discretise
from pantocheck.model.discretisation.discretised_line import with_damping
from pantocheck.model.fem.beam import wave_speed
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order, correct_mass
from verification.guide.comparisons import build_study, compare_relative, relative_rms
from verification.guide.guide_format import Topic
from verification.guide.topics.bare_wires import WIRE_MASS, WIRE_TENSION, build_short_line, build_wire
from verification.guide.topics.stepped_motion import advance_freely

_LENGTH, _MODE, _DURATION = 60.0, 6, 0.8
"""Length of the string [m], its mode, and the simulated time [s]."""

_TIME_STEPS = (4e-3, 2e-3, 1e-3)
"""Time steps of the convergence studies [s]."""

_ELEMENT_PER_PATH = 3.0
"""Element length over the path of a wave in one step: the mass correction is complete from 2.6 on."""

_LINE_MODES = (2, 6, 11)
"""Indices of the modes of the line with droppers."""

_DAMPING = Rayleigh(0.4, 1e-3)
"""Coefficients of the damped string [1/s, s]."""


def study_time_integration() -> Topic:
    """Free vibration of a string, of a line with taut droppers, and its decay with Rayleigh damping."""
    omega = wave_speed(WIRE_TENSION, WIRE_MASS) * _MODE * np.pi / _LENGTH
    ratio = (_DAMPING.mass_coefficient / omega + _DAMPING.stiffness_coefficient * omega) / 2
    return Topic(
        title="Time integration of free vibrations",
        theory="A string in a mode moves as cos(ωt), a line in its modes as the sum of their cosines. With "
        "Rayleigh damping C = αM + βK, a mode decays with the ratio (α/ω + βω) / 2.",
        setting=f"String of {_LENGTH:g} m in mode {_MODE} ({omega / 2 / np.pi:.2f} Hz); line of two spans with "
        f"droppers in its modes 3, 7 and 12; {_DURATION:g} s.",
        comparisons=[
            compare_relative(
                "damping-ratio",
                "damping ratio from the decay of a string",
                "-",
                (_decay_ratio(omega), ratio),
                2e-3,
                "At 1 ms, (ω Δt)² / 12 is 1e-4 of the frequency; the ratio is read from peaks of a parabola.",
            )
        ],
        convergence=[
            build_study(
                "string",
                "deflection of a string (RMS), element length 3 c Δt",
                "time step [ms]",
                [(1e3 * dt, _string_error(dt, omega)) for dt in _TIME_STEPS],
                (4.0, 0.2),
                "The mass correction turns average acceleration into the method of Fox and Goodwin, of order 4.",
            ),
            build_study(
                "line",
                "deflection of a line with droppers (RMS), elements of 2 m",
                "time step [ms]",
                [(1e3 * dt, _line_error(dt)) for dt in _TIME_STEPS],
                (2.0, 0.15),
                "Bending and droppers are not corrected: average acceleration, of order 2.",
            ),
        ],
    )


def _string_error(time_step: float, omega: float) -> float:
    """Error of a string in a mode, root mean square over the wire and over the last of eight instants."""
    element = _ELEMENT_PER_PATH * wave_speed(WIRE_TENSION, WIRE_MASS) * time_step
    line = discretise(build_wire(_LENGTH, bending_stiffness=0.0), element)
    shape, computed = _vibrate(line, time_step)
    times = _DURATION / 8 * np.arange(1, 9)
    return relative_rms(computed, np.outer(np.cos(omega * times), shape))


def _vibrate(line: DiscretisedLine, time_step: float) -> tuple[RealArray, RealArray]:
    """Mode shape of a string, and its deflection at eight instants after it is released in this shape."""
    x, k = line.mesh.position, _MODE * np.pi / _LENGTH
    deflection, slope = 0.01 * np.sin(k * x), 0.01 * k * np.cos(k * x)
    start = _start_at_rest(line, time_step, np.stack([deflection, slope], axis=-1)[None])
    steps = round(_DURATION / time_step)
    return deflection, advance_freely(line, time_step, steps, start, steps // 8)


def _start_at_rest(line: DiscretisedLine, time_step: float, displacement: RealArray) -> tuple[RealArray, RealArray]:
    """Fields of a line that is released at a displacement (B, S, 2): zero velocity, acceleration -M^-1 K q."""
    matrices = assemble_matrices(line)
    place = bandwidth_order(line)[matrices.free]
    force = -(matrices.stiffness @ displacement.ravel()[place])
    acceleration = np.zeros(displacement.size)
    acceleration[place] = np.linalg.solve(correct_mass(line, time_step).toarray(), force)
    fields = np.stack([displacement, np.zeros_like(displacement), acceleration.reshape(displacement.shape)])
    return fields[..., 0].copy(), fields[..., 1].copy()


def _line_error(time_step: float) -> float:
    """Error of a line with taut droppers in three modes, against their exact cosines."""
    line = discretise(build_short_line(2), 2.0)
    matrices = assemble_matrices(line)
    squares, shapes = eigh(matrices.stiffness.toarray(), matrices.mass.toarray())
    chosen, omega = 1e-4 * shapes[:, _LINE_MODES], np.sqrt(squares[list(_LINE_MODES)])
    place = bandwidth_order(line)[matrices.free]

    def spread(values: RealArray) -> RealArray:
        full = np.zeros(line.beams.free.size)
        full[place] = values
        return full.reshape(line.beams.free.shape)

    start = _start_at_rest(line, time_step, spread(chosen.sum(axis=1)))
    steps = round(_DURATION / time_step)
    computed = advance_freely(line, time_step, steps, start, steps // 8)
    times = _DURATION / 8 * np.arange(1, 9)
    exact = np.array([spread(chosen @ np.cos(omega * t))[0, :, 0] for t in times])
    return relative_rms(computed, exact)


def _decay_ratio(omega: float) -> float:
    """Damping ratio of a string in a mode, from the amplitudes of its first and last full period."""
    line = with_damping(discretise(build_wire(_LENGTH, bending_stiffness=0.0), 0.5), {Kind.CONTACT_WIRE: _DAMPING})
    x, k = line.mesh.position, _MODE * np.pi / _LENGTH
    shape = np.stack([0.01 * np.sin(k * x), 0.01 * k * np.cos(k * x)], axis=-1)[None]
    fields = (*_start_at_rest(line, 1e-3, shape),)
    motion = advance_freely(line, 1e-3, round(_DURATION / 1e-3), fields, 1)
    signal = motion @ np.sin(k * x) / np.sum(np.sin(k * x) ** 2)
    peaks = [n for n in range(1, signal.size - 1) if signal[n - 1] < signal[n] > signal[n + 1]]
    heights = np.array([_parabola_peak(signal[n - 1 : n + 2]) for n in peaks])
    decrement = np.log(heights[0] / heights[-1]) / (len(peaks) - 1)
    return float(decrement / np.sqrt(4 * np.pi**2 + decrement**2))


def _parabola_peak(samples: RealArray) -> float:
    """Largest value of the parabola through three samples."""
    before, middle, after = samples
    return float(middle + (after - before) ** 2 / (8 * (2 * middle - before - after)))
