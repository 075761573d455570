"""Responses to unit forces by selected inversion, against the solution for each force."""

import gc
import weakref

import numpy as np
import pytest

from helpers.lines import fix_along_track, simple_line
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.model import Catenary, discretise
from pantocheck.model.statics.assembly import connector_directions
from pantocheck.model.statics.elasticity import static_uplift
from pantocheck.model.statics.unit_responses import compute_unit_responses, factored_stiffness, invert_blocks


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
