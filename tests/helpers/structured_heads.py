"""Heads with strips, rotations, bending, friction and stops, and a line with a stagger for them."""

from dataclasses import replace

import numpy as np

from helpers.lines import DAMPED, simple_line
from pantocheck.model.description.head_structure import (
    MountedStrip,
    Rotation,
    add_bending_mode,
    add_friction,
    add_roll,
    add_stop,
    mount_strips,
)
from pantocheck.model.description.pantograph import Pantograph
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, discretise

TWO_STRIPS = (MountedStrip(0.3, 3.0, 5000.0, 20.0), MountedStrip(-0.28, 3.0, 6000.0, 15.0))


def structured(base: Pantograph) -> Pantograph:
    """Two strips, pitch, roll and a bending mode, friction in the head suspension, stops of both directions."""
    model = mount_strips(base, TWO_STRIPS, Rotation(0.8, 40.0, 3.0))
    model = add_roll(model, Rotation(2.0, 300.0, 5.0))
    model = add_bending_mode(model, 31.0, 0.02, [(0.3, 0.0, -0.8), (0.3, 0.1)])
    suspension = np.eye(model.head.size)[1] - np.eye(model.head.size)[0]
    model = add_friction(model, suspension, 12.0, 2e-3)
    model = add_stop(model, suspension, 0.01, 2e4, 30.0)
    return add_stop(model, -suspension, 0.03, 2e4, 0.0)


def zigzag_line() -> DiscretisedLine:
    catenary = simple_line(spans=3, span=40.0, droppers=(5.0, 15.0, 25.0, 35.0), damping=DAMPED)
    contact, messenger = catenary.wires
    stagger = ((0.0, 0.2), (40.0, -0.2), (80.0, 0.2), (120.0, -0.2))
    arms = tuple(replace(arm, vertical_stiffness=None, length=1.2, mass=0.7) for arm in catenary.steady_arms)
    wires = (replace(contact, stagger=stagger), replace(messenger, stagger=tuple((x, 0.0) for x, _ in stagger)))
    return discretise(replace(catenary, wires=wires, steady_arms=arms), 5.0)
