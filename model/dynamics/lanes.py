"""Passages on one line in lanes: the core in C advances several at once, one in each number of a vector.

The passages share the matrices of the line, and each sweep along it. Pantographs, speed, start, ramp and duration may
differ, and each passage has its own active window. They end together, so that trains of one speed that start at
different places are at the same place. A passage has the same bits as alone (`time_step_lanes.h`).
"""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from typing import NamedTuple, TypeVar

import numpy as np

from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.active_window import WindowArrays, build_window_arrays
from pantocheck.model.dynamics.contact_arrays import ContactWorkspace, allocate_contact_workspace
from pantocheck.model.dynamics.core_choice import call_core, choose_core, pack_argument
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.dynamics.passage import History, Passage
from pantocheck.model.dynamics.recording import BLOCK, Recording, allocate_recording
from pantocheck.model.dynamics.scalar_forces import ScalarWorkspace
from pantocheck.model.dynamics.simulation import build_history, check_passage, simulate_passage, start_motion
from pantocheck.model.dynamics.train import Train
from pantocheck.model.dynamics.vectors import align

Item = TypeVar("Item")

FEWEST_PASSAGES = 4
"""Fewest passages that are faster in eight lanes than one after another."""


class Lane(NamedTuple):
    """Passage in a lane."""

    window: WindowArrays
    motion: Motion
    """State of the line, with the arrays of all lanes, (..., L)."""
    train: Train
    contact: ContactWorkspace
    recording: Recording
    begin: int
    """Number of the step of all lanes with which the passage begins."""


def count_core_lanes() -> int:
    """Number of passages that the core advances at once; one with another core than that in C."""
    library = choose_core().library
    return 1 if library is None else int(call_core(library, "lanes", ()))


def count_lanes(line: DiscretisedLine) -> int:
    """Number of passages that advance at once on a line; one with distributed forces."""
    return 1 if line.stretches.first.size or line.catenary.modal_damping else count_core_lanes()


def simulate_passages(
    line: DiscretisedLine, passages: Sequence[Passage], progress: Callable[[float], None] = lambda _: None
) -> list[History]:
    """Simulate passages of one time step without moving pictures, in lanes if the line has them.

    Args:
        line: Discretised line.
        passages: Pantographs, speed and duration of each.
        progress: Called from time to time with the completed share, 0 to 1.

    Raises:
        ImpossiblePassage, DidNotConverge: As in `simulate_passage`.
    """
    found = list[History]()
    for group in split_into_lanes(line, passages):
        part = partial(_report_part, progress, len(found) / len(passages), len(group) / len(passages))
        if len(group) > 1:
            found += _simulate_together(line, group, part)
        else:
            found.append(simulate_passage(line, group[0], part))
    return found


def split_into_lanes(line: DiscretisedLine, items: Sequence[Item]) -> list[Sequence[Item]]:
    """Split items, each with one passage on a line, into groups that advance at once; alone, if this is not faster."""
    lanes = count_lanes(line)
    groups = [items[first : first + lanes] for first in range(0, len(items), lanes)]
    fewest = min(lanes, FEWEST_PASSAGES)
    return [part for group in groups for part in ([group] if len(group) >= fewest else [[item] for item in group])]


def _report_part(progress: Callable[[float], None], done: float, size: float, share: float) -> None:
    progress(done + size * share)


def _simulate_together(
    line: DiscretisedLine, passages: Sequence[Passage], progress: Callable[[float], None]
) -> list[History]:
    """Simulate passages, at most one per lane; empty lanes copy the first one, and never begin."""
    library, size = choose_core().library, count_lanes(line)
    assert library is not None
    for passage in passages:
        check_passage(line, passage)
    kernel = build_kernel_arrays(line, passages[0].time_step)
    starts = [start_motion(line, kernel, passage) for passage in passages]
    steps = [round(passage.duration / passage.time_step) for passage in passages]
    end = max(steps)
    w, r, force = (align(np.zeros((*array.shape, size))) for array in starts[0][0][:3])
    lanes = [
        Lane(
            build_window_arrays(line, passage),
            motion._replace(w=w, r=r, force=force),
            train,
            allocate_contact_workspace(kernel.contact, kernel.connectors, kernel.distributed, train),
            allocate_recording(line, passage.watched, own, train.owner.size),
            end - own,
        )
        for passage, (motion, train), own in zip(passages, starts, steps, strict=True)
    ]
    filled = lanes + [lanes[0]._replace(begin=end)] * (size - len(lanes))
    words = np.array([np.frombuffer(pack_argument(lane), np.int64) for lane in filled])
    scalar = ScalarWorkspace(*(align(np.zeros((force.shape[0], size))) for _ in range(3)))
    node = align(np.zeros((kernel.connectors.nodes.station.size, size)))
    packed = [pack_argument(argument) for argument in (kernel, scalar, node, words)]
    for first, last in pairwise(sorted({*range(0, end, BLOCK), end, *(lane.begin for lane in lanes)})):
        for number, (lane, (motion, _)) in enumerate(zip(lanes, starts, strict=True)):
            if lane.begin == first:
                w[..., number], r[..., number], force[..., number] = motion[:3]
        if call_core(library, "advance_lanes", (*packed, first, last)) < last:
            # Alone, the passage that does not converge says when.
            return [simulate_passage(line, passage) for passage in passages]
        progress(last / end)
    return [
        build_history(passage, lane.window, lane.train, lane.recording)
        for passage, lane in zip(passages, lanes, strict=True)
    ]
