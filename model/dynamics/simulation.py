"""Simulation of a passage: pantographs along a line, starting from rest."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.failures import ImpossiblePassage
from pantocheck.model.description.pantograph import Pantograph
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.active_window import WindowArrays, build_window_arrays, find_unknown
from pantocheck.model.dynamics.contact_arrays import build_irregularity_arrays, height_of_irregularity
from pantocheck.model.dynamics.core_choice import choose_core
from pantocheck.model.dynamics.foreign_pantograph import build_interface, couple_steps, start_interfaces
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, build_kernel_arrays
from pantocheck.model.dynamics.motion import Motion, motion_at_rest
from pantocheck.model.dynamics.passage import ForeignPantograph, Frames, History, Passage
from pantocheck.model.dynamics.recording import FrameRecorder, Recording, allocate_recording, simulate_steps
from pantocheck.model.dynamics.reference_kernel import simulate_full_steps
from pantocheck.model.dynamics.train import Train, build_train
from pantocheck.model.fem import beam
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.fem.residual_flexibility import residual_flexibility
from pantocheck.model.statics.assembly import point_load
from pantocheck.model.statics.contact_wires import locate_contact_wires, touched_wires
from pantocheck.model.statics.static_solver import Deflection, static_solver


def simulate_passage(
    line: DiscretisedLine,
    passage: Passage,
    progress: Callable[[float], None] | None = None,
    programs: Sequence[ForeignPantograph | None] = (),
) -> History:
    """Simulate the passage of pantographs along a line, starting from rest.

    Args:
        line: Discretised line.
        passage: Pantographs, speed, duration.
        progress: Called from time to time with the completed share, 0 to 1.
        programs: Programs that move pantographs in place of their model, in running order; None: the model.

    Returns:
        Contact forces and motion.

    Raises:
        ImpossiblePassage: There is no pantograph, or one would leave the line.
        DidNotConverge: The forces of a time step did not converge.
    """
    check_passage(line, passage)
    pantographs, programs = passage.pantographs, programs or [None] * len(passage.pantographs)
    pairs = zip(pantographs, programs, strict=True)
    moved = tuple(pantograph if program is None else build_interface(pantograph) for pantograph, program in pairs)
    passage = replace(passage, pantographs=moved)
    deflection, train = start_at_rest(line, passage)
    interfaces = start_interfaces(programs, pantographs, train, passage.time_step)
    steps = round(passage.duration / passage.time_step)
    recording = allocate_recording(line, passage.watched, steps, train.owner.size)
    window = build_window_arrays(line, passage)
    recorder: FrameRecorder | None = None
    if not choose_core().is_compiled:
        if interfaces:
            raise ImpossiblePassage(
                "the reference kernel does not move pantographs that are programs: demand another kernel"
            )
        simulate_full_steps(line, passage, (deflection, train), recording, progress=progress)
    else:
        kernel = build_kernel_arrays(line, passage.time_step, window)
        motion = motion_at_rest(kernel.layout, deflection, kernel.distributed.number)
        if interfaces:
            couple_steps(kernel, motion, train, interfaces, recording, progress)
        else:
            if passage.frames is not None:
                recorder = FrameRecorder(passage.frames, kernel, line.connectors.station.size)
            simulate_steps(kernel, motion, train, np.zeros(steps), recording, progress, recorder)
    history = build_history(passage, window, train, recording)
    time = history.time
    frames = None if recorder is None else _hide_unknown(recorder, line, window, passage, time)
    return replace(history, coupling=tuple(interface.coupling for interface in interfaces), frames=frames)


def build_history(passage: Passage, window: WindowArrays, train: Train, recording: Recording) -> History:
    """Contact forces and motion of a recorded passage."""
    time: Array = passage.time_step * np.arange(1, len(recording.contact) + 1).astype(np.float64)
    force, height = recording.contact.T.copy(), recording.height.T.copy()
    first = train.first_strip[:-1]
    watched = recording.motion.transpose(1, 0, 2).copy()
    stations = np.array([place for _, place in passage.watched])
    watched[find_unknown(window, passage, stations, time)] = np.nan
    return History(
        time=time,
        position=np.array(passage.start)[:, None] + passage.speed * time,
        force=np.add.reduceat(force, first),
        height=np.add.reduceat(height, first) / np.diff(train.first_strip)[:, None],
        motion=watched,
        strip_force=force,
    )


def _hide_unknown(
    recorder: FrameRecorder, line: DiscretisedLine, window: WindowArrays, passage: Passage, time: Array
) -> Frames:
    """Recorded frames, with NaN where the motion is unknown."""
    request, frames = recorder.request, recorder.build_frames()
    chosen = np.array(request.steps) - 1  # the first cut may lie between two frames
    unknown = find_unknown(window, passage, line.mesh.position[list(request.stations)], time, chosen)
    return replace(frames, displacement=np.where(unknown.T[:, None], np.nan, frames.displacement))


def check_passage(line: DiscretisedLine, passage: Passage) -> None:
    """Require a pantograph, and positions of all pantographs on the line at all times."""
    if not passage.pantographs:
        raise ImpossiblePassage("the passage has no pantograph; at least one is needed")
    first, last = line.mesh.position[0], line.mesh.position[-1]
    places = [place for _, place in _strip_places(passage)]
    rear, front = min(places), max(places) + passage.speed * passage.duration
    if rear < first or front > last:
        raise ImpossiblePassage(
            f"the pantographs run from {rear:g} m to {front:g} m, but the line extends from {first:g} m to {last:g} m"
        )


def _strip_places(passage: Passage) -> list[tuple[Pantograph, float]]:
    """Pantograph and position at the start of every strip."""
    return [
        (pantograph, x + strip.offset)
        for pantograph, x in zip(passage.pantographs, passage.start, strict=True)
        for strip in pantograph.strips
    ]


def start_motion(line: DiscretisedLine, kernel: KernelArrays, passage: Passage) -> tuple[Motion, Train]:
    """Line and pantographs at rest, as in `start_at_rest`, in the arrays of a kernel."""
    deflection, train = start_at_rest(line, passage)
    return motion_at_rest(kernel.layout, deflection, kernel.distributed.number), train


def start_at_rest(line: DiscretisedLine, passage: Passage) -> tuple[Deflection, Train]:
    """Compute line and pantographs at rest, each pressing with its static force; before a ramp, with none."""
    wires, pressed = locate_contact_wires(line), float(passage.ramp == 0)
    places = _strip_places(passage)
    shares = [share for pantograph in passage.pantographs for share in pantograph.strip_shares]
    touched = np.zeros((len(places), wires.row.size), dtype=np.bool_)
    load = np.zeros(line.beams.free.size)
    for c, ((pantograph, x), share) in enumerate(zip(places, shares, strict=True)):
        under = touched_wires(line, x)
        touched[c, under] = True
        for row in wires.row[under]:
            load += share / under.size * pressed * pantograph.static_force * point_load(line, row, x)
    deflection = static_solver(line).deflection(load)
    profile = line.state.deflection + deflection.displacement
    height, flexibility = np.zeros(touched.shape), np.zeros(touched.shape)
    for c, wire in np.argwhere(touched):
        height[c, wire], flexibility[c, wire] = _contact_point(line, profile, wire, places[c][1])
    return deflection, build_train(passage, touched, height, flexibility)


def _contact_point(line: DiscretisedLine, profile: Array, wire: int, position: float) -> tuple[float, float]:
    """Height of a contact wire with its irregularity, and its residual flexibility, at a position [m, m/N]."""
    element, length, s = find_element(line.mesh.position, position)
    row = locate_contact_wires(line).row[wire]
    height = float(beam.shape(s, length) @ profile[row, element : element + 2].ravel())
    height += height_of_irregularity(build_irregularity_arrays(line.catenary.contact_wires), wire, position)
    return height, residual_flexibility(line.beams.flexibility[row, element], s)
