"""Topic: contact forces of two pantographs at constant speed on a long string."""

from dataclasses import replace

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, Series
from pantocheck.model import Pantograph, Passage, build_chain, discretise, simulate_passage
from pantocheck.model.description.pantograph import equilibrium
from pantocheck.model.fem.beam import wave_speed
from verification.guide.comparisons import build_study, compare_absolute, relative_rms
from verification.guide.guide_format import CheckedValue, Topic
from verification.guide.topics.bare_wires import WIRE_MASS, WIRE_TENSION, build_wire

_LENGTH, _PLACES, _DURATION, _RAMP = 400.0, (150.0, 120.0), 1.5, 0.3
"""Length of the string, places of the heads at the start [m], simulated time and ramp of the force [s]: no wave
returns from an anchor before the end."""

SHARES = (0.3, 0.6)
"""Speeds as shares of the wave speed."""

_TOLERANCE = 3e-3
_REASON = "The kink of a string without bending moves within elements of 0.5 m; measured error and half of it."

_MEAN_S = 0.01
"""Interval of the mean that leaves frequencies up to 50 Hz [s]."""

DISCRETISATIONS = ((1.0, 2e-3), (0.5, 1e-3), (0.25, 5e-4))
"""Element lengths [m] and time steps [s]; the second one is the default."""

_FINE_STEP = 1e-4
"""Time step of the delay equations [s]: the error of the method of Runge and Kutta is below 1e-8 of the force."""

_HEAD = build_chain(np.array([15.0, 7.2]), np.array([50.0, 4200.0]), np.array([90.0, 10.0]), 120.0, 0, 50e3)
"""Pantograph of the EN 50318:2002 reference model."""

CONSTRAINED = replace(_HEAD, contact_stiffness=np.inf)
"""The same pantograph with a constraint in place of the contact spring."""


def study_long_string() -> Topic:
    """Contact forces of two pantographs at two speeds."""
    comparisons: list[CheckedValue] = []
    charts = []
    for share in SHARES:
        speed = share * wave_speed(WIRE_TENSION, WIRE_MASS)
        times, computed = simulate_heads(speed, *DISCRETISATIONS[1])
        exact = solve_delay_equations(speed, times)
        comparisons += [
            compare_absolute(
                f"speed-{share:g}-pantograph-{p}",
                f"RMS error of the contact force of pantograph {p} at {share:g} of the wave speed, mean over 10 ms",
                "-",
                (relative_rms(average_force(times, computed[p - 1]), average_force(times, exact[p - 1])), 0.0),
                _TOLERANCE,
                _REASON,
            )
            for p in (1, 2)
        ]
        charts.append(_draw(share, times, computed, exact))
    return Topic(
        title="Two pantographs at constant speed on a long string",
        theory="Before waves return from the anchors, a force F at a point of a string that moves with v < c lifts "
        "this point at the rate F / 2mc for every speed (d'Alembert). It lifts the point a distance d behind it after "
        "the time d / (c + v), and the point d ahead of it after d / (c - v). Two pantographs on a string are "
        "therefore ordinary equations with delays.",
        setting=f"String of {_LENGTH:g} m, heads {_PLACES[0] - _PLACES[1]:g} m apart, elements of 0.5 m, 1 ms; "
        f"the force rises in {_RAMP:g} s.",
        comparisons=comparisons,
        convergence=[
            build_study(
                "force",
                f"contact force of pantograph 1 at {SHARES[1]:g} of the wave speed (RMS)",
                "element length [m]",
                [(element, _force_error(element, time_step)) for element, time_step in DISCRETISATIONS],
                (1.0, 0.15),
                "A cubic element cannot represent a kink that moves through it: order 1 without a low-pass filter.",
            )
        ],
        charts=charts,
    )


def _force_error(element: float, time_step: float) -> float:
    speed = SHARES[1] * wave_speed(WIRE_TENSION, WIRE_MASS)
    times, computed = simulate_heads(speed, element, time_step)
    return relative_rms(computed[0], solve_delay_equations(speed, times)[0])


def average_force(times: RealArray, force: RealArray) -> RealArray:
    """Mean over `_MEAN_S`."""
    samples = round(_MEAN_S / (times[1] - times[0]))
    return np.convolve(force, np.full(samples, 1 / samples), "valid")


def simulate_heads(
    speed: float, element: float, time_step: float, head: Pantograph = _HEAD
) -> tuple[RealArray, RealArray]:
    """Contact forces of both heads on the reference simulator.

    Args:
        speed, element, time_step: Speed [m/s], element length [m] and time step [s].
        head: Both pantographs.

    Returns:
        Times [s] and contact forces [N], (T,) and (2, T).
    """
    line = discretise(build_wire(_LENGTH, bending_stiffness=0.0), element)
    level = replace(line, state=replace(line.state, deflection=np.zeros_like(line.state.deflection)))
    history = simulate_passage(level, Passage((head, head), _PLACES, speed, _DURATION, time_step, ramp=_RAMP))
    return history.time, history.force


def solve_delay_equations(speed: float, times: RealArray, head: Pantograph = _HEAD) -> RealArray:
    """Contact forces of both heads on an infinite string (2, T) [N].

    A constraint gives the string the velocity u of the head: F = 2mc u minus the force of the other head that arrives.

    Args:
        speed: Speed of the heads [m/s].
        times: Times, (T,) [s].
        head: Both pantographs.
    """
    c = wave_speed(WIRE_TENSION, WIRE_MASS)
    distance = _PLACES[0] - _PLACES[1]
    delays = (distance / (c - speed), distance / (c + speed))
    rest, (held,) = equilibrium(head, 0.0)
    inverse, n, impedance = np.linalg.inv(head.mass), rest.size, 2 * WIRE_MASS * c
    # Unknowns of a head: displacements, velocities, height of the string at the contact.
    state = np.tile(np.concatenate([rest, np.zeros(n + 1)]), (2, 1))
    steps = round(times[-1] / _FINE_STEP)
    grid, force = _FINE_STEP * np.arange(steps + 1), np.zeros((2, steps + 1))

    def contact(t: float, heads: RealArray, known: int) -> tuple[RealArray, RealArray]:
        pairs = zip(delays, force[::-1], strict=True)
        earlier = np.array([np.interp(t - delay, grid[:known], other[:known], left=0.0) for delay, other in pairs])
        own = head.contact_stiffness * (heads[:, :n] @ head.head - heads[:, -1])
        if np.isinf(head.contact_stiffness):
            own = impedance * (heads[:, n : 2 * n] @ head.head) - earlier
        return np.maximum(0.0, own), earlier

    def rate(t: float, heads: RealArray, known: int) -> RealArray:
        holding = (1 + np.cos(np.pi * min(t / _RAMP, 1.0))) / 2 * held
        own, earlier = contact(t, heads, known)
        z, u = heads[:, :n], heads[:, n : 2 * n]
        load = head.force - np.outer(own + holding, head.head) - u @ head.damping - z @ head.stiffness
        return np.hstack([u, load @ inverse, ((own + earlier) / impedance)[:, None]])

    for k in range(steps):
        t, h = grid[k], _FINE_STEP
        first = rate(t, state, k + 1)
        second = rate(t + h / 2, state + h / 2 * first, k + 1)
        third = rate(t + h / 2, state + h / 2 * second, k + 1)
        fourth = rate(t + h, state + h * third, k + 1)
        state = state + h / 6 * (first + 2 * second + 2 * third + fourth)
        force[:, k + 1] = contact(t + h, state, k + 1)[0]
    return np.array([np.interp(times, grid, row) for row in force])


def _draw(share: float, times: RealArray, computed: RealArray, exact: RealArray) -> Chart:
    series = []
    for p in (0, 1):
        name = f"pantograph {p + 1}"
        series.append(Series(label=f"{name}, exact", style="line", x=times[::5].tolist(), y=exact[p, ::5].tolist()))
    for p in (0, 1):
        name = f"pantograph {p + 1}"
        points = slice(None, None, 40)
        series.append(Series(label=name, style="points", x=times[points].tolist(), y=computed[p, points].tolist()))
    return Chart(
        caption=f"Contact forces of two pantographs on a long string at {share:g} of the wave speed.",
        alternative="The computed points of both pantographs lie on the exact curves; the curve of the second "
        "pantograph bends when the waves of the first reach it.",
        x_label="time [s]",
        y_label="contact force [N]",
        series=series,
    )
