"""Topic: waves on a long wire, their speed and dispersion."""

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, Series
from pantocheck.model import DiscretisedLine, discretise
from pantocheck.model.fem.beam import wave_speed
from verification.guide.comparisons import compare_relative
from verification.guide.guide_format import Topic
from verification.guide.topics.bare_wires import WIRE_MASS, WIRE_TENSION, build_wire
from verification.guide.topics.closed_forms import travelling_pulse
from verification.guide.topics.stepped_motion import advance_freely

_LENGTH, _CENTRE, _DISTANCE = 120.0, 40.0, 40.0
"""Length of the wire, start of the pulse and its path [m]."""

_WIDTH, _TIME_STEP = 3.0, 2.5e-4
"""Standard deviation of the pulse [m] and time step [s]."""

_STIFF = 2e3
"""Bending stiffness at which dispersion is visible [N m2]."""


def study_waves() -> Topic:
    """Speed of a pulse on a string, and dispersion of a pulse on a beam."""
    speed = wave_speed(WIRE_TENSION, WIRE_MASS)
    line, end, computed = _send_pulse(0.0)
    travelled = (_centre(line, computed) - _CENTRE) / (round(_DISTANCE / speed / _TIME_STEP) * _TIME_STEP)
    stiff, stiff_end, stiff_computed = _send_pulse(_STIFF)
    reason = "Largest waves of the pulse: 80 rad/s over 0.33 s at 0.25 ms; a few 1e-4 of them are late."
    return Topic(
        title="Waves on a wire",
        theory="A pulse on a string travels with c = √(T/m) without changing its shape (d'Alembert). With "
        "bending, each wave number k travels with its own speed: ω² = (T k² + EI k⁴) / m.",
        setting=f"Wire of {_LENGTH:g} m; a pulse with a standard deviation of 3 m travels {_DISTANCE:g} m; elements of "
        "0.25 m, 0.25 ms.",
        comparisons=[
            compare_relative("speed", "speed of a pulse on a string", "m/s", (travelled, speed), 3e-4, reason),
            compare_relative(
                "dispersion",
                f"height of the pulse after {_DISTANCE:g} m, EI = {_STIFF:g} N m²",
                "mm",
                (1e3 * stiff_computed.max(), 1e3 * stiff_end.max()),
                3e-4,
                reason,
            ),
        ],
        charts=[_draw_pulses(stiff, stiff_end, stiff_computed, end)],
    )


def _send_pulse(bending: float) -> tuple[DiscretisedLine, RealArray, RealArray]:
    """Line, and exact and computed deflection at the end of the path [m]."""
    line = discretise(build_wire(_LENGTH, bending_stiffness=bending), 0.25)
    steps = round(_DISTANCE / wave_speed(WIRE_TENSION, WIRE_MASS) / _TIME_STEP)
    times = np.array([0.0, steps * _TIME_STEP])
    start, end = travelling_pulse(line.mesh.position, (_CENTRE, _WIDTH), (WIRE_TENSION, WIRE_MASS, bending), times)
    return line, end[0, 0], advance_freely(line, _TIME_STEP, steps, (start[:, :1], start[:, 1:]), steps)[-1]


def _centre(line: DiscretisedLine, deflection: RealArray) -> float:
    """Centroid of a pulse [m]."""
    return float(np.sum(line.mesh.position * deflection) / np.sum(deflection))


def _draw_pulses(line: DiscretisedLine, exact: RealArray, computed: RealArray, string: RealArray) -> Chart:
    x = line.mesh.position
    near = np.flatnonzero((x > _CENTRE + _DISTANCE - 20) & (x < _CENTRE + _DISTANCE + 20))
    return Chart(
        caption=f"Pulse after {_DISTANCE:g} m on a wire with a bending stiffness of {_STIFF:g} N m².",
        alternative="The computed points lie on the exact pulse, which is lower and wider than the pulse on a string.",
        x_label="position [m]",
        y_label="deflection [mm]",
        series=[
            Series(label="exact", style="line", x=x[near].tolist(), y=(1e3 * exact[near]).tolist()),
            Series(label="string", style="line", x=x[near].tolist(), y=(1e3 * string[near]).tolist()),
            Series(label="computed", style="points", x=x[near][::4].tolist(), y=(1e3 * computed[near][::4]).tolist()),
        ],
    )
