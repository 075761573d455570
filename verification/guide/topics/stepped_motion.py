"""Time steps of a line from a given state, as the closed forms prescribe it."""

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.model import DiscretisedLine, SimulationError
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.motion import build_motion, end_of_step
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.train import build_empty_train


def advance_freely(
    line: DiscretisedLine, time_step: float, steps: int, fields: tuple[RealArray, RealArray], every: int
) -> RealArray:
    """Deflection of the first row in free motion from a given state.

    Args:
        line: Line without lateral field.
        time_step: Time step [s].
        steps: Number of time steps.
        fields: Displacement, velocity and acceleration at the start, each (3, B, S): deflections, and slopes.
        every: Steps between two rows of the result.

    Returns:
        Deflection after every `every` steps, (steps // every, S) [m].
    """
    kernel = build_kernel_arrays(line, time_step)
    train = build_empty_train(1)
    motion = build_motion(kernel.layout, time_step, fields, line.connectors.preload)
    work = build_workspace(kernel, train)
    rows = []
    advance = bind_arrays(step, kernel, motion, train, work)
    for n in range(1, steps + 1):
        if not advance():
            raise SimulationError("the forces of a time step did not converge")
        if n % every == 0:
            rows.append(end_of_step(motion, kernel.layout, time_step)[0][0, 0].copy())
    return np.array(rows)
