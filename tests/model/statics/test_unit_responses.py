"""Factored stiffness of a line against a general solver, and its responses to unit forces against single solutions."""

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

from helpers.lines import fix_along_track, simple_line
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.model import Catenary, DiscretisedLine, discretise
from pantocheck.model.description.failures import NoEquilibrium
from pantocheck.model.statics.assembly import assemble_matrices, connector_directions, stretch_directions
from pantocheck.model.statics.elasticity import static_uplift
from pantocheck.model.statics.unit_responses import (
    LineStiffness,
    compute_unit_responses,
    factored_stiffness,
    invert_blocks,
)


def stitched_line() -> Catenary:
    """Three spans with stagger, stitch wires and their clamps."""
    (case,) = select_cases(["en50318-2018/ac-stitched/static"])
    return build_catenary(case.line.shorten(3))


@pytest.mark.parametrize(
    "catenary", [simple_line(3), simple_line(14), stitched_line(), fix_along_track(simple_line(3))]
)
def test_responses_are_those_of_a_solution_for_each_force(catenary: Catenary) -> None:
    """Forces and moments in some elements, the first and the last included: to 1e-10 of the largest response.

    The conditioning limits the accuracy, as for the solution itself. The forces in a line of 14 spans overlap in part.
    """
    line = discretise(catenary, 1.0)
    stations = line.mesh.position.size
    element = np.array([0, 1, stations // 3, stations // 2, stations // 2, stations - 2])
    share = np.random.default_rng(2).standard_normal((element.size, 2, 2 * line.mesh.rows))
    force = np.zeros((element.size, stations, 2 * line.mesh.rows))
    for n, first in enumerate(element):
        force[n, first : first + 2] = share[n]
    moved = factored_stiffness(line).solve(force.reshape(element.size, -1).T)
    elongation = moved.T @ connector_directions(line).toarray()
    responses = compute_unit_responses(invert_blocks(line), element, share)
    flexibility = np.einsum("nu,un->n", force.reshape(element.size, -1), moved)
    np.testing.assert_allclose(responses.flexibility, flexibility, rtol=1e-10)
    found = np.zeros_like(elongation)
    found[:, responses.connectors] = responses.elongation
    np.testing.assert_allclose(found, elongation, rtol=0, atol=1e-10 * np.abs(elongation).max())


def test_response_ends_where_it_lies_below_rounding() -> None:
    """A force in the middle of 60 spans moves the droppers of 30 or fewer by more than rounding."""
    line = discretise(simple_line(60), 1.0)
    middle = np.array([line.mesh.position.size // 2])
    share = np.zeros((1, 2, 2 * line.mesh.rows))
    share[0, 0, 0] = 1.0
    assert (
        0
        < compute_unit_responses(invert_blocks(line), middle, share).connectors.size
        < line.connectors.station.size / 2
    )


def test_memory_of_a_line_is_free_when_it_is_no_longer_used() -> None:
    """A campaign builds thousands of lines; arrays in a cycle of references wait for a search for unused objects."""
    line = discretise(simple_line(2), 2.0)
    static_uplift(line, np.array([70.0, 90.0]), 400.0)
    known = weakref.ref(line)
    gc.disable()
    try:
        del line
        assert known() is None
    finally:
        gc.enable()


# Factored stiffness of a line against a general sparse solver, with stagger, stitch wires and held stretches.
def general_solution(line: DiscretisedLine, force: np.ndarray) -> np.ndarray:
    """Displacements by a general sparse solver; the additional tension of every stretch is an unknown of its own."""
    matrices = assemble_matrices(line)
    direction = sp.csc_array(stretch_directions(line)[matrices.free])
    flexibility = sp.diags_array(-1 / line.stretches.stiffness, format="csc")
    whole = sp.block_array([[matrices.stiffness, direction], [direction.T, flexibility]], format="csc")
    full = np.zeros_like(force)
    solution = spsolve(whole, np.concatenate([force[matrices.free], np.zeros((direction.shape[1], force.shape[1]))]))
    full[matrices.free] = solution[: matrices.free.size]
    return full


@pytest.mark.parametrize("catenary", [simple_line(3), stitched_line(), fix_along_track(simple_line(3))])
def test_displacements_are_those_of_a_general_solver(catenary: Catenary) -> None:
    """Forces and moments on all unknowns, two load cases: to 1e-10 of the largest displacement, the conditioning."""
    line = discretise(catenary, 1.0)
    force = np.random.default_rng(1).standard_normal((line.beams.free.size, 2))
    expected, stiffness = general_solution(line, force), factored_stiffness(line)
    size = np.abs(expected).max()
    np.testing.assert_allclose(stiffness.solve(force), expected, rtol=0, atol=1e-10 * size)
    np.testing.assert_allclose(stiffness.solve(force[:, 1]), expected[:, 1], rtol=0, atol=1e-10 * size)


def test_factor_is_built_once_per_line() -> None:
    line = discretise(simple_line(2), 2.0)
    assert factored_stiffness(line) is factored_stiffness(line)
    assert factored_stiffness(replace(line)) is not factored_stiffness(line)


def test_unstable_line_has_no_equilibrium() -> None:
    """A negative spring of 1 MN/m at a support is larger than the stiffness of the wires, about 1e4 N/m."""
    line = discretise(simple_line(2), 2.0)
    springs = line.beams.lumped_stiffness.copy()
    springs[0, line.mesh.station(60.0)] = -1e6
    with pytest.raises(NoEquilibrium, match=r"^the line at rest is not stable"):
        LineStiffness(replace(line, beams=line.beams._replace(lumped_stiffness=springs)))
