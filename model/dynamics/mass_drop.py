"""Mass drop: a mass hangs on a wire, is let go, and the line swings free."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pantocheck.model.arrays import Array
from pantocheck.model.catenary import GRAVITY, Catenary
from pantocheck.model.discretised_line import discretise
from pantocheck.model.dynamics.kernel_arrays import Load, build_kernel_arrays
from pantocheck.model.dynamics.newmark import march
from pantocheck.model.dynamics.simulation import (
    build_workspace,
    empty_train,
    motion_at_rest,
    recorded_stations,
)
from pantocheck.model.failures import DidNotConverge
from pantocheck.model.fem.assembly import point_load
from pantocheck.model.statics.static_solver import StaticSolver

BLOCK = 5000
"""Steps between two reports of progress."""


@dataclass(frozen=True)
class MassDropSetup:
    """What is hung where, how it is let go, and what is recorded.

    Parameters
    ----------
    mass : float
        [kg].
    wire : str
        Name of the wire it hangs on.
    position : float
        [m].
    release_duration : float
        Over which its weight fades linearly; 0 for at once [s].
    hanging : float
        Time recorded before the release [s].
    duration : float
        Time recorded after the release [s].
    time_step : float
        [s].
    sensors : tuple[tuple[str, float], ...]
        Wire and place of each sensor [-, m].
    """

    mass: float
    wire: str
    position: float
    release_duration: float
    hanging: float
    duration: float
    time_step: float
    sensors: tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class FreeDecay:
    """What a drop gives; T samples, U sensors, N droppers.

    Parameters
    ----------
    time : (T,) ndarray
        From the release on, negative before [s].
    motion : (U, T, 3) ndarray
        Vertical displacement, velocity, acceleration [m, m/s, m/s2].
    last_slack : float or None
        When a dropper was slack for the last time after the release; None if never [s].
    slack_at_start : int
        Droppers that are slack under the hanging mass.
    """

    time: Array
    motion: Array
    last_slack: float | None
    slack_at_start: int


def simulate_mass_drop(
    catenary: Catenary, element_length: float, test: MassDropSetup, progress: Callable[[float], None] | None = None
) -> FreeDecay:
    """Simulate a mass drop.

    Parameters
    ----------
    catenary : Catenary
        The line.
    element_length : float
        Longest element [m].
    test : MassDropSetup
        Mass, place, sensors.
    progress : Callable[[float], None] or None
        Called now and then with the share done, 0 to 1.

    Returns
    -------
    FreeDecay
        The free decay.

    Raises
    ------
    NoInitialState, NoEquilibrium
        The line has no rest, without or with the mass.
    DidNotConverge
        a time step has no solution.
    """
    places = (test.position, *(position for _, position in test.sensors))
    line = discretise(catenary, element_length, places)
    load = Load(line.mesh.row_of[test.wire, "z"], line.mesh.station(test.position))
    stepping = build_kernel_arrays(line, test.time_step, load=load)
    weight = -test.mass * GRAVITY
    hanging = StaticSolver(line).deflection(weight * point_load(line, load.row, test.position))
    motion, train = motion_at_rest(hanging, stepping.modal_damping.size), empty_train(len(line.contact_rows))
    before, after = (round(duration / test.time_step) for duration in (test.hanging, test.duration))
    time: Array = test.time_step * np.arange(1 - before, after + 1).astype(np.float64)
    history = weight * _share_left(time, test.release_duration)
    rows, stations = recorded_stations(line, test.sensors)
    recorded = np.zeros((time.size, rows.size, 3))
    droppers = len(catenary.droppers)
    work = build_workspace(stepping, train)
    last_slack = None
    for first in range(0, time.size, BLOCK):
        part = slice(first, min(first + BLOCK, time.size))
        steps = part.stop - first
        tension, nothing = np.zeros((steps, droppers)), np.zeros((steps, 0))
        outputs = (nothing, nothing, recorded[part], tension)
        done = march(stepping, motion, train, work, history[part], rows, stations, *outputs)
        if done < steps:
            raise DidNotConverge(f"the forces of the step at {time[first + done]:.4f} s did not settle")
        slack = np.flatnonzero((tension == 0.0).any(axis=1))
        if slack.size and time[first + slack[-1]] > 0:
            last_slack = float(time[first + slack[-1]])
        if progress:
            progress(part.stop / time.size)
    return FreeDecay(
        time, recorded.transpose(1, 0, 2).copy(), last_slack, int((hanging.tension[:droppers] == 0.0).sum())
    )


def _share_left(time: Array, duration: float) -> Array:
    """Share of the weight that still hangs: one until the release, then a ramp down to zero."""
    if duration == 0:
        return np.where(time <= 0, 1.0, 0.0)
    return np.clip(1 - time / duration, 0.0, 1.0)
