"""String statics: closed forms, and beams of very small bending stiffness."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import simple_line
from pantocheck.model import Catenary, Clamp, Dropper, Kind, MessengerSupport, TensionChange, Wire, discretise
from pantocheck.model.description.catenary import GRAVITY
from pantocheck.model.discretisation.string_statics import compute_string_state


def test_string_state_of_a_messenger_with_one_dropper_is_the_closed_form() -> None:
    """A parabola of its own weight and a triangle of the dropper's force: w = (m g L^2 / 8 + N L / 4) / T, exactly."""
    length, upper, lower = 60.0, 16e3, 20e3
    line = Catenary(
        wires=(
            Wire("contact", Kind.CONTACT_WIRE, 0.0, length, lower, 1.35, 195.0),
            Wire("messenger", Kind.MESSENGER_WIRE, 0.0, length, upper, 1.07, 131.7),
        ),
        droppers=(Dropper(length / 2, "messenger", "contact", stiffness=1e5),),
        messenger_supports=tuple(MessengerSupport(x, "messenger", 1.2, 5e4) for x in (0.0, length)),
    )
    state = compute_string_state(line)
    tension = GRAVITY * 1.35 * length / 2
    assert state.dropper_tension == pytest.approx([tension], rel=1e-12)
    sag = (GRAVITY * 1.07 * length**2 / 8 + tension * length / 4) / upper
    assert state.dropper_length == pytest.approx([1.2 - sag], rel=1e-12)


def test_beams_of_small_bending_stiffness_approach_strings() -> None:
    """With EI = 1e-3 N m2 every kink is rounded over an element: the difference halves with its length."""
    catenary = simple_line(3)
    limp = replace(catenary, wires=tuple(replace(wire, bending_stiffness=1e-3) for wire in catenary.wires))
    strings = compute_string_state(catenary).dropper_length
    error = [np.abs(discretise(limp, h).state.dropper_length - strings).max() for h in (0.2, 0.1, 0.05)]
    assert error[0] / error[1] == pytest.approx(2.0, rel=0.1)
    assert error[1] / error[2] == pytest.approx(2.0, rel=0.1)
    assert error[2] < 4e-4


def test_string_state_balances_a_stitched_messenger_at_its_clamps() -> None:
    """The two clamps of a stitch wire hold it and its droppers; between them the messenger has less tension."""
    half, span = 9.0, 60.0
    supports, end = (span, 2 * span), 3 * span
    base = simple_line(3, droppers=(5.0, 17.0, 30.0, 43.0, 55.0))
    messenger = replace(
        next(wire for wire in base.wires if wire.kind is Kind.MESSENGER_WIRE),
        tension_changes=tuple(TensionChange(x - half, x + half, -3500.0) for x in supports),
    )
    stitches = tuple(Wire(f"stitch {x:g}", Kind.STITCH_WIRE, x - half, x + half, 3500.0, 0.31, 11.2) for x in supports)
    droppers = tuple(
        replace(d, upper=next((f"stitch {x:g}" for x in supports if abs(d.position - x) < half), d.upper))
        for d in base.droppers
    )
    clamps = tuple(Clamp(place, "messenger", f"stitch {x:g}", 0.38) for x in supports for place in (x - half, x + half))
    line = replace(base, wires=(base.wires[0], messenger, *stitches), droppers=droppers, clamps=clamps)
    state = compute_string_state(line)
    hung = {d.position: n for d, n in zip(droppers, state.dropper_tension, strict=True)}
    carried = hung[55.0] + hung[65.0] + GRAVITY * 0.31 * 2 * half
    assert state.clamp_force[:2, 1].sum() == pytest.approx(carried, rel=1e-9)
    assert (state.clamp_force[:, 1] > 0).all()
    beams = discretise(line, 0.25)
    relieved = beams.beams.tension[beams.mesh.row_of["messenger", "z"]]
    middle = beams.mesh.position[:-1] + np.diff(beams.mesh.position) / 2
    inside = np.abs(middle[:, None] - np.array(supports)).min(axis=1) < half
    assert set(relieved[inside]) == {16e3 - 3500.0}
    assert set(relieved[~inside]) == {16e3}
    assert end == beams.mesh.position[-1]
