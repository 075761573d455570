"""Solution in panels against its scalar twin, station by station, and against the assembled effective matrix."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.effective_inverse import inverse_of_assembled
from helpers.lines import DAMPED, Array, bare_wire, overlapping_line, simple_line
from pantocheck.model import Catenary, discretise
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.block_tridiagonal import Factor, solve_stations
from pantocheck.model.dynamics.extents import find_extents, merge_extents
from pantocheck.model.dynamics.kernel_arrays import factorise
from pantocheck.model.dynamics.panels import (
    FADED,
    SHORTEST_PIECE,
    PanelFactor,
    allocate_panel_workspace,
    build_panels,
    measure_fade,
    solve_wires,
)
from pantocheck.model.dynamics.vectors import LANES

STEP = 1e-3


def zigzag(spans: int) -> Catenary:
    """Line with a lateral field: four rows."""
    line = simple_line(spans, damping=DAMPED)
    contact, messenger = line.wires
    stagger = tuple((60.0 * i, 0.2 * (-1) ** i) for i in range(spans + 1))
    arms = tuple(replace(arm, vertical_stiffness=None, length=1.2) for arm in line.steady_arms)
    wires = replace(contact, stagger=stagger), replace(messenger, stagger=tuple((x, 0.0) for x, _ in stagger))
    return replace(line, wires=wires, steady_arms=arms)


def parallel_wires() -> Catenary:
    """Three rows: two parallel contact wires of different tension below one messenger wire."""
    line = simple_line(4, damping=DAMPED)
    contact, messenger = line.wires
    return replace(line, wires=(contact, replace(contact, name="second", tension=8e3), messenger))


def random_load(line: DiscretisedLine, width: int, window: Window, seed: int) -> Array:
    """Random forces and moments on the free unknowns inside a window, (2, B, S')."""
    load = np.zeros((2, line.mesh.rows, width))
    free = line.beams.free.transpose(2, 0, 1)
    load[:, :, : free.shape[2]][free] = np.random.default_rng(seed).normal(size=int(free.sum()))
    load[:, :, : window.first] = load[:, :, window.last + 1 :] = 0.0
    return load


def solve_in_panels(line: DiscretisedLine, panels: PanelFactor, window: Window, load: Array) -> tuple[Array, float]:
    """Solution with vectors, (2, B, S'), and the sum that is NaN with any NaN."""
    w, r = (np.zeros((3, *load.shape[1:])) for _ in range(2))
    w[2], r[2] = load
    extents = merge_extents(find_extents(line.beams), panels.piece * LANES)
    total = solve_wires(panels, extents, window, w, r, allocate_panel_workspace(panels))
    assert not w[:2].any()
    assert not r[:2].any()
    return np.stack([w[2], r[2]]), total


def solve_station_by_station(factor: Factor, load: Array) -> Array:
    """Slow twin: the scalar recurrences on whole rows."""
    solution, stations = load.copy(), factor.link.shape[1]
    for row in range(load.shape[1]):
        solve_stations(factor, row, 0, stations - 1, solution[0, row], solution[1, row], 0)
    return solution


@pytest.mark.parametrize(
    ("catenary", "element", "step"),
    [
        (bare_wire(30.0), 1.0, STEP),  # one piece is longer than the line
        (bare_wire(400.0), 0.5, STEP),  # one row, several panels
        (simple_line(4, damping=DAMPED), 0.25, 4e-3),  # a long fade
        (parallel_wires(), 0.5, STEP),  # three rows
        (zigzag(5), 0.5, STEP),
        (overlapping_line(3, 3, section=simple_line(3, damping=DAMPED)), 0.4, STEP),
        (overlapping_line(3, 3, section=simple_line(3, damping=DAMPED)), 4.0, STEP),  # sections in one panel
    ],
)
def test_panels_give_the_solution_of_the_scalar_recurrences(catenary: Catenary, element: float, step: float) -> None:
    """To 1e-12 of the largest value: the warm-up reduces the force before it to 1e-13."""
    line = discretise(catenary, element)
    factor = factorise(line.beams, step)
    panels = build_panels(factor, line.mesh.position, 40)
    width = panels.panels * panels.piece * LANES
    load = random_load(line, width, Window(0, width - 1), 3)
    solution, _ = solve_in_panels(line, panels, Window(0, width - 1), load)
    expected = solve_station_by_station(factor, load)
    for computed, exact in zip(solution, expected, strict=True):
        np.testing.assert_allclose(computed, exact, rtol=0, atol=1e-12 * np.abs(exact).max())


@pytest.mark.parametrize("sections", [1, 3])
def test_panels_agree_with_a_sparse_solver(sections: int) -> None:
    """A random load on the whole line: 1e-12 of the peak allows for the growth of rounding along a row."""
    line = discretise(overlapping_line(sections, 3, section=simple_line(3, damping=DAMPED)), 0.8)
    inverse, panels = inverse_of_assembled(line, STEP), build_panels(factorise(line.beams, STEP), line.mesh.position, 0)
    width, stations = panels.panels * panels.piece * LANES, line.mesh.position.size
    load = random_load(line, width, Window(0, width - 1), 1)
    solution, _ = solve_in_panels(line, panels, Window(0, width - 1), load)
    for row in range(line.mesh.rows):
        expected = np.einsum("siab,ba->is", inverse[row, :, :, row], load[:, row, :stations])
        np.testing.assert_allclose(solution[:, row, :stations], expected, rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("share", [0.1, 0.35, 0.5, 0.65, 0.9])
def test_only_the_active_window_is_solved(share: float) -> None:
    """A narrow window in three sections, loaded well inside of it: the solution of the whole line, and zero outside."""
    line = discretise(overlapping_line(3, 3, section=simple_line(3, damping=DAMPED)), 0.4)
    factor = factorise(line.beams, STEP)
    panels = build_panels(factor, line.mesh.position, 40)
    middle = int(share * line.mesh.position.size) // LANES * LANES
    window, loaded = Window(middle - 64, middle + 63), Window(middle - 32, middle + 31)
    load = random_load(line, panels.panels * panels.piece * LANES, loaded, 2)
    solution, _ = solve_in_panels(line, panels, window, load)
    expected = solve_station_by_station(factor, load)
    inside = slice(window.first, window.last + 1)
    assert not np.delete(solution, np.r_[inside], axis=2).any()
    for computed, exact in zip(solution[..., inside], expected[..., inside], strict=True):
        np.testing.assert_allclose(computed, exact, rtol=0, atol=1e-12 * np.abs(exact).max())


@pytest.mark.parametrize(("element", "step"), [(0.5, 1e-3), (0.25, 4e-3)])
def test_fade_is_the_decay_of_products_of_the_factors(element: float, step: float) -> None:
    """Slow twin: products of 2 x 2 matrices; a piece holds a whole fade and whole vectors."""
    line = discretise(simple_line(2, damping=DAMPED), element)
    factor, x = factorise(line.beams, step), line.mesh.position
    longest = 0
    for row in range(2):
        matrices = factor.link[row].reshape(-1, 2, 2)
        for start in range(x.size - 1):
            scale = np.array([[1.0, 1 / (x[start + 1] - x[start])]])
            product, length = np.eye(2), 0
            while start + length < x.size - 1 and np.abs(product / scale * scale.T).max() > FADED:
                product = matrices[start + length] @ product
                length += 1
            longest = max(longest, length)
    panels = build_panels(factor, x, 0)
    assert measure_fade(factor, x) == panels.fade == longest
    assert panels.piece == max(SHORTEST_PIECE, -(-longest // LANES) * LANES)


def test_nan_in_any_force_is_reported() -> None:
    """The sum of a solution is NaN for NaN at any station, and finite otherwise."""
    line = discretise(simple_line(4), 0.5)
    panels = build_panels(factorise(line.beams, STEP), line.mesh.position, 0)
    width = panels.panels * panels.piece * LANES
    for station in (1, 200, line.mesh.position.size - 2):
        load = random_load(line, width, Window(0, width - 1), 4)
        assert np.isfinite(solve_in_panels(line, panels, Window(0, width - 1), load)[1])
        load[1, 1, station] = np.nan
        assert np.isnan(solve_in_panels(line, panels, Window(0, width - 1), load)[1])
