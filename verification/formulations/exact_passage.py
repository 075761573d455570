"""Passage of a pantograph along the geometrically exact model of a line."""

from dataclasses import dataclass

import numpy as np

from pantocheck.model import DiscretisedLine, History, Passage
from pantocheck.model.description.pantograph import Pantograph
from verification.formulations.exact_contact import ExactPantograph
from verification.formulations.exact_line import Array, ExactLine
from verification.formulations.exact_points import watched_points
from verification.formulations.exact_steps import ExactMotion, march, relax

TIME_STEP_PER_LENGTH = 2e-4
"""Time step over spacing: below the inverse of the speed of axial waves, about 1 / (3600 m/s) [s/m]."""
INTERVAL = 5e-4
"""Time between two samples [s]."""
RELAXATION, DRAG = 2.0, 10.0
"""Duration of a relaxation to rest [s], and mass-proportional damping close to critical for 0.8 Hz [1/s]."""
ADJUSTMENTS = 2
"""Number of adjustments of the dropper lengths, each after half a relaxation."""


@dataclass(frozen=True)
class Rest:
    """Line at rest without a pantograph."""

    line: ExactLine
    """Line with adjusted droppers."""
    position: Array
    """Positions of the points, (3, N) [m]."""
    speed: float
    """Largest speed at the end of the relaxation [m/s]."""

    @property
    def bar_tension(self) -> Array:
        """Tension of every dropper and steady arm, (B,) [N]."""
        bars = self.line.bars
        extent = self.position[:, bars.ends[:, 1]] - self.position[:, bars.ends[:, 0]]
        return bars.stiffness * (np.linalg.norm(extent, axis=0) - bars.length)


def time_step(line: ExactLine) -> float:
    """Time step of a line [s], a whole fraction of the sampling interval."""
    return float(INTERVAL / np.ceil(INTERVAL / (TIME_STEP_PER_LENGTH * line.wires.spacing.min()) - 1e-9))


def find_rest(line: ExactLine, position: Array) -> Rest:
    """Let a line come to rest and adjust its droppers, so that the contact wire hangs at its prescribed heights.

    Args:
        line: Line with the dropper lengths of the linear static state.
        position: Positions of the linear static state, (3, N) [m].
    """
    motion = ExactMotion(position.copy(), np.zeros_like(position), np.zeros(1), np.zeros(1))
    dt = time_step(line)
    droppers = line.bars.unilateral
    lower = line.bars.ends[droppers, 0]
    for _ in range(ADJUSTMENTS):
        relax(line, no_pantograph(), motion, dt, 0.0, RELAXATION / 2, DRAG)
        length = line.bars.length.copy()
        length[droppers] += motion.position[2, lower] - position[2, lower]
        line = line._replace(bars=line.bars._replace(length=length))
    speed = relax(line, no_pantograph(), motion, dt, 0.0, RELAXATION, DRAG)
    return Rest(line, motion.position, speed)


def simulate_exact_passage(discretised: DiscretisedLine, rest: Rest, passage: Passage) -> History:
    """Simulate a passage that starts like the reference simulator: at rest, with the full static force.

    Args:
        discretised: Line from which the exact model was built.
        rest: Exact model at rest.
        passage: Passage of one pantograph; its time step is that of the samples.

    Returns:
        Contact force and uplift at the watched supports.
    """
    (pantograph,), (start,) = passage.pantographs, passage.start
    train = _build_pantograph(pantograph)
    n = pantograph.head.size
    motion = ExactMotion(rest.position.copy(), np.zeros_like(rest.position), np.zeros(n), np.zeros(n))
    line, dt = rest.line, time_step(rest.line)
    relax(line, train, motion, dt, start, RELAXATION, DRAG)
    watched = watched_points(discretised, passage.watched)
    samples = round(passage.duration / INTERVAL)
    contact, height = np.zeros(samples), np.zeros((samples, watched.size))
    march(line, train, motion, dt, start, passage.speed, round(INTERVAL / dt), watched, contact, height)
    time = INTERVAL * (np.arange(samples) + 0.5)
    uplift = (height - rest.position[2, watched]).T[:, :, None]
    position = (start + passage.speed * time)[None]
    return History(time, position, contact[None], np.full_like(contact, np.nan)[None], uplift)


def _build_pantograph(pantograph: Pantograph) -> ExactPantograph:
    return ExactPantograph(
        inverse_mass=np.linalg.inv(pantograph.mass),
        damping=pantograph.damping.copy(),
        stiffness=pantograph.stiffness.copy(),
        head=pantograph.head.copy(),
        force=pantograph.force.copy(),
        contact_stiffness=pantograph.contact_stiffness,
        wire=0,
    )


def no_pantograph() -> ExactPantograph:
    """A pantograph without contact, for the line alone."""
    nothing = np.zeros((1, 1))
    return ExactPantograph(np.eye(1), nothing, nothing, np.zeros(1), np.zeros(1), 0.0, 0)
