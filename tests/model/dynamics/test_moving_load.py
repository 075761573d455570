"""Deflection under a constant force that moves along a tensioned beam, against its modes."""

import numpy as np
import pytest

from helpers.lines import Array, bare_wire
from pantocheck.model.discretised_line import discretise
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.motion import end_of_step
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.passage import Passage
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.fem import beam
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.fem.residual_flexibility import residual_flexibility
from pantocheck.model.pantograph import Pantograph

TENSION, BENDING_STIFFNESS, MASS, LENGTH, FORCE = 22e3, 195.0, 1.35, 100.0, 100.0
SPEED_OF_WAVES = beam.wave_speed(TENSION, MASS)


def modal_deflection(times: Array, speed: float, modes: int = 4000) -> Array:
    """Deflection of a pinned beam under the force, which enters at one end at t = 0 (Fryba, chapter 1)."""
    k = np.arange(1, modes + 1) * np.pi / LENGTH
    natural, driving = np.sqrt((TENSION * k**2 + BENDING_STIFFNESS * k**4) / MASS), k * speed
    amplitude = 2 * FORCE / (MASS * LENGTH) / (natural**2 - driving**2)
    return np.array(
        [
            np.sum(amplitude * (np.sin(driving * t) - driving / natural * np.sin(natural * t)) * np.sin(driving * t))
            for t in times
        ]
    )


@pytest.mark.parametrize(("share", "tolerance"), [(0.3, 2.5e-4), (0.7, 4e-4), (0.9, 9e-4)])
def test_deflection_under_a_moving_load_agrees_with_modes(share: float, tolerance: float) -> None:
    """Default mesh and time step; root mean square of the error over that of the deflection, plus a quarter.

    The speed is a share of the wave speed. The error is that of waves shorter than four elements.

    The force is that of a spring of 1e-6 N/m, compressed by 1e8 m: its changes are below 1e-7 of it.
    """
    dt, soft, speed = 1e-3, 1e-6, share * SPEED_OF_WAVES
    line = discretise(bare_wire(LENGTH, TENSION, MASS, BENDING_STIFFNESS), 0.5)
    heavy = Pantograph(np.array([[1e9]]), np.zeros((1, 1)), np.zeros((1, 1)), np.ones(1), np.zeros(1), 0.0, soft)
    steps = int(0.95 * LENGTH / speed / dt)
    kernel = build_kernel_arrays(line, dt)
    motion, train = start_motion(line, kernel, Passage((heavy,), (0.0,), speed, steps * dt, dt))
    work = build_workspace(kernel, train)
    deflection = np.empty(steps)
    for n in range(steps):
        train.z[:] = 0.0
        train.z[0, 0, 0] = FORCE / soft
        assert step(kernel, motion, train, work)
        element, length, s = find_element(line.mesh.position, speed * (n + 1) * dt)
        w, r = end_of_step(motion, kernel.layout, dt)
        ends = np.stack([w[0, 0, element : element + 2], r[0, 0, element : element + 2]], axis=1)
        of_elements = beam.shape(s, length) @ ends.ravel()
        deflection[n] = of_elements + FORCE * residual_flexibility(line.beams.flexibility[0, element], s)
    exact = modal_deflection(dt * np.arange(1, steps + 1), speed)
    assert np.sqrt(np.mean((deflection - exact) ** 2) / np.mean(exact**2)) < tolerance
