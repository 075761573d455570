"""Topic: constant force that moves along a wire."""

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, Series
from pantocheck.model import Pantograph, Passage, SimulationError, discretise
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.motion import end_of_step
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.fem import beam
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.fem.residual_flexibility import residual_flexibility
from verification.guide.comparisons import compare_absolute, relative_rms
from verification.guide.guide_format import Topic
from verification.guide.topics.bare_wires import WIRE_BENDING, WIRE_MASS, WIRE_TENSION, build_wire
from verification.guide.topics.closed_forms import moving_load_deflection

_LENGTH, _FORCE, _TIME_STEP = 100.0, 100.0, 1e-3
_SOFT = 1e-6
"""Contact stiffness of the prescribed force [N/m]: compressed by 1e8 m, it changes by less than 1e-6 N."""

_SHARES = {0.3: 2.5e-4, 0.7: 4e-4, 0.9: 9e-4}
"""Speed as a share of the wave speed, and tolerance: measured error plus a quarter."""


def study_moving_load() -> Topic:
    """Deflection under a constant force at three speeds."""
    speed_of_waves = beam.wave_speed(WIRE_TENSION, WIRE_MASS)
    curves = {share: simulate_moving_load(share * speed_of_waves) for share in _SHARES}
    exact = {
        share: _FORCE
        * moving_load_deflection(times, share * speed_of_waves, (_LENGTH, WIRE_TENSION, WIRE_MASS, WIRE_BENDING))
        for share, (times, _) in curves.items()
    }
    return Topic(
        title="Constant force that moves along a wire",
        theory="The deflection under a force that enters a pinned beam at one end is a sum over its modes (Fryba, "
        "Vibration of solids and structures under moving loads, chapter 1).",
        setting=f"Contact wire of {_LENGTH:g} m, elements of 0.5 m, 1 ms: the default discretisation; {_FORCE:g} N.",
        comparisons=[
            compare_absolute(
                f"speed-{share:g}",
                f"RMS error of the deflection at {share:g} of the wave speed, relative",
                "-",
                (relative_rms(deflection, exact[share]), 0.0),
                _SHARES[share],
                "Measured error plus a quarter: waves shorter than four elements.",
            )
            for share, (_, deflection) in curves.items()
        ],
        charts=[_draw(0.7, curves[0.7], exact[0.7])],
    )


def simulate_moving_load(speed: float) -> tuple[RealArray, RealArray]:
    """Times [s] and deflections [m] under a constant force that moves at a speed [m/s] over 95 % of the wire."""
    line = discretise(build_wire(_LENGTH), 0.5)
    heavy = Pantograph(np.array([[1e9]]), np.zeros((1, 1)), np.zeros((1, 1)), np.ones(1), np.zeros(1), 0.0, _SOFT)
    steps = int(0.95 * _LENGTH / speed / _TIME_STEP)
    kernel = build_kernel_arrays(line, _TIME_STEP)
    motion, train = start_motion(line, kernel, Passage((heavy,), (0.0,), speed, steps * _TIME_STEP, _TIME_STEP))
    work = build_workspace(kernel, train)
    deflection = np.empty(steps)
    advance = bind_arrays(step, kernel, motion, train, work)
    for n in range(steps):
        train.z[:] = 0.0
        train.z[0, 0, 0] = _FORCE / _SOFT
        if not advance():
            raise SimulationError("the forces of a time step did not converge")
        element, length, s = find_element(line.mesh.position, speed * (n + 1) * _TIME_STEP)
        w, r = end_of_step(motion, kernel.layout, _TIME_STEP)
        ends = np.stack([w[0, 0, element : element + 2], r[0, 0, element : element + 2]], axis=1)
        residual = residual_flexibility(line.beams.flexibility[0, element], s)
        deflection[n] = beam.shape(s, length) @ ends.ravel() + _FORCE * residual
    times: RealArray = _TIME_STEP * np.arange(1, steps + 1).astype(np.float64)
    return times, deflection


def _draw(share: float, curve: tuple[RealArray, RealArray], exact: RealArray) -> Chart:
    x = curve[0] * share * beam.wave_speed(WIRE_TENSION, WIRE_MASS)
    every = max(1, x.size // 40)
    return Chart(
        caption=f"Deflection under a force of {_FORCE:g} N at {share:g} of the wave speed.",
        alternative="The computed points lie on the sum over the modes along the whole wire.",
        x_label="position of the force [m]",
        y_label="deflection [mm]",
        series=[
            Series(label="modes", style="line", x=x.tolist(), y=(1e3 * exact).tolist()),
            Series(label="computed", style="points", x=x[::every].tolist(), y=(1e3 * curve[1][::every]).tolist()),
        ],
    )
