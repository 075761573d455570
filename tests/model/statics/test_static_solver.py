"""Static solver: superposition with taut droppers, slack droppers against a convex minimisation, elasticity."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import nnls

from helpers.lines import Array, simple_line
from pantocheck.model.discretisation.discretised_line import discretise
from pantocheck.model.dynamics.reference_kernel import remove_connectors
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order, connector_directions, point_load
from pantocheck.model.statics.static_solver import StaticSolver
from pantocheck.model.statics.unit_responses import UnitResponses, compute_unit_responses, invert_blocks

LINE = discretise(simple_line(spans=3), 1.0)
STATICS = StaticSolver(LINE)
ROWS = assemble_matrices(remove_connectors(LINE))
FREE, COMPLIANCE = ROWS.free, np.linalg.inv(ROWS.stiffness.toarray())
BARS = connector_directions(LINE)[FREE].toarray()


def respond(direction: Array) -> UnitResponses:
    """Response to nodal forces inside one element."""
    blocks = direction.reshape(LINE.mesh.position.size, -1)
    element = np.flatnonzero(blocks.any(axis=1))[:1]
    return compute_unit_responses(invert_blocks(LINE), element, blocks[None, [*element, *(element + 1)]])


def tensions_by_minimisation(load: Array) -> tuple[Array, Array]:
    """Displacement and dropper tensions by the principle of least complementary energy, a convex problem.

    With the rows' compliance S = K^-1, the tensions N >= 0 minimise N'(B'SB + 1/k)N / 2 - N'(N0/k + B'S(f + B N0)):
    a non-negative least-squares problem after a Cholesky decomposition, without a guess of the active set.
    """
    stiffness, preload = LINE.connectors.stiffness, LINE.connectors.preload
    pulled = COMPLIANCE @ (load[FREE] + BARS @ preload)
    root = cholesky(BARS.T @ COMPLIANCE @ BARS + np.diag(1 / stiffness))
    tension, _ = nnls(root, solve_triangular(root, preload / stiffness + BARS.T @ pulled, trans="T"))
    full = np.zeros(load.size)
    full[bandwidth_order(LINE)[FREE]] = pulled - COMPLIANCE @ (BARS @ tension)
    return full.reshape(LINE.beams.free.shape), tension


def test_deflections_with_taut_droppers_superpose() -> None:
    """Small loads slacken no dropper: the deflection of the sum is the sum of the deflections, to rounding."""
    first, second = 10.0 * point_load(LINE, 0, 73.3), -25.0 * point_load(LINE, 1, 111.0)
    deflections = [STATICS.deflection(load) for load in (first, second, first + second)]
    assert not any(deflection.slack.any() for deflection in deflections)
    summed = deflections[0].displacement + deflections[1].displacement
    np.testing.assert_allclose(deflections[2].displacement, summed, rtol=0, atol=1e-12)


def test_deflection_grows_more_than_proportionally_with_slack_droppers() -> None:
    """800 N slacken several droppers: the uplift is a tenth larger than eighty times that of 10 N."""
    lift = [STATICS.deflection(force * point_load(LINE, 0, 90.0)) for force in (10.0, 800.0)]
    station = LINE.mesh.station(90.0)
    assert not lift[0].slack.any()
    assert lift[1].slack.sum() >= 3
    assert lift[1].displacement[0, station, 0] > 1.1 * 80 * lift[0].displacement[0, station, 0]


def test_dropper_slackens_at_zero_tension() -> None:
    """The first dropper is taut with half a newton left, and slack with a force that would compress it by as much."""
    direction = point_load(LINE, 0, 90.0)
    response = respond(direction)
    per_newton = np.zeros(LINE.connectors.station.size)
    per_newton[response.connectors] = response.elongation[0]
    per_newton *= LINE.connectors.stiffness
    relieved = np.flatnonzero(LINE.connectors.unilateral & (per_newton < 0))
    for left, slack in ((0.5, 0), (-0.5, 1)):
        force = ((left - LINE.connectors.preload[relieved]) / per_newton[relieved]).min()
        assert STATICS.deflection(force * direction).slack.sum() == slack


@settings(max_examples=40)
@given(st.lists(st.tuples(st.floats(1.0, 179.0), st.floats(-600.0, 900.0), st.integers(0, 1)), min_size=1, max_size=4))
def test_slack_droppers_are_those_of_the_convex_minimum(loads: list[tuple[float, float, int]]) -> None:
    """Any loads, up and down, on either wire: tensions to 1e-6 N of 100 N, displacements to 1e-9 m of 1 m.

    The conditioning of the complementary problem limits the accuracy: droppers of 1e5 N/m beside wires of 1e3 N/m.
    """
    load = np.sum([force * point_load(LINE, row, x) for x, force, row in loads], axis=0)
    deflection = STATICS.deflection(load)
    displacement, tension = tensions_by_minimisation(load)
    np.testing.assert_allclose(deflection.tension, tension, rtol=0, atol=1e-6)
    np.testing.assert_allclose(deflection.displacement, displacement, rtol=0, atol=1e-9)


def test_elasticity_is_positive_and_symmetrical() -> None:
    """Uplift per newton under 100 N along the middle span of three: equal from both ends of the span.

    At mid-span both wires act as one string on rigid supports, L / 4(T + T') = 0.417 mm/N; the flexibility of supports,
    neighbouring spans and droppers adds a tenth. Near the supports the elasticity is about half.
    """
    loads = [100.0 * point_load(LINE, 0, x) for x in np.linspace(60.0, 120.0, 61)]
    moved = [STATICS.deflection(load).displacement.ravel()[bandwidth_order(LINE)] @ load for load in loads]
    elasticity = np.array(moved) / 100.0**2
    np.testing.assert_allclose(elasticity, elasticity[::-1], rtol=1e-9)
    string = 60.0 / (4 * (20e3 + 16e3))
    assert string < elasticity[30] < 1.2 * string
    assert elasticity.min() > 0.4 * string


def test_static_solver_satisfies_maxwells_reciprocity() -> None:
    """A force at A displaces B as much as the same force at B displaces A, on any wires."""
    a, b = 10.0 * point_load(LINE, 0, 51.2), 10.0 * point_load(LINE, 1, 97.9)
    place = bandwidth_order(LINE)
    moved = [STATICS.deflection(load).displacement.ravel()[place] for load in (a, b)]
    assert moved[0] @ b == pytest.approx(moved[1] @ a, rel=1e-9)


@pytest.mark.parametrize("force", [10.0, 800.0])
def test_deflection_along_a_load_is_its_product_with_the_displacements(force: float) -> None:
    """With taut droppers and with slack ones, by the reciprocity of the releasing forces; to rounding."""
    direction = point_load(LINE, 0, 90.0)
    displacement = STATICS.deflection(force * direction).displacement.ravel()[bandwidth_order(LINE)]
    (found,) = STATICS.deflections_at(respond(direction), force)
    assert found == pytest.approx(direction @ displacement, rel=1e-12)
