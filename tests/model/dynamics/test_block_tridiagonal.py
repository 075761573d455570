"""Scalar block elimination: local columns of the inverse against the assembled effective matrix."""

import numpy as np
import pytest

from helpers.effective_inverse import inverse_of_assembled
from helpers.lines import DAMPED, Array, bare_wire, simple_line
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, discretise
from pantocheck.model.dynamics.block_tridiagonal import Factor
from pantocheck.model.dynamics.connector_step import column_half_width, inverse_columns
from pantocheck.model.dynamics.kernel_arrays import factorise


@pytest.fixture(scope="module", params=[(0.5, 1e-3), (1.3, 4e-3)])
def line_and_step(request: pytest.FixtureRequest) -> tuple[DiscretisedLine, float]:
    """A fine line with a short step, a coarse one with a long step."""
    element_length, time_step = request.param
    return discretise(simple_line(spans=2, damping=DAMPED), element_length), time_step


def local_columns(factor: Factor, loads: list[tuple[int, int]], width: int) -> Array:
    """Local columns of the inverse with some stations on either side of each load."""
    row, station = np.array(loads, dtype=np.int64).T.copy()
    columns = np.zeros((row.size, 2, 2 * width))
    inverse_columns(factor, row, station, station - width, columns)
    return columns


def test_inverse_columns_are_the_columns_of_the_assembled_inverse(line_and_step: tuple[DiscretisedLine, float]) -> None:
    """To 1e-12 of the peak of each column, where it is cut; the rest is rounding."""
    line, time_step = line_and_step
    inverse, factor, stations = (
        inverse_of_assembled(line, time_step),
        factorise(line.beams, time_step),
        line.mesh.position.size,
    )
    loads = [(row, s) for row in range(2) for s in range(0, stations, 3)]
    width = column_half_width(factor, loads)
    assert width < stations / 2  # otherwise no column is local, and nothing is tested
    assert width % 8 == 0  # whole vector registers
    for (row, s), column in zip(loads, local_columns(factor, loads, width), strict=True):
        expected = np.zeros((2, stations + 2 * width))
        expected[:, width : width + stations] = inverse[row, s, 0, row].T
        whole = np.zeros_like(expected)
        whole[:, s : s + 2 * width] = column
        np.testing.assert_allclose(whole, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_columns_are_no_wider_than_needed(line_and_step: tuple[DiscretisedLine, float]) -> None:
    """With eight stations less, some column ends above 1e-12 of its peak; the last eight stations hold none above."""
    line, time_step = line_and_step
    factor, stations = factorise(line.beams, time_step), line.mesh.position.size
    loads = [(row, s) for row in range(2) for s in range(stations)]
    width = column_half_width(factor, loads)
    size = np.abs(local_columns(factor, loads, width)).sum(axis=1)
    relative = size / np.maximum(size.max(axis=1, keepdims=True), np.finfo(float).tiny)
    assert relative[:, [0, -1]].max() < 1e-12
    assert width == 8 or relative[:, [8, -9]].max() >= 1e-13


@pytest.mark.parametrize("load", [1, -2])
def test_columns_near_an_anchor_are_as_wide_as_elsewhere(load: int) -> None:
    """Beside the first or last station the column ends at the anchor on one side; the other side decides its width."""
    line = discretise(bare_wire(60.0), 0.25)
    factor, stations = factorise(line.beams, 2e-3), line.mesh.position.size
    assert column_half_width(factor, [(0, load % stations)]) == column_half_width(factor, [(0, stations // 2)]) > 8
