"""Contact wires above a head: the lowest ones at rest."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import PANTOGRAPH_2002, overlapping_line, simple_line
from pantocheck.model import Passage, discretise
from pantocheck.model.description.failures import ImpossiblePassage
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.statics.contact_wires import touched_rows, touched_wires
from pantocheck.model.statics.elasticity import static_uplift


def test_head_touches_the_lowest_wire_in_an_overlap() -> None:
    """Overlap of one span, 60 m to 120 m: the wires cross in its middle."""
    line = discretise(overlapping_line(2), 1.0)
    assert [touched_wires(line, x).tolist() for x in (30.0, 61.0, 80.0, 89.0, 91.0, 119.0, 150.0)] == [
        [0], [0], [0], [0], [1], [1], [1]
    ]  # fmt: skip
    assert touched_rows(line, 80.0).tolist() == [line.mesh.row_of["section 1 contact", "z"]]


def test_parallel_wires_share_the_force_at_the_start() -> None:
    """Two equal wires: half of 120 N each, and the uplift of both together under half of the force each."""
    line = simple_line()
    contact, messenger = line.wires
    second = replace(contact, name="second")
    line = replace(
        line,
        wires=(contact, second, messenger),
        droppers=line.droppers + tuple(replace(dropper, lower="second") for dropper in line.droppers),
        steady_arms=line.steady_arms + tuple(replace(arm, wire="second") for arm in line.steady_arms),
    )
    built = discretise(line, 1.0)
    assert touched_wires(built, 31.0).tolist() == [0, 1]
    kernel = build_kernel_arrays(built, 1e-3)
    _, train = start_motion(built, kernel, Passage((PANTOGRAPH_2002,), (31.0,), 50.0, 1.0, 1e-3))
    np.testing.assert_array_equal(train.contact, [[60.0, 60.0]])
    np.testing.assert_array_equal(train.elapsed, [0.0])


def test_start_in_an_overlap_presses_on_the_lowest_wire() -> None:
    """At 80 m the incoming wire is raised by 0.13 m: the outgoing one carries all, and lies as without the other."""
    overlapping, alone = discretise(overlapping_line(2), 1.0), discretise(simple_line(2), 1.0)
    kernel = build_kernel_arrays(overlapping, 1e-3)
    _, train = start_motion(overlapping, kernel, Passage((PANTOGRAPH_2002,), (80.0,), 50.0, 1.0, 1e-3))
    np.testing.assert_array_equal(train.contact, [[120.0, 0.0]])
    # A line without overlap ends level; the anchor of the raised one has no influence on the uplift but the mesh.
    uplift = [static_uplift(line, np.array([80.0]), 120.0)[0] for line in (overlapping, alone)]
    assert uplift[0] == pytest.approx(uplift[1], rel=2e-3)


def test_start_without_a_contact_wire_is_refused() -> None:
    """The first wire of the line ends before the messenger wire."""
    line = simple_line()
    contact, messenger = line.wires
    short = replace(
        line,
        wires=(replace(contact, end=60.0), messenger),
        droppers=tuple(dropper for dropper in line.droppers if dropper.position < 60.0),
        steady_arms=(),
    )
    with pytest.raises(ImpossiblePassage, match="no contact wire at 80 m"):
        touched_wires(discretise(short, 1.0), 80.0)
