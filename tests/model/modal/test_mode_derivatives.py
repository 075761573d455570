"""Derivatives of the modes of a line against central differences, and the span in which they are taken."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import DAMPED, simple_line
from pantocheck.model import Catenary, Kind, discretise
from pantocheck.model.discretisation.discretised_line import with_properties
from pantocheck.model.modal.mode_derivatives import NeighbouringLines, derive_modes
from pantocheck.model.modal.modes import Modes, compute_modes, damping_forms, damping_ratios
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
    modes = compute_modes(mesh, COUNT)
    found, scale = derive_modes(mesh, modes, neighbours(line)), (2 * np.pi * modes.frequency[-1]) ** 2
    for n in range(len(CHANGES)):
        coarse, fine = (
            np.subtract(*((2 * np.pi * compute(line, n, 1 + s * h).frequency) ** 2 for s in (1, -1))) / (2 * h)
            for h in (2e-3, 1e-3)
        )
        limit = fine + (fine - coarse) / 3
        np.testing.assert_allclose(found.eigenvalue[n], limit, atol=2e-6 * scale)
        assert np.abs(limit).max() > 0.003 * scale  # the change is seen


def test_vectors_of_the_span_are_orthogonal_and_begin_with_the_modes(line: Catenary) -> None:
    """V M V' is the identity, and V K V' without held stretches diagonal: rounding of the solution of K, 1e-10."""
    mesh = discretise(change_line(line, 0, 1.0), 1.0)
    modes, matrices = compute_modes(mesh, COUNT), assemble_matrices(mesh)
    found = derive_modes(mesh, modes, neighbours(line))
    np.testing.assert_array_equal(found.span.shape[:COUNT], modes.shape)
    np.testing.assert_allclose(found.vectors @ matrices.mass @ found.vectors.T, np.eye(len(found.vectors)), atol=1e-10)
    assert np.all(found.span.frequency[COUNT:] > modes.frequency[-1])
    if not mesh.stretches.stiffness.size:
        square = (2 * np.pi * found.span.frequency) ** 2
        stiffness = found.vectors @ matrices.stiffness @ found.vectors.T
        np.testing.assert_allclose(stiffness / np.sqrt(np.outer(square, square)), np.eye(len(square)), atol=1e-8)


def test_derivatives_of_damping_ratios(line: Catenary) -> None:
    """Static responses complete the span of 40 modes: the derivatives agree to 2e-4, 40 modes alone to 0.4."""
    mesh = discretise(change_line(line, 0, 1.0), 1.0)
    modes, pairs = compute_modes(mesh, 40), neighbours(line)
    own = [
        np.subtract(*(damping_forms([each], modes.shape)[0] for each in (pair.upper, pair.lower))) / pair.distance
        for pair in pairs
    ]
    slope = derive_modes(mesh, modes, pairs).form_derivative(assemble_matrices(mesh).damping, np.array(own))
    for n in range(len(CHANGES)):
        low, high = (discretise(change_line(line, n, 1 + s * STEP), 1.0) for s in (-1, 1))
        values = [4 * np.pi * m.frequency * damping_ratios(x, m) for x in (low, high) for m in [compute_modes(x, 8)]]
        difference = (values[1] - values[0]) / (2 * STEP)
        assert np.abs(slope[n, :8] - difference).max() < 0.001 * np.abs(difference).max()


def test_line_with_other_properties_is_that_line(line: Catenary) -> None:
    """The mesh and the residual flexibility of unchanged wires are taken from the line; no bit differs."""
    mesh = discretise(change_line(line, 0, 1.0), 1.0)
    stiff = replace(line, wires=tuple(replace(w, bending_stiffness=2 * w.bending_stiffness) for w in line.wires))
    for changed in (stiff, *(change_line(line, number, 1.01) for number in range(len(CHANGES)))):
        taken, anew = with_properties(mesh, changed), discretise(changed, 1.0)
        for parts in ((taken.beams, anew.beams), (taken.connectors, anew.connectors)):
            for one, other in zip(*parts, strict=True):
                np.testing.assert_array_equal(one, other)
        np.testing.assert_array_equal(taken.state.deflection, anew.state.deflection)
