"""Elasticity of a line, and the contact wires that share a force at the pantograph head."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.lines import PANTOGRAPH_2002, overlapping_line, simple_line
from pantocheck.model import Catenary, Irregularity, Kind, Passage, Wire, discretise
from pantocheck.model.description.failures import ImpossiblePassage
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.statics.contact_wires import touched_rows, touched_wires
from pantocheck.model.statics.elasticity import height_under_forces, non_uniformity, rest_height, static_uplift

SPAN, FORCE = 60.0, 200.0


@pytest.mark.parametrize("tensions", [(10e3,), (10e3, 10e3), (10e3, 20e3), (20e3, 10e3), (8e3, 12e3, 24e3)])
def test_uplift_is_the_mean_of_contact_wires_with_equal_shares(tensions: tuple[float, ...]) -> None:
    """Pinned wires without droppers: a share P of the force lifts a string by P x (L - x) / (T L).

    Bending rounds the peak by sqrt(EI / T) / 2, at most 0.08 m against x (L - x) / L of at least 11 m: 0.7 %.
    """
    names = [f"contact {number}" for number in range(len(tensions))]
    wires = (Wire(name, Kind.CONTACT_WIRE, 0.0, SPAN, t, 1.35, 195.0) for name, t in zip(names, tensions, strict=True))
    line = discretise(Catenary(tuple(wires)), 1.0)
    position = np.array([15.0, 30.0, 40.0])
    flexibility = position * (SPAN - position) / SPAN * np.mean([1 / tension for tension in tensions])
    assert_allclose(static_uplift(line, position, FORCE), FORCE / len(tensions) * flexibility, rtol=0.01)


@pytest.mark.parametrize("element", [1.0, 4.0])
def test_height_at_rest_is_the_mean_parabola_of_the_wires(element: float) -> None:
    """A string sags by m g x (L - x) / (2 T), less bending, m g EI / T^2 = 3e-5 m or less; the wires are averaged."""
    tensions = (10e3, 20e3)
    wires = (Wire(f"contact {t}", Kind.CONTACT_WIRE, 0.0, SPAN, t, 1.35, 195.0) for t in tensions)
    line = discretise(Catenary(tuple(wires)), element)
    position = np.array([14.3, 30.0, 41.7])
    sag = 1.35 * 9.81 * position * (SPAN - position) / 2 * np.mean([1 / t for t in tensions])
    assert_allclose(rest_height(line, position), -sag, rtol=0, atol=3e-5)


def test_height_at_rest_contains_the_irregularity_of_the_wire() -> None:
    """Parallel wires with irregularities of 4 mm and 2 mm at a point: 3 mm in the mean; zero at the other points."""
    heights = ((0.0, 0.004, 0.0), (0.0, 0.002, 0.0))
    wires = tuple(
        Wire(
            f"contact {i}",
            Kind.CONTACT_WIRE,
            0.0,
            SPAN,
            20e3,
            1.35,
            195.0,
            irregularity=Irregularity((0.0, 20.0, 40.0), h),
        )
        for i, h in enumerate(heights)
    )
    level = tuple(replace(wire, irregularity=None) for wire in wires)
    position = np.array([20.0, 40.0])
    rough, smooth = (rest_height(discretise(Catenary(parts), 1.0), position) for parts in (wires, level))
    assert_allclose(rough - smooth, [0.003, 0.0], rtol=0, atol=1e-12)


def test_height_under_one_force_is_its_uplift_above_the_wire_at_rest() -> None:
    """A wire of 60 m, in mid-span: sag m g L^2 / 8 T at rest, less by l^2 m g / T with l = sqrt(EI / T): 1e-5."""
    line = discretise(Catenary((Wire("contact", Kind.CONTACT_WIRE, 0.0, SPAN, 20e3, 1.35, 195.0),)), 1.0)
    middle = np.array([SPAN / 2])
    sag = 1.35 * 9.81 * (SPAN**2 / 8 - 195.0 / 20e3) / 20e3
    height = height_under_forces(line, middle, np.array([FORCE]))
    assert_allclose(height, static_uplift(line, middle, FORCE) - sag, rtol=0, atol=1e-9)


def test_forces_that_act_together_lift_each_other() -> None:
    """A string under P at x lifts a point at a > x by P x (L - a) / (T L); the wires share the forces equally."""
    names = ("left", "right")
    wires = tuple(Wire(name, Kind.CONTACT_WIRE, 0.0, SPAN, 10e3, 0.7, 100.0) for name in names)
    line, position, force = discretise(Catenary(wires), 1.0), np.array([40.0, 15.0]), np.array([150.0, 120.0])
    rest, both = (height_under_forces(line, position, f) for f in (0 * force, force))
    own = [float(static_uplift(line, position[[k]], float(force[k]))[0]) for k in range(2)]
    other = 15.0 * (SPAN - 40.0) / (20e3 * SPAN) * force[::-1]
    # Bending lies within 1e-9 of the string 25 m away from a force.
    assert_allclose(both - rest, own + other, rtol=0, atol=1e-8)


def test_non_uniformity_by_hand() -> None:
    assert non_uniformity(np.array([0.4, 0.2, 0.6])) == pytest.approx(0.5)
    assert non_uniformity(np.array([0.3, 0.3])) == 0


def test_elasticity_of_coarse_elements_is_that_of_fine_elements() -> None:
    """A span with droppers, elements of 0.5 m and of an eighth: 2.4e-4; without residual flexibility 4e-3."""
    position = np.linspace(60.0, 120.0, 41) + 0.13
    coarse, fine = (static_uplift(discretise(simple_line(3), element), position, 1.0) for element in (0.5, 0.0625))
    assert_allclose(coarse, fine, rtol=3e-4)


# Contact wires above a head: the lowest ones at rest.
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
