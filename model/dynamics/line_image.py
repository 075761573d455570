"""Memory image of a line for a program without Python: everything that `line_fmu.c` needs for a passage.

    head | arguments of a step, with relative addresses | state, changed by steps | other arrays | places of addresses

The head and the arguments are the structure `Image` of the C file. Addresses count from the start of the image; the C
file adds its own address to each. The values of all variables are the first array of the state.
"""

import hashlib
import struct
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Literal, NamedTuple

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.core_choice import pack_argument
from pantocheck.model.dynamics.foreign_pantograph import build_interface
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, Workspace, build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.motion import Motion, motion_at_rest
from pantocheck.model.dynamics.passage import Passage
from pantocheck.model.dynamics.recording import Recording, allocate_recording
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.dynamics.train import Train
from pantocheck.model.dynamics.vectors import ALIGNMENT, round_up
from pantocheck.model.statics.static_solver import static_solver

IMAGE_MARK = b"PNTLINE1"
"""Mark of an image, with its version."""
LIGHT_HEAD = 1e7
"""Inverse mass of a head whose force is given [1/kg]: it takes 4e-4 N per millimetre in a step of 1 ms."""

GivenInput = Literal["height", "force"]
"""Input of a line at each strip; the other one is its output."""


class LineVariable(NamedTuple):
    """Variable of a line as FMU; its value reference is its place among all."""

    name: str
    unit: str
    """Unit in SI."""
    causality: Literal["independent", "parameter", "input", "output"]
    value: float
    """Value at the start."""
    description: str


class LineInterface(NamedTuple):
    """Exchange of a line with the program around it; C strips, P pantographs, F scalar forces, V variables."""

    values: Array
    """Values of the variables, (V,)."""
    heights: Array
    """Heights of the strips after the last step and after the one before, (2, C) [m]."""
    unloaded: Array
    """Scalar forces of the line without a pantograph, (F,)."""
    start: Array
    """Positions of the pantographs in the state at the start, (P,) [m]."""
    force_given: int


class LineArguments(NamedTuple):
    """Arguments of the C file."""

    kernel: KernelArrays
    motion: Motion
    train: Train
    work: Workspace
    recording: Recording
    interface: LineInterface


class LineImage(NamedTuple):
    """Image of a line."""

    content: bytes
    token: str
    """SHA-256 of the content after the token itself, by which model description and image know each other."""
    variables: tuple[LineVariable, ...]


def build_line_image(line: DiscretisedLine, passage: Passage, given: GivenInput) -> LineImage:
    """Build the image of a line under pantographs that another program moves.

    Args:
        line: Discretised line.
        passage: Pantographs with their static forces, start, speed and time step; its watched places have an uplift.
        given: Input at each strip.

    Returns:
        Image of the state at the start: the static forces press.
    """
    passage = replace(passage, pantographs=tuple(map(build_interface, passage.pantographs)))
    kernel = build_kernel_arrays(line, passage.time_step)
    motion, train = start_motion(line, kernel, passage)
    train.inverse[...] *= LIGHT_HEAD if given == "force" else 0.0
    recording = allocate_recording(line, passage.watched, 1, train.owner.size)
    strips = np.arange(train.owner.size) - train.first_strip[train.owner]
    recording.contact[0] = train.contact.sum(axis=1)
    recording.height[0] = train.z[0, train.owner, strips]
    recording.motion[0, :, 0] = motion.w[0, recording.row, recording.station]
    unloaded = static_solver(line).deflection(np.zeros(line.beams.free.size))
    variables = tuple(list_variables(passage, train, recording, given))
    interface = LineInterface(
        values=np.array([variable.value for variable in variables]),
        heights=np.repeat(recording.height, 2, axis=0),
        unloaded=motion_at_rest(kernel.layout, unloaded, kernel.distributed.number).force,
        start=train.position.copy(),
        force_given=int(given == "force"),
    )
    moved = [interface.values, *motion, train.position, train.speed, train.elapsed, train.force, train.z]
    moved += [train.contact, train.joint_force, *recording[2:], interface.heights]
    arguments = LineArguments(kernel, motion, train, build_workspace(kernel, train), recording, interface)
    content, token = pack_image(arguments, moved)
    return LineImage(content, token, variables)


def list_variables(passage: Passage, train: Train, recording: Recording, given: GivenInput) -> Iterator[LineVariable]:
    """List the variables in the order of the C file."""
    yield LineVariable("time", "s", "independent", 0.0, "Time")
    yield LineVariable("speed", "m/s", "parameter", passage.speed, "Speed of the train")
    numbers = range(1, len(passage.pantographs) + 1)
    for n, x in zip(numbers, passage.start, strict=True):
        yield LineVariable(f"start_{n}", "m", "parameter", x, f"Position of pantograph {n} at the start")
    for n in numbers:
        text = f"Distance of pantograph {n} ahead of start + speed * time"
        yield LineVariable(f"travel_{n}", "m", "input", 0.0, text)
    for n, x in zip(numbers, passage.start, strict=True):
        yield LineVariable(f"position_{n}", "m", "output", x, f"Position of pantograph {n} along the track")
    names = [
        f"{p + 1}" if count == 1 else f"{p + 1}_{strip + 1}"
        for p, count in enumerate(np.diff(train.first_strip))
        for strip in range(count)
    ]
    rows: tuple[tuple[GivenInput, str, str, str, Array], ...] = (
        ("height", "head_height", "m", "Height of head {} above the datum of the line", recording.height[0]),
        ("force", "contact_force", "N", "Contact force of head {}, not negative", recording.contact[0]),
    )
    for kind, name, unit, text, values in rows:
        for strip, value in zip(names, values.tolist(), strict=True):
            causality: Literal["input", "output"] = "input" if kind == given else "output"
            yield LineVariable(f"{name}_{strip}", unit, causality, value, text.format(strip))
    for n, ((wire, x), value) in enumerate(zip(passage.watched, recording.motion[0, :, 0].tolist(), strict=True), 1):
        yield LineVariable(f"uplift_{n}", "m", "output", value, f"Uplift of wire {wire} at the support at {x:g} m")


def list_arrays(value: Any) -> Iterator[Any]:
    """Arrays of nested named tuples, in their order."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from list_arrays(part)


def pack_image(arguments: LineArguments, moved: list[Any]) -> tuple[bytes, str]:
    """Pack arguments, with the arrays that a step changes as one block; content and token."""
    head = struct.calcsize("=64s8s5q")
    words = len(pack_argument(arguments)) + 8
    end, places, arrays = round_up(head + words, ALIGNMENT), dict[int, int](), {id(a): a for a in moved}
    begin = end
    arrays |= {id(array): array for array in list_arrays(arguments)}
    for number, (key, array) in enumerate(arrays.items(), 1):
        places[key] = end
        end = round_up(end + array.nbytes, ALIGNMENT)
        if number == len(moved):
            state_end = end
    image = bytearray(end)
    for key, array in arrays.items():
        image[places[key] : places[key] + array.nbytes] = array.tobytes()
    packed = struct.pack("=q", words) + pack_argument(arguments, locate=lambda array: places[id(array)])
    shifted = struct.pack("=q", words) + pack_argument(arguments, locate=lambda array: places[id(array)] + 1)
    image[head : head + words] = packed
    # The addresses are those words that depend on the base.
    addresses = np.flatnonzero(np.frombuffer(packed, np.int64) != np.frombuffer(shifted, np.int64)) * 8 + head
    image += addresses.astype(np.int64).tobytes()
    size = round_up(len(image), ALIGNMENT)
    image += bytes(size - len(image))
    image[64:head] = struct.pack("=8s5q", IMAGE_MARK, size, begin, state_end - begin, end, addresses.size)
    token = hashlib.sha256(image[64:]).hexdigest()
    image[:64] = token.encode()
    return bytes(image), token
