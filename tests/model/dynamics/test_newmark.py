"""Time step of the kernel against an independent implementation with full matrices."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba.core.runtime import rtsys
from numba.core.runtime._nrt_python import memsys_enable_stats

from helpers.lines import DAMPED, PANTOGRAPH_2002, bare_wire, fix_along_track, overlapping_line, simple_line, twin_line
from helpers.step_differences import THREE_MASSES, largest_differences
from pantocheck.model import Catenary, Kind, Passage, Rayleigh, build_chain
from pantocheck.model.description.pantograph import Pantograph
from pantocheck.model.discretisation.discretised_line import discretise
from pantocheck.model.dynamics.active_window import build_window_arrays
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.dynamics.recording import allocate_recording, simulate_steps
from pantocheck.model.dynamics.simulation import start_motion


def test_step_equals_the_plain_implementation_through_slack_droppers_and_lost_contact() -> None:
    """To 1e-9 over 400 steps of 2 ms: sweeps stop at changes of 1e-9 N of about 300 N, which 400 steps may add up.

    The motion is violent on purpose: heads start downwards at 1.5 m/s, two different pantographs close together at
    110 m/s, every component damped, dampers at arms and supports, masses at clamps and arms.
    """
    catenary = simple_line(spans=2, span=50.0, droppers=(5.0, 15.0, 25.0, 35.0, 45.0), damping=DAMPED)
    catenary = replace(
        catenary,
        droppers=tuple(replace(d, mass=0.2, upper_clamp_mass=0.1, lower_clamp_mass=0.3) for d in catenary.droppers),
        steady_arms=tuple(replace(arm, mass=0.8, vertical_damper=30.0) for arm in catenary.steady_arms),
        messenger_supports=tuple(replace(support, damping=1000.0) for support in catenary.messenger_supports),
    )
    passage = Passage((PANTOGRAPH_2002, THREE_MASSES), (12.0, 4.0), 100.0, 0.8, 2e-3)
    difference, tension, contact, _ = largest_differences(discretise(catenary, 2.5), passage, 400, drop=1.5)
    slack, lost = tension == 0.0, contact == 0.0
    assert (slack.any(axis=0) & ~slack.all(axis=0)).sum() >= 5  # droppers slacken and tighten
    assert (np.diff(lost.astype(int), axis=0) == 1).any(axis=0).all()  # each pantograph loses contact
    assert (np.diff(lost.astype(int), axis=0) == -1).any(axis=0).all()  # and regains it
    assert max(difference.values()) < 1e-9, difference


@pytest.mark.parametrize("changes", [{"contact_stiffness": np.inf}, {"contact_damping": 60.0}])
def test_step_equals_the_plain_implementation_with_other_contact_laws(changes: dict[str, float]) -> None:
    """A constraint, and a damper beside the spring, through lost contact; to 1e-9 as above.

    A constraint is a hundred times as stiff, so that 1e-9 N change the force of the next step by ten times as much.
    """
    line = discretise(simple_line(spans=2, span=50.0, droppers=(5.0, 25.0, 45.0), damping=DAMPED), 2.5)
    pantographs = (replace(PANTOGRAPH_2002, **changes), replace(THREE_MASSES, **changes))
    passage = Passage(pantographs, (12.0, 4.0), 100.0, 0.6, 2e-3)
    difference, _, contact, _ = largest_differences(line, passage, 300, drop=1.5)
    assert (np.diff((contact == 0.0).astype(int), axis=0) != 0).any(axis=0).all()  # each loses or regains contact
    assert max(difference.values()) < 1e-8, difference


def test_step_equals_the_plain_implementation_remove_connectors() -> None:
    """A bare wire under one pantograph: the arrays of the connectors are empty."""
    passage = Passage((PANTOGRAPH_2002,), (10.0,), 60.0, 0.2, 1e-3)
    difference, _, _, _ = largest_differences(discretise(bare_wire(40.0), 1.0), passage, 200, drop=0.5)
    assert max(difference.values()) < 1e-9, difference


def zigzag_line(share: float) -> Catenary:
    """Line with a zigzag of 0.2 m on hinged arms; the messenger wire has this share of the stagger."""
    catenary = simple_line(spans=3, span=40.0, droppers=(5.0, 15.0, 25.0, 35.0), damping=DAMPED)
    contact, messenger = catenary.wires
    zigzag = ((0.0, 0.2), (40.0, -0.2), (80.0, 0.2), (120.0, -0.2))
    return replace(
        catenary,
        wires=(replace(contact, stagger=zigzag), replace(messenger, stagger=tuple((x, share * y) for x, y in zigzag))),
        steady_arms=tuple(replace(arm, vertical_stiffness=None, length=1.2, mass=0.7) for arm in catenary.steady_arms),
    )


def test_step_equals_the_plain_implementation_with_a_lateral_field() -> None:
    """A zigzag of 0.2 m on hinged arms: inclined droppers and arms couple the fields; rigid bars: 1e-8."""
    passage = Passage((PANTOGRAPH_2002,), (24.0,), 80.0, 0.6, 2e-3)
    line = discretise(zigzag_line(0.0), 5.0)
    assert np.abs(line.state.arm_force[:, 0]).min() > 100.0
    difference, tension, _, _ = largest_differences(line, passage, 300, drop=1.0)
    assert (tension[:, line.connectors.unilateral] == 0.0).any()
    assert max(difference.values()) < 1e-8, difference


def test_step_equals_the_plain_implementation_with_held_stretches() -> None:
    """A zigzag on a messenger wire that is fixed along the track at both supports: full matrices of rank three more.

    The sag of this messenger, 0.4 m with droppers, and ten times the axial stiffness of a bar make the term as large as
    the stiffness of the wires; rigid arms as above: 1e-8.
    """
    passage = Passage((PANTOGRAPH_2002,), (24.0,), 80.0, 0.6, 2e-3)
    free, fixed = (discretise(line, 5.0) for line in (zigzag_line(-1.0), fix_along_track(zigzag_line(-1.0), 13.8e7)))
    difference, tension, contact_force, _ = largest_differences(fixed, passage, 300, drop=1.0)
    assert (tension[:, fixed.connectors.unilateral] == 0.0).any()
    assert max(difference.values()) < 1e-8, difference
    _, _, without, _ = largest_differences(free, passage, 300, drop=1.0)
    assert np.abs(contact_force - without).max() > 5.0


def test_step_equals_the_plain_implementation_under_twin_line() -> None:
    """Parallel contact wires of different tension: each head presses on both and may lose either."""
    passage = Passage((PANTOGRAPH_2002, THREE_MASSES), (24.0, 12.0), 80.0, 0.4, 2e-3)
    difference, _, contact_force, _ = largest_differences(discretise(twin_line(), 5.0), passage, 200, drop=1.0)
    assert contact_force.shape[1] == 4
    lost = contact_force == 0.0
    assert (lost[:, 0::2] != lost[:, 1::2]).any()
    assert max(difference.values()) < 1e-9, difference


def test_step_equals_the_plain_implementation_through_an_overlap() -> None:
    """Two heads change from wire to wire, and a third wire shares the row of the first; tolerance as above.

    The wires cross in the middle of the overlap from 80 m to 120 m. The first wire ends only 0.15 m higher, so that the
    second head, which starts upwards at 2 m/s, still presses on it there.
    """
    section = simple_line(spans=3, span=40.0, droppers=(5.0, 15.0, 25.0, 35.0), damping=DAMPED)
    catenary = overlapping_line(sections=3, spans=3, overlap=1, rise=0.15, section=section)
    line = discretise(catenary, 5.0)
    rows = [line.mesh.row_of[wire.name, "z"] for wire in catenary.contact_wires]
    assert rows[0] == rows[2] != rows[1]
    passage = Passage((PANTOGRAPH_2002, THREE_MASSES), (86.0, 74.0), 90.0, 0.6, 2e-3)
    difference, tension, contact, _ = largest_differences(line, passage, 300, drop=-2.0)
    assert max(difference.values()) < 1e-9, difference
    assert (tension == 0.0).any()
    place = np.array(passage.start) + passage.speed * passage.time_step * np.arange(1, 301)[:, None]
    for p in range(2):
        first, second, third = contact[:, 3 * p : 3 * p + 3].T
        assert ((first > 0) & (second > 0)).any()
        assert first[place[:, p] > 120.0].max() == 0.0
        print("END", first[(place[:, p] > 112)][:20].round(1), second[place[:, p] < 88][:15].round(1), place[0])
        assert second[place[:, p] <= 80.0].max(initial=0.0) == 0.0
        assert third.max() == 0.0
    at_end = (place[:, 1] > 115.0) & (place[:, 1] <= 120.0)
    assert contact[at_end, 3].max() > 50.0


damping_coefficients = st.builds(Rayleigh, st.floats(0.0, 0.5), st.floats(0.0, 2e-3))


@st.composite
def small_lines(draw: st.DrawFn) -> Catenary:
    """One or two spans with droppers at any even position, stiff and soft, heavy and light, with any damping.

    Of droppers 1 m apart beside a long field, one would have to push: such a line has no state at rest.
    """
    spans = draw(st.integers(1, 2))
    places = sorted(draw(st.sets(st.integers(1, 14), min_size=1, max_size=4)))
    damping = {kind: draw(damping_coefficients) for kind in Kind}
    line = simple_line(
        spans,
        30.0,
        tuple(2.0 * place for place in places),
        damping,
        dropper_stiffness=draw(st.sampled_from([1e3, 1e5, 3e6])),
    )
    mass, damper = draw(st.floats(0.0, 2.0)), draw(st.floats(0.0, 500.0))
    return replace(
        line,
        droppers=tuple(replace(d, mass=mass) for d in line.droppers),
        steady_arms=tuple(replace(arm, mass=mass, vertical_damper=damper) for arm in line.steady_arms),
        messenger_supports=tuple(replace(support, damping=damper) for support in line.messenger_supports),
    )


@st.composite
def pantographs(draw: st.DrawFn) -> Pantograph:
    """A chain of one to three masses."""
    n = draw(st.integers(1, 3))
    masses, stiffness, damping = (
        np.array(draw(st.lists(st.floats(low, high), min_size=n, max_size=n)))
        for low, high in ((2.0, 20.0), (50.0, 2e4), (0.0, 100.0))
    )
    return build_chain(
        masses, stiffness, damping, draw(st.floats(20.0, 300.0)), 0, draw(st.sampled_from([5e3, 5e4, 2e5]))
    )


@settings(max_examples=8)
@given(small_lines(), st.lists(pantographs(), min_size=1, max_size=2), st.floats(10.0, 110.0), st.floats(0.0, 2.0))
def test_step_equals_the_plain_implementation_on_any_small_line(
    catenary: Catenary, several: list[Pantograph], speed: float, drop: float
) -> None:
    """Random lines over 60 steps, to 1e-9 of the size of the motion: 1e-7 N of the forces, 1e-11 m of a deflection."""
    passage = Passage(tuple(several), (12.0, 4.0)[: len(several)], speed, 0.12, 2e-3)
    difference, _, _, _ = largest_differences(discretise(catenary, 2.0), passage, 60, drop)
    assert max(difference.values()) < 1e-9, difference


def test_a_step_allocates_no_memory() -> None:
    """A call allocates one record per array, whatever its number of steps: 10 steps as many as 400 through an overlap.

    The window is smaller than the line, and the head changes to the wire of the second section.
    """
    line = discretise(overlapping_line(3, 3, section=simple_line(3, damping=DAMPED)), 2.0)
    passage = Passage((PANTOGRAPH_2002,), (140.0,), 60.0, 0.8, 2e-3, kept_behind=60.0)
    kernel = build_kernel_arrays(line, passage.time_step, build_window_arrays(line, passage))
    motion, train = start_motion(line, kernel, passage)
    memsys_enable_stats()
    allocated = []
    for steps in (10, 10, 400):
        recording = allocate_recording(line, (("section 2 contact", 180.0),), steps, 1)
        before = rtsys.get_allocation_stats().alloc
        simulate_steps(kernel, motion, train, np.zeros(steps), recording)
        allocated.append(rtsys.get_allocation_stats().alloc - before)
    assert train.contact[0, 0] == 0.0 < train.contact[0, 1]
    assert allocated[1] == allocated[2]
