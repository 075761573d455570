"""Simulation of a mass drop: a mass hangs on a wire, is released, and the line vibrates freely."""

from collections.abc import Callable

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.catenary import GRAVITY, Catenary
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, discretise
from pantocheck.model.dynamics.core_choice import choose_core
from pantocheck.model.dynamics.drop_values import FreeDecay, MassDropSetup
from pantocheck.model.dynamics.kernel_arrays import Load, build_kernel_arrays
from pantocheck.model.dynamics.motion import motion_at_rest
from pantocheck.model.dynamics.passage import Passage
from pantocheck.model.dynamics.recording import FrameRecorder, allocate_recording, simulate_steps
from pantocheck.model.dynamics.reference_kernel import simulate_full_steps
from pantocheck.model.dynamics.train import build_empty_train
from pantocheck.model.statics.assembly import point_load
from pantocheck.model.statics.static_solver import static_solver


def discretise_drop(catenary: Catenary, element_length: float, test: MassDropSetup) -> DiscretisedLine:
    """Line at rest with stations at the mass and at the sensors; parameters and errors as in `simulate_mass_drop`."""
    return discretise(catenary, element_length, (test.position, *(position for _, position in test.sensors)))


def simulate_mass_drop(
    catenary: Catenary, element_length: float, test: MassDropSetup, progress: Callable[[float], None] | None = None
) -> FreeDecay:
    """Simulate a mass drop.

    Args:
        catenary: Line.
        element_length: Largest length of an element [m].
        test: Mass, position, sensors.
        progress: Called from time to time with the completed share, 0 to 1.

    Returns:
        Free decay at the sensors.

    Raises:
        NoInitialState, NoEquilibrium: The line has no equilibrium, without or with the mass.
        DidNotConverge: The forces of a time step did not converge.
    """
    line = discretise_drop(catenary, element_length, test)
    load = Load(line.mesh.row_of[test.wire, "z"], line.mesh.station(test.position))
    weight = -test.mass * GRAVITY
    hanging = static_solver(line).deflection(weight * point_load(line, load.row, test.position))
    train = build_empty_train(len(catenary.contact_wires))
    before, after = (round(duration / test.time_step) for duration in (test.hanging, test.duration))
    time: Array = test.time_step * np.arange(1 - before, after + 1).astype(np.float64)
    recording = allocate_recording(line, test.sensors, time.size, 0, test.axes)
    force = weight * _hanging_share(time, test.release_duration)
    recorder: FrameRecorder | None = None
    if choose_core().is_compiled:
        kernel = build_kernel_arrays(line, test.time_step, load=load)
        motion = motion_at_rest(kernel.layout, hanging, kernel.distributed.number)
        if test.frames is not None:
            recorder = FrameRecorder(test.frames, kernel, line.connectors.station.size)
        simulate_steps(kernel, motion, train, force, recording, progress, recorder)
    else:
        free = Passage((), (), 0.0, test.hanging + test.duration, test.time_step)
        point = point_load(line, load.row, test.position)
        simulate_full_steps(line, free, (hanging, train), recording, (point, force), progress)
    slack = time[(recording.slack > 0) & (time > 0)]
    return FreeDecay(
        time=time,
        motion=recording.motion.transpose(1, 0, 2).copy(),
        last_slack=float(slack[-1]) if slack.size else None,
        slack_at_start=int((hanging.slack & line.connectors.unilateral).sum()),
        frames=None if recorder is None else recorder.build_frames(),
    )


def _hanging_share(time: Array, duration: float) -> Array:
    """Share of the weight that still hangs: one until the release, then a linear decrease to zero."""
    if duration == 0:
        return np.where(time <= 0, 1.0, 0.0)
    return np.clip(1 - time / duration, 0.0, 1.0)
