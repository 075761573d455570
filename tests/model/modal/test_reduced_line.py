"""Derivatives of the modes of a line against central differences, and modes in the span of known modes."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import DAMPED, simple_line
from pantocheck.model import Catenary, Kind, discretise
from pantocheck.model.modal.modes import Modes, compute_modes, damping_ratios
from pantocheck.model.modal.reduced_line import NeighbouringLines, project_matrix, reduce_line, solve_reduced
from pantocheck.model.statics.assembly import assemble_matrices

STEP = 1e-3
COUNT = 12


def scale_tension(kind: Kind) -> Callable[[Catenary, float], Catenary]:
    def change(line: Catenary, factor: float) -> Catenary:
        scaled = (replace(w, tension=w.tension * factor) if w.kind is kind else w for w in line.wires)
        return replace(line, wires=tuple(scaled))

    return change


def scale_droppers(line: Catenary, factor: float) -> Catenary:
    droppers = (
        replace(d, stiffness=(d.stiffness or 0.0) * factor, lower_clamp_mass=0.2 * factor) for d in line.droppers
    )
    return replace(line, droppers=tuple(droppers))


CHANGES = (scale_tension(Kind.CONTACT_WIRE), scale_tension(Kind.MESSENGER_WIRE), scale_droppers)


def staggered_line() -> Catenary:
    """Three spans; arms are hinged bars, whose stiffness follows from the lateral force, thus from the tension.

    The messenger wire is held along the track, so that its sag at rest adds a stiffness.
    """
    line = simple_line(3, damping=DAMPED)
    contact, messenger = line.wires
    stagger = tuple((60.0 * number, 0.2 * (-1) ** number) for number in range(4))
    arms = tuple(replace(arm, vertical_stiffness=None, length=1.2) for arm in line.steady_arms)
    supports = tuple(replace(support, along_track="fixed") for support in line.messenger_supports)
    along = tuple((x, 0.0) for x, _ in stagger)
    wires = (replace(contact, stagger=stagger), replace(messenger, stagger=along, axial_stiffness=7e6))
    return replace(line, wires=wires, steady_arms=arms, messenger_supports=supports)


@pytest.fixture(scope="module", params=["plane", "staggered and held"])
def line(request: pytest.FixtureRequest) -> Catenary:
    return simple_line(3, damping=DAMPED) if request.param == "plane" else staggered_line()


def change_line(line: Catenary, number: int, factor: float) -> Catenary:
    return CHANGES[number](scale_droppers(line, 1.0), factor)


def compute(line: Catenary, number: int, factor: float, count: int = COUNT) -> Modes:
    return compute_modes(discretise(change_line(line, number, factor), 1.0), count)


def neighbours(line: Catenary) -> list[NeighbouringLines]:
    ends = [[discretise(change_line(line, n, 1 + sign * STEP), 1.0) for sign in (-1, 1)] for n in range(len(CHANGES))]
    return [NeighbouringLines(lower, upper, 2 * STEP) for lower, upper in ends]


def test_derivatives_of_eigenvalues_are_the_limit_of_central_differences(line: Catenary) -> None:
    """Central differences with steps h and h / 2 extrapolate to the limit; what remains is of the order of 1e-6."""
    mesh = discretise(change_line(line, 0, 1.0), 1.0)
    reduced = reduce_line(mesh, compute_modes(mesh, COUNT), neighbours(line))
    found, scale = solve_reduced(reduced, np.zeros(len(CHANGES))), reduced.eigenvalue[COUNT - 1]
    np.testing.assert_allclose(found.eigenvalue[:COUNT], reduced.eigenvalue[:COUNT], rtol=1e-9)
    for n in range(len(CHANGES)):
        coarse, fine = (
            np.subtract(*((2 * np.pi * compute(line, n, 1 + s * h).frequency) ** 2 for s in (1, -1))) / (2 * h)
            for h in (2e-3, 1e-3)
        )
        limit = fine + (fine - coarse) / 3
        np.testing.assert_allclose(found.eigenvalue_derivative[n, :COUNT], limit, atol=2e-6 * scale)
        assert np.abs(limit).max() > 0.003 * scale  # the change is seen


def test_derivatives_of_damping_ratios_and_modes_of_a_changed_line(line: Catenary) -> None:
    """Static responses complete the span of 40 modes: the derivatives agree to 2e-4, 40 modes alone to 0.4.

    A tension 2 % higher gives the eigenvalues of the line computed anew to 4e-6 of their change; to 5 % where the
    stiffness of held stretches falls with the square of the tension.
    """
    mesh = discretise(change_line(line, 0, 1.0), 1.0)
    modes = compute_modes(mesh, 40)
    pairs = neighbours(line)
    reduced = reduce_line(mesh, modes, pairs)
    vectors = reduced.vectors
    damping = project_matrix(vectors, assemble_matrices(mesh).damping)
    change = [
        project_matrix(vectors, (assemble_matrices(p.upper).damping - assemble_matrices(p.lower).damping) / p.distance)
        for p in pairs
    ]
    found = solve_reduced(reduced, np.zeros(len(CHANGES)))
    slope = found.form_derivative(damping, np.array(change))
    for n in range(len(CHANGES)):
        low, high = (discretise(change_line(line, n, 1 + s * STEP), 1.0) for s in (-1, 1))
        values = [4 * np.pi * m.frequency * damping_ratios(x, m) for x in (low, high) for m in [compute_modes(x, 8)]]
        difference = (values[1] - values[0]) / (2 * STEP)
        assert np.abs(slope[n, :8] - difference).max() < 0.001 * np.abs(difference).max()
    changed = solve_reduced(reduced, np.array([0.02, 0.0, 0.0]))
    exact = (2 * np.pi * compute(line, 0, 1.02, 8).frequency) ** 2
    moved = np.abs(exact - reduced.eigenvalue[:8]).max()
    held = line.messenger_supports[0].along_track == "fixed"
    assert np.abs(changed.eigenvalue[:8] - exact).max() < (0.06 if held else 1e-5) * moved
