"""Structure of a pantograph head: strips on springs, pitch and roll, bending modes, friction and stops.

   strip 2        strip 1       x, running direction ->
 [m_2] . . x . . [m_1]          each strip at its distance x from the position of the pantograph
   |  k_2, c_2     |  k_1, c_1
 ==========o==========          head: displacement z_h of the last mass, pitch p, roll r
           |                    lower end of strip i: z_h + x_i p

At the lateral position y of the wire, a strip rises by y r, and by its shape s(y) in a bending mode. The unknowns
follow those of the model: pitch, strips with a mass of their own, roll, bending modes.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.pantograph import ContactStrip, Joint, Pantograph, add_spring, add_unknown


@dataclass(frozen=True)
class MountedStrip:
    """Collector strip on the head of a pantograph."""

    offset: float
    """Distance ahead of the position of the pantograph [m]."""
    mass: float = 0.0
    """Mass on a spring [kg]; zero: the strip is fixed to the head, whose mass contains it."""
    stiffness: float = 0.0
    damping: float = 0.0
    """Spring and damper between strip and head [N/m, N s/m]."""


@dataclass(frozen=True)
class Rotation:
    """Rotation of the head, held by a spring and a damper."""

    inertia: float
    """Moment of inertia [kg m2]."""
    stiffness: float
    damping: float
    """Coefficients of spring and damper [N m/rad, N m s/rad]."""


def mount_strips(pantograph: Pantograph, strips: Sequence[MountedStrip], pitch: Rotation | None = None) -> Pantograph:
    """Mount strips on the head, from front to rear, in place of its own contact.

    Args:
        pantograph: Linear model with a single contact.
        strips: Strips.
        pitch: Rotation about the lateral axis, positive if the front rises; None: the head does not pitch.
    """
    head = pantograph.head
    if pitch is not None:
        pantograph = add_unknown(pantograph, pitch.inertia, pitch.damping, pitch.stiffness)
    shapes = []
    for strip in strips:
        lower = np.append(head, strip.offset) if pitch is not None else head
        lower = np.pad(lower, (0, pantograph.head.size - lower.size))
        if strip.mass == 0:
            shapes.append(lower)
            continue
        pantograph = add_unknown(pantograph, strip.mass)
        own = np.eye(pantograph.head.size)[-1]
        pantograph = add_spring(pantograph, own - np.append(lower, 0.0), strip.stiffness, strip.damping)
        shapes.append(own)
    size = pantograph.head.size
    padded = [np.pad(shape, (0, size - shape.size)) for shape in shapes]
    return set_strips(pantograph, [strip.offset for strip in strips], padded)


def set_strips(pantograph: Pantograph, offsets: Sequence[float], shapes: Sequence[Array]) -> Pantograph:
    """Place the contacts of a pantograph.

    Args:
        pantograph: Linear model.
        offsets: Distance of each strip ahead of the position of the pantograph [m].
        shapes: Displacement of each strip per unknown, (n,) each [-].
    """
    strips = tuple(ContactStrip(offset, shape[None]) for offset, shape in zip(offsets, shapes, strict=True))
    return replace(pantograph, own_strips=strips, head=np.mean(shapes, axis=0))


def add_roll(pantograph: Pantograph, roll: Rotation) -> Pantograph:
    """Add the roll of the head about the axis of the track: a strip rises by y times the angle."""
    rolling = add_unknown(_with_strips(pantograph), roll.inertia, roll.damping, roll.stiffness)
    return _move_strips(rolling, [(0.0, 1.0)] * len(rolling.strips))


def add_bending_mode(
    pantograph: Pantograph, frequency: float, damping_ratio: float, shapes: Sequence[Sequence[float]]
) -> Pantograph:
    """Add a mass-normalised bending mode of horns or strips with a free head.

    Args:
        pantograph: Linear model.
        frequency: Natural frequency [Hz].
        damping_ratio: Damping ratio [-].
        shapes: Displacement of each strip in the mode: coefficients of the powers of the lateral position of the wire,
            from 0 on [kg^-1/2, kg^-1/2 / m, ...].
    """
    omega = 2 * math.pi * frequency
    return _move_strips(add_unknown(_with_strips(pantograph), 1.0, 2 * damping_ratio * omega, omega**2), shapes)


def _with_strips(pantograph: Pantograph) -> Pantograph:
    """Pantograph with its only contact as a strip."""
    return replace(pantograph, own_strips=pantograph.strips)


def _move_strips(pantograph: Pantograph, shapes: Sequence[Sequence[float]]) -> Pantograph:
    """Let each strip move with the last unknown by a polynomial of the lateral position."""
    strips = []
    for strip, polynomial in zip(pantograph.own_strips, shapes, strict=True):
        powers = max(len(strip.shape), len(polynomial))
        shape = np.pad(strip.shape, ((0, powers - len(strip.shape)), (0, 0)))
        shape[: len(polynomial), -1] += polynomial
        strips.append(replace(strip, shape=shape))
    return replace(pantograph, own_strips=tuple(strips), head=np.mean([strip.shape[0] for strip in strips], axis=0))


def add_friction(pantograph: Pantograph, direction: Array, force: float, sliding_speed: float) -> Pantograph:
    """Add Coulomb friction: a damper that takes at most a force.

    Args:
        pantograph: Linear model.
        direction: Closing of the rubbing parts per unknown, (n,) [-].
        force: Force of sliding [N].
        sliding_speed: Speed from which the parts slide; below, the force is proportional to the speed [m/s].
    """
    joint = Joint(direction, damping=force / sliding_speed, lower=-force, upper=force)
    return replace(pantograph, joints=(*pantograph.joints, joint))


def add_stop(pantograph: Pantograph, direction: Array, gap: float, stiffness: float, damping: float) -> Pantograph:
    """Add a bump stop, which pushes and does not pull.

    Args:
        pantograph: Linear model.
        direction: Closing of the stop per unknown, (n,) [-].
        gap: Closing from which the stop acts [m].
        stiffness, damping: Coefficients of the stop [N/m, N s/m].
    """
    joint = Joint(direction, stiffness, damping, gap)
    return replace(pantograph, joints=(*pantograph.joints, joint))
