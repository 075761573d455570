"""Waves on a long wire: travelling pulses and a moving load against d'Alembert and the exact dispersion relation."""

import numpy as np
import pytest

from helpers.lines import Array, bare_wire
from pantocheck.model.description.pantograph import Pantograph
from pantocheck.model.discretisation.discretised_line import discretise
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.motion import build_motion, end_of_step
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.passage import Passage
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.dynamics.train import build_empty_train
from pantocheck.model.fem import beam
from verification.guide.topics.closed_forms import travelling_pulse

TENSION, MASS = 20e3, 1.35
SPEED_OF_WAVES = beam.wave_speed(TENSION, MASS)


@pytest.mark.parametrize(("bending_stiffness", "distorted"), [(0.0, 0.0), (195.0, 0.005), (2e3, 0.05)])
def test_pulse_follows_the_exact_dispersion_relation(bending_stiffness: float, distorted: float) -> None:
    """A pulse 3 m wide travels 40 m; bending distorts it by more than `distorted`, so that the test notices it.

    Tolerance: average acceleration lags by (w dt)^2 / 12 of the phase w t. A pulse of width b = 3 m contains waves up
    to w = 2 c / b = 80 rad/s; over t = 0.33 s at dt = 0.25 ms this is 9e-4 of these few waves, 3e-4 of the peak.
    """
    length, width, centre, dt = 120.0, 3.0, 40.0, 2.5e-4
    line = discretise(bare_wire(length, TENSION, MASS, bending_stiffness), 0.25)
    kernel = build_kernel_arrays(line, dt)
    steps = round(40.0 / SPEED_OF_WAVES / dt)
    x, wire = line.mesh.position, (TENSION, MASS, bending_stiffness)
    at_start, at_end = travelling_pulse(x, (centre, width), wire, np.array([0.0, steps * dt]))
    motion = build_motion(kernel.layout, dt, (at_start[:, :1], at_start[:, 1:]), np.zeros(0))
    train = build_empty_train(1)
    work = build_workspace(kernel, train)
    advance = bind_arrays(step, kernel, motion, train, work)
    for _ in range(steps):
        assert advance()
    deflection = end_of_step(motion, kernel.layout, dt)[0][0, 0]
    error = np.abs(deflection - at_end[0, 0]).max() / 0.01
    assert error < 3e-4
    string = travelling_pulse(x, (centre, width), (TENSION, MASS, 0.0), np.array([steps * dt]))[0, 0, 0]
    assert np.abs(at_end[0, 0] - string).max() / 0.01 >= distorted


def ramp(t: float | Array) -> Array:
    """Force of the moving load: 100 N after a smooth rise in 40 ms, so that the elements resolve the wave front [N]."""
    return np.asarray(100.0 * np.sin(np.pi / 2 * np.clip(t / 0.04, 0.0, 1.0)) ** 2)


def impulse(t: Array) -> Array:
    """Integral of `ramp` from zero [N s]."""
    rise = np.clip(t, 0.0, 0.04)
    return np.asarray(
        50.0 * rise - 50.0 * 0.04 / np.pi * np.sin(np.pi * rise / 0.04) + 100.0 * np.maximum(t - 0.04, 0.0)
    )


@pytest.mark.parametrize(("share", "tolerance"), [(0.3, 5e-4), (0.57, 5e-4), (0.8, 3e-3)])
def test_moving_load_on_a_long_string_follows_dalembert(share: float, tolerance: float) -> None:
    """Before reflections return, w = I(tau) / 2mc (d'Alembert) with the retarded time tau.

    A load F at speed v < c leaves the slopes F / 2mc(c+v) behind and -F / 2mc(c-v) ahead, hence the kink F / T(1 -
    v^2/c^2). The kernel presses through a spring of 1e-6 N/m compressed by F / k: as the wire is at most 1.2 m from
    height zero, the force has its prescribed value within 2e-6 N. Tolerance: at v = 0.8 c the rise of the force
    covers (c - v) 40 ms = 1 m ahead, four elements; at lower speeds 3 m and more, with an error of a few 1e-4.
    """
    length, origin, dt, duration, soft = 120.0, 45.0, 2.5e-4, 0.3, 1e-6
    speed = share * SPEED_OF_WAVES
    line = discretise(bare_wire(length, TENSION, MASS, 0.0), 0.25)
    heavy = Pantograph(np.array([[1e9]]), np.zeros((1, 1)), np.zeros((1, 1)), np.ones(1), np.zeros(1), 0.0, soft)
    passage = Passage((heavy,), (origin,), speed, duration, dt)
    kernel = build_kernel_arrays(line, dt)
    motion, train = start_motion(line, kernel, passage)
    work = build_workspace(kernel, train)
    steps = round(duration / dt)
    advance = bind_arrays(step, kernel, motion, train, work)
    for n in range(1, steps + 1):
        train.z[:] = 0.0
        train.z[0, 0, 0] = ramp(n * dt) / soft
        assert advance()
        assert train.contact[0, 0] == pytest.approx(float(ramp(n * dt)), rel=0, abs=2e-6)
    t, c, place = steps * dt, SPEED_OF_WAVES, line.mesh.position - origin
    retarded = np.where(place < speed * t, (c * t + place) / (c + speed), (c * t - place) / (c - speed))
    exact = impulse(np.clip(retarded, 0.0, None)) / (2 * MASS * c)
    deflection = end_of_step(motion, kernel.layout, dt)[0][0, 0]
    error = np.abs(deflection - exact)
    assert error.max() < tolerance * exact.max()
    near = (np.abs(place - speed * t) > 2.0) & (np.abs(place - speed * t) < 6.0)
    ahead, behind = near & (place > speed * t), near & (place < speed * t)
    slope = [np.polyfit(place[side], deflection[side], 1)[0] for side in (behind, ahead)]
    assert slope[0] - slope[1] == pytest.approx(100.0 / (TENSION * (1 - share**2)), rel=1e-3)
