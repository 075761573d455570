"""Runs: pantographs along a line, or a line left to itself."""

from collections.abc import Callable

import numpy as np

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.dynamics.newmark import march
from pantocheck.model.dynamics.passage import History, Passage
from pantocheck.model.dynamics.state import PIECE, KernelArrays, Motion, Train, Workspace
from pantocheck.model.failures import DidNotConverge, ImpossiblePassage
from pantocheck.model.fem import beam
from pantocheck.model.fem.assembly import point_load
from pantocheck.model.fem.residual_flexibility import local_flexibility
from pantocheck.model.pantograph import Pantograph
from pantocheck.model.statics.static_solver import Deflection, StaticSolver

BLOCK = 500
"""Steps between two reports of progress."""


def simulate_passage(
    line: DiscretisedLine, passage: Passage, progress: Callable[[float], None] | None = None
) -> History:
    """Drive pantographs along a line from rest.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    passage : Passage
        Pantographs, speed, duration.
    progress : Callable[[float], None] or None
        Called now and then with the share done, 0 to 1.

    Returns
    -------
    History
        The history.

    Raises
    ------
    ImpossiblePassage
        There is no pantograph, or one would leave the line.
    DidNotConverge
        a time step has no solution.
    """
    _check(line, passage)
    stepping = build_kernel_arrays(line, passage.time_step, passage.reach)
    motion, train = start_motion(line, stepping, passage)
    steps = round(passage.duration / passage.time_step)
    rows, stations = recorded_stations(line, passage.watched)
    force, height = np.zeros((steps, len(passage.pantographs))), np.zeros((steps, len(passage.pantographs)))
    motion_there, no_load, nothing = np.zeros((steps, rows.size, 3)), np.zeros(steps), np.zeros((steps, 0))
    work = build_workspace(stepping, train)
    for first in range(0, max(steps, 1), BLOCK):
        part = slice(first, min(first + BLOCK, steps))
        outputs = (force[part], height[part], motion_there[part], nothing[part])
        done = march(stepping, motion, train, work, no_load[part], rows, stations, *outputs)
        if done < part.stop - first:
            raise DidNotConverge(f"the forces of the step at {(first + done) * passage.time_step:.3f} s did not settle")
        if progress:
            progress(part.stop / max(steps, 1))
    time: Array = passage.time_step * np.arange(1, steps + 1).astype(np.float64)
    position: Array = np.array(passage.start)[:, None] + passage.speed * time
    return History(time, position, force.T.copy(), height.T.copy(), motion_there.transpose(1, 0, 2).copy())


def _check(line: DiscretisedLine, passage: Passage) -> None:
    if not passage.pantographs:
        raise ImpossiblePassage("there is no pantograph to run")
    first, last = line.mesh.position[0], line.mesh.position[-1]
    rear, front = min(passage.start), max(passage.start) + passage.speed * passage.duration
    if rear < first or front > last:
        raise ImpossiblePassage(
            f"pantographs would run from {rear:g} m to {front:g} m on a line that lies from {first:g} m to {last:g} m"
        )


def start_motion(line: DiscretisedLine, stepping: KernelArrays, passage: Passage) -> tuple[Motion, Train]:
    """Line and pantographs at rest, each pantograph pressing with its static force.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    stepping : KernelArrays
        Its arrays for the time step.
    passage : Passage
        Pantographs and their places.

    Returns
    -------
    tuple[Motion, Train]
        State of the line, state of the pantographs.
    """
    share = 1 / len(line.contact_rows)
    load = np.zeros(line.beams.free.size)
    for pantograph, x in zip(passage.pantographs, passage.start, strict=True):
        for row in line.contact_rows:
            load += share * pantograph.static_force * point_load(line, row, x)
    at_rest = StaticSolver(line).deflection(load)
    return motion_at_rest(at_rest, stepping.modal_damping.size), _train(line, stepping, passage, at_rest)


def motion_at_rest(deflection: Deflection, modes: int = 0) -> Motion:
    """A line held at rest in a static deflection; `modes` of its modes have a damping of their own."""
    w, r = (np.zeros((3, *deflection.displacement.shape[:2])) for _ in range(2))
    # Far from the loads the deflection fades into denormal numbers, which processors handle a hundred times slower.
    displacement = np.where(np.abs(deflection.displacement) < 1e-30, 0.0, deflection.displacement)
    w[0], r[0] = displacement[..., 0], displacement[..., 1]
    return Motion(w, r, deflection.tension.copy(), np.zeros(modes), np.zeros(1))


def recorded_stations(line: DiscretisedLine, watched: tuple[tuple[str, float], ...]) -> tuple[Indices, Indices]:
    """Rows and stations of the places whose motion is recorded."""
    rows = np.array([line.mesh.row_of[wire, "z"] for wire, _ in watched], dtype=np.int64)
    return rows, np.array([line.mesh.station(position) for _, position in watched], dtype=np.int64)


def empty_train(contact_wires: int) -> Train:
    """No pantograph at all, for a line left to itself."""
    return Train(
        position=np.zeros(0),
        speed=np.zeros(1),
        elapsed=np.zeros(1),
        inverse=np.zeros((0, 1, 1)),
        damping=np.zeros((0, 1, 1)),
        stiffness=np.zeros((0, 1, 1)),
        head=np.zeros((0, 1)),
        force=np.zeros((0, 1)),
        contact_stiffness=np.zeros(0),
        z=np.zeros((3, 0, 1)),
        contact=np.zeros((0, contact_wires)),
    )


def _train(line: DiscretisedLine, stepping: KernelArrays, passage: Passage, at_rest: Deflection) -> Train:
    count, most = len(passage.pantographs), max(p.head.size for p in passage.pantographs)
    wires = len(line.contact_rows)
    inverse, damping, stiffness = (np.zeros((count, most, most)) for _ in range(3))
    head, force = np.zeros((count, most)), np.zeros((count, most))
    z = np.zeros((3, count, most))
    half, quarter = passage.time_step / 2, passage.time_step**2 / 4
    profile = at_rest.displacement[line.contact_rows]
    for p, pantograph in enumerate(passage.pantographs):
        n = pantograph.head.size
        inverse[p, :n, :n] = np.linalg.inv(pantograph.mass + half * pantograph.damping + quarter * pantograph.stiffness)
        damping[p, :n, :n], stiffness[p, :n, :n] = pantograph.damping, pantograph.stiffness
        head[p, :n], force[p, :n] = pantograph.head, pantograph.force
        places = [_under_head(stepping, profile[k], k, passage.start[p]) for k in range(wires)]
        wire, flexibility = np.mean(places, axis=0)
        closing = pantograph.static_force / wires * (1 / pantograph.contact_stiffness + float(flexibility))
        z[0, p, :n] = _rest(pantograph, float(wire) + closing)
    contact = np.array([[p.static_force / wires] * wires for p in passage.pantographs])
    return Train(
        position=np.array(passage.start),
        speed=np.array([passage.speed]),
        elapsed=np.zeros(1),
        inverse=inverse,
        damping=damping,
        stiffness=stiffness,
        head=head,
        force=force,
        contact_stiffness=np.array([p.contact_stiffness for p in passage.pantographs]),
        z=z,
        contact=contact,
    )


def _under_head(stepping: KernelArrays, profile: Array, wire: int, position: float) -> tuple[float, float]:
    """Height of a contact wire at one place in a static deflection, and its local flexibility there [m, m/N]."""
    x = stepping.position
    e = int(np.clip(np.searchsorted(x, position) - 1, 0, x.size - 2))
    h = x[e + 1] - x[e]
    s = (position - x[e]) / h
    height = float(beam.shape(s, h) @ (stepping.rest[wire] + profile)[e : e + 2].ravel())
    return height, local_flexibility(stepping.bubble[wire, e], s)


def _rest(pantograph: Pantograph, head_height: float) -> Array:
    """Displacements of a pantograph whose head is held at a height and whose other parts are at rest."""
    n = pantograph.head.size
    system = np.zeros((n + 1, n + 1))
    system[:n, :n] = pantograph.stiffness
    system[:n, n] = system[n, :n] = pantograph.head
    return np.asarray(np.linalg.solve(system, np.append(pantograph.force, head_height))[:n])


def build_workspace(line: KernelArrays, train: Train) -> Workspace:
    """Arrays for the time step of one run."""
    pantographs, wires = train.contact.shape
    return Workspace(
        seen=np.zeros((2, PIECE + 1)),
        forces=np.zeros((4, PIECE + 1)),
        tension=np.zeros(line.station.size),
        shape=np.zeros((pantographs, wires, 4)),
        element=np.zeros(pantographs, dtype=np.int64),
        stiffness=np.zeros((pantographs, wires)),
        closing=np.zeros((pantographs, wires)),
        compliance=np.zeros((pantographs, wires)),
        modal_velocity=np.zeros(line.modal_damping.size),
    )
