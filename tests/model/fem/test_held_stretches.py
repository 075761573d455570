"""Held stretches against Irvine's theory of the shallow cable and against dense matrices."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from helpers.lines import Array, fix_along_track, simple_line
from pantocheck.model import Catenary, DiscretisedLine, Kind, MessengerSupport, Wire, discretise
from pantocheck.model.description.catenary import GRAVITY, Termination
from pantocheck.model.modal.modes import compute_modes
from pantocheck.model.statics.assembly import (
    assemble_matrices,
    bandwidth_order,
    connector_directions,
    point_load,
    stretch_directions,
)
from pantocheck.model.statics.elasticity import static_uplift
from pantocheck.model.statics.static_solver import StaticSolver

SPAN, TENSION, MASS, AXIAL_STIFFNESS = 55.0, 8e3, 2.0, 13.8e6
PARAMETER = (MASS * GRAVITY * SPAN / TENSION) ** 2 * AXIAL_STIFFNESS / TENSION
"""Irvine's parameter of one span, about 31 [-]."""


def hanging_wire() -> DiscretisedLine:
    """A messenger wire alone over one span, pinned, without bending stiffness; its ends are fixed along the track."""
    wire = Wire("messenger", Kind.MESSENGER_WIRE, 0.0, SPAN, TENSION, MASS, 0.0)
    ends = tuple(MessengerSupport(x, "messenger", 1.0, 1e5) for x in (0.0, SPAN))
    return discretise(fix_along_track(Catenary((wire,), messenger_supports=ends), AXIAL_STIFFNESS), 0.5)


def irvine_frequency(parameter: float) -> float:
    """First symmetric frequency of a shallow cable, tan(q) = q - 4 q^3 / lambda^2 with 2 q = w L sqrt(m / T) [Hz]."""
    q = brentq(lambda q: np.sin(q) - (q - 4 * q**3 / parameter) * np.cos(q), np.pi / 2, 3 * np.pi / 2 - 1e-9)
    return float(2 * q / SPAN * np.sqrt(TENSION / MASS) / (2 * np.pi))


def full_stiffness(line: DiscretisedLine) -> tuple[Array, Array]:
    """Stiffness of the free unknowns with held stretches, which the simulator never forms, and the free unknowns."""
    matrices = assemble_matrices(line)
    direction = stretch_directions(line)[matrices.free].toarray()
    return matrices.stiffness.toarray() + (direction * line.stretches.stiffness) @ direction.T, matrices.free


def test_stretch_adds_8_lambda2_over_pi4_to_the_stiffness_of_a_half_wave() -> None:
    """Irvine's first-order result for the shape w = sin(pi x / L): EA/L (a'w)^2 over T pi^2 / 2L; elements: 1e-6."""
    line = hanging_wire()
    angle = np.pi * line.mesh.position / SPAN
    half_wave = np.stack([np.sin(angle), np.pi / SPAN * np.cos(angle)], axis=-1)
    (elongation,) = stretch_directions(line).T @ half_wave.ravel()
    growth = line.stretches.stiffness[0] * elongation**2 / (np.pi**2 * TENSION / (2 * SPAN))
    assert elongation < 0.0  # upwards the sag decreases
    assert growth == pytest.approx(8 * PARAMETER / np.pi**4, rel=1e-6)


def test_frequencies_of_a_span_are_those_of_a_shallow_cable() -> None:
    """Below cross-over, lambda^2 = 31 < 4 pi^2, the symmetric mode is the lowest; elements of 0.5 m: 1e-6.

    The antisymmetric modes are those of a string, for which the tension does not change to first order.
    """
    frequency = compute_modes(hanging_wire(), 2).frequency
    string = np.sqrt(TENSION / MASS) / (2 * SPAN)
    np.testing.assert_allclose(frequency, [irvine_frequency(PARAMETER), 2 * string], rtol=1e-6)
    assert frequency[0] > 1.8 * string


def test_frequencies_are_those_of_the_full_matrix() -> None:
    """A catenary of two spans; shift-invert with additional unknowns against a dense eigenvalue problem."""
    line = discretise(fix_along_track(simple_line()), 2.0)
    stiffness, _ = full_stiffness(line)
    squares = eigh(stiffness, assemble_matrices(line).mass.toarray(), eigvals_only=True, subset_by_index=[0, 11])
    np.testing.assert_allclose(compute_modes(line, 12).frequency, np.sqrt(squares) / (2 * np.pi), rtol=1e-8)


def test_deflection_is_that_of_the_full_matrix_also_with_slack_droppers() -> None:
    """Against dense solutions, with the tensions of the slack droppers removed; 1e-10 of deflections of 0.1 m."""
    line = discretise(fix_along_track(simple_line()), 2.0)
    stiffness, free = full_stiffness(line)
    load, directions = point_load(line, 0, 20.0), connector_directions(line)
    slack_droppers = []
    for force in (10.0, 400.0):
        deflection = StaticSolver(line).deflection(force * load)
        slack = deflection.slack
        directions_of_slack = directions[free][:, np.flatnonzero(slack)].toarray()
        without = stiffness - (directions_of_slack * line.connectors.stiffness[slack]) @ directions_of_slack.T
        expected = np.linalg.solve(without, force * load[free] + directions_of_slack @ line.connectors.preload[slack])
        flat = deflection.displacement.ravel()[bandwidth_order(line)[free]]
        np.testing.assert_allclose(flat, expected, rtol=0, atol=1e-10)
        slack_droppers.append(slack.sum())
    assert slack_droppers[0] == 0
    assert slack_droppers[1] >= 2


def test_fixed_supports_make_the_line_stiffer_and_free_ones_change_nothing() -> None:
    """The elasticity in mid-span decreases; a line with axial stiffness but free supports is bit-identical."""
    free = simple_line(spans=3)
    stiff = replace(fix_along_track(free), messenger_supports=free.messenger_supports)
    places = np.array([60.0, 90.0])
    elasticities = [static_uplift(discretise(c, 1.0), places, 1.0) for c in (free, stiff, fix_along_track(free))]
    np.testing.assert_array_equal(elasticities[1], elasticities[0])
    assert elasticities[2][1] < 0.95 * elasticities[0][1]
    assert discretise(stiff, 1.0).stretches.stiffness.size == 0


def test_one_fixed_support_holds_the_wire_there_and_at_its_anchors() -> None:
    line = simple_line(spans=4)
    supports = tuple(
        replace(s, along_track="fixed" if s.position == 120.0 else "free") for s in line.messenger_supports
    )
    fixed = replace(fix_along_track(line), messenger_supports=supports)
    stretches = discretise(fixed, 1.0).stretches
    np.testing.assert_allclose(stretches.stiffness, [13.8e6 / 120.0] * 2)


@pytest.mark.parametrize(
    ("terminations", "held"),
    [("WW", []), ("AW", [(0.0, 60.0)]), ("WA", [(60.0, 120.0)]), ("AA", [(0.0, 60.0), (60.0, 120.0)])],
)
def test_tension_is_constant_between_a_weight_and_the_next_fixed_support(
    terminations: str, held: list[tuple[float, float]]
) -> None:
    """Two spans of 60 m, fixed at the mast: a stretch up to each rigid anchor, none up to a weight."""
    ends = [{"W": Termination.WEIGHT, "A": Termination.ANCHOR}[letter] for letter in terminations]
    line = fix_along_track(simple_line())
    messenger = replace(line.wires[1], terminations=(ends[0], ends[1]))
    supports = tuple(replace(s, along_track="fixed" if s.position == 60.0 else "free") for s in line.messenger_supports)
    built = discretise(replace(line, wires=(line.wires[0], messenger), messenger_supports=supports), 2.0)
    limits = [(built.mesh.station(start), built.mesh.station(end)) for start, end in held]
    width = [int(np.flatnonzero(c.any(axis=(0, 2)))[-1]) for c in built.stretches.coefficient]
    assert [(first, first + w) for first, w in zip(built.stretches.first.tolist(), width, strict=True)] == limits


def test_rigid_anchors_hold_a_wire_without_fixed_support() -> None:
    """One stretch from end to end, of EA over 120 m."""
    line = fix_along_track(simple_line())
    messenger = replace(line.wires[1], terminations=(Termination.ANCHOR, Termination.ANCHOR))
    supports = tuple(replace(s, along_track="free") for s in line.messenger_supports)
    built = discretise(replace(line, wires=(line.wires[0], messenger), messenger_supports=supports), 2.0)
    assert built.stretches.stiffness.tolist() == [13.8e6 / 120.0]


def test_fixed_support_needs_the_axial_stiffness_of_its_wire() -> None:
    line = simple_line()
    fixed = replace(line, messenger_supports=fix_along_track(line).messenger_supports)
    with pytest.raises(ValueError, match=r"wire 'messenger' is fixed along the track.*give Wire\.axial_stiffness"):
        discretise(fixed, 1.0)
