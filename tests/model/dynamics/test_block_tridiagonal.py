"""Block elimination and local columns of the inverse against the assembled effective matrix."""

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from helpers.lines import DAMPED, Array, bare_wire, overlapping_line, simple_line, without_connectors
from pantocheck.model.discretised_line import DiscretisedLine, discretise
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.block_tridiagonal import solve_wires
from pantocheck.model.dynamics.effective_matrix import factorise
from pantocheck.model.dynamics.extents import find_extents
from pantocheck.model.dynamics.inverse_columns import column_half_width, inverse_columns
from pantocheck.model.fem.assembly import assemble_matrices, bandwidth_order, stepping_mass


@pytest.fixture(scope="module", params=[(0.5, 1e-3), (1.3, 4e-3)])
def line_and_step(request: pytest.FixtureRequest) -> tuple[DiscretisedLine, float]:
    """A fine line with a short step, a coarse one with a long step."""
    element_length, time_step = request.param
    return discretise(simple_line(spans=2, damping=DAMPED), element_length), time_step


def inverse_of_assembled(line: DiscretisedLine, time_step: float) -> Array:
    """Inverse of M + dt/2 C + dt^2/4 K of the rows, indexed by (rows, stations, 2) twice; zero for fixed unknowns."""
    matrices = assemble_matrices(without_connectors(line))
    effective = (
        stepping_mass(line, time_step) + time_step / 2 * matrices.damping + time_step**2 / 4 * matrices.stiffness
    )
    order = bandwidth_order(line)[matrices.free]
    inverse = np.zeros((line.beams.free.size,) * 2)
    inverse[np.ix_(order, order)] = splu(effective.tocsc()).solve(np.eye(order.size))
    return inverse.reshape(line.beams.free.shape * 2)


def test_inverse_columns_are_the_columns_of_the_assembled_inverse(line_and_step: tuple[DiscretisedLine, float]) -> None:
    """To 1e-12 of the peak of each column, where it is cut; the rest is rounding."""
    line, time_step = line_and_step
    inverse, factor, stations = (
        inverse_of_assembled(line, time_step),
        factorise(line.beams, time_step),
        line.mesh.position.size,
    )
    loads = [(row, s, slope) for row in range(2) for s in range(0, stations, 3) for slope in range(2)]
    width = column_half_width(factor, [(row, s) for row, s, _ in loads])
    assert width < stations / 2  # otherwise no column is local, and nothing is tested
    assert width % 8 == 0  # whole vector registers
    columns = inverse_columns(factor, *(np.array(part) for part in zip(*loads, strict=True)), width)
    for (row, s, slope), column in zip(loads, columns, strict=True):
        expected = np.zeros((2, stations + 2 * width))
        expected[:, width : width + stations] = inverse[row, s, slope, row].T
        whole = np.zeros_like(expected)
        whole[:, s : s + 2 * width] = column
        np.testing.assert_allclose(whole, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_columns_are_no_wider_than_needed(line_and_step: tuple[DiscretisedLine, float]) -> None:
    """With eight stations less, some column ends above 1e-12 of its peak; the last eight stations hold none above."""
    line, time_step = line_and_step
    factor, stations = factorise(line.beams, time_step), line.mesh.position.size
    loads = [(row, s, slope) for row in range(2) for s in range(stations) for slope in range(2)]
    width = column_half_width(factor, [(row, s) for row, s, _ in loads])
    columns = inverse_columns(factor, *(np.array(part) for part in zip(*loads, strict=True)), width)
    size = np.abs(columns).sum(axis=1)
    relative = size / np.maximum(size.max(axis=1, keepdims=True), np.finfo(float).tiny)
    assert relative[:, [0, -1]].max() < 1e-12
    assert width == 8 or relative[:, [8, -9]].max() >= 1e-12


@pytest.mark.parametrize("load", [1, -2])
def test_columns_near_an_anchor_are_as_wide_as_elsewhere(load: int) -> None:
    """Beside the first or last station the column ends at the anchor on one side; the other side decides its width."""
    line = discretise(bare_wire(60.0), 0.25)
    factor, stations = factorise(line.beams, 2e-3), line.mesh.position.size
    assert column_half_width(factor, [(0, load % stations)]) == column_half_width(factor, [(0, stations // 2)]) > 8


@pytest.mark.parametrize("sections", [1, 3])
def test_solve_wires_agrees_with_a_sparse_solver(sections: int) -> None:
    """A random load on the whole line: 1e-12 of the peak allows for the growth of rounding along a row.

    Of three sections the first and the third share a row, and the eliminations meet in the second.
    """
    line, time_step = discretise(overlapping_line(sections, 3, section=simple_line(3, damping=DAMPED)), 0.8), 1e-3
    inverse, factor = inverse_of_assembled(line, time_step), factorise(line.beams, time_step)
    load = np.random.default_rng(1).normal(size=line.beams.free.shape)
    load[~line.beams.free] = 0.0
    w, r = load[..., 0].copy(), load[..., 1].copy()
    solve_wires(factor, find_extents(line.beams), Window(0, w.shape[1] - 1), w, r)
    for row in range(line.mesh.rows):
        expected = np.einsum("siab,ab->si", inverse[row, :, :, row], load[row])
        computed = np.stack([w[row], r[row]], axis=1)
        np.testing.assert_allclose(computed, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("share", [0.1, 0.35, 0.5, 0.65, 0.9])
def test_solve_wires_leaves_everything_outside_of_the_window(share: float) -> None:
    """A window of 30 m somewhere in three sections, loaded 10 m around its middle: the solution, or untouched."""
    line, time_step = discretise(overlapping_line(3, 3, section=simple_line(3, damping=DAMPED)), 0.8), 1e-3
    inverse, factor = inverse_of_assembled(line, time_step), factorise(line.beams, time_step)
    x = line.mesh.position
    middle = share * x[-1]
    window = Window(int(np.searchsorted(x, middle - 15.0)), int(np.searchsorted(x, middle + 15.0)))
    load = np.random.default_rng(2).normal(size=line.beams.free.shape)
    load[~line.beams.free] = 0.0
    load[:, np.abs(x - middle) > 5.0] = 0.0
    w, r = load[..., 0].copy(), load[..., 1].copy()
    w[:, : window.first], w[:, window.last + 1 :] = 7.0, 7.0
    solve_wires(factor, find_extents(line.beams), window, w, r)
    assert (w[:, : window.first] == 7.0).all()
    assert (w[:, window.last + 1 :] == 7.0).all()
    inside = slice(window.first, window.last + 1)
    for row in range(line.mesh.rows):
        expected = np.einsum("siab,ab->si", inverse[row, :, :, row], load[row])[inside]
        computed = np.stack([w[row], r[row]], axis=1)[inside]
        np.testing.assert_allclose(computed, expected, rtol=0, atol=1e-12 * np.abs(load).max())
