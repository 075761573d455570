"""Extrapolation of converged values: exact for a power of the mesh, cautious where there is no order."""

import pytest

from verification.formulations.converged_extrapolation import difference_pct, extrapolate, extrapolate_pair


@pytest.mark.parametrize("order", [1.5, 2.0, 3.0])
def test_value_of_a_power_of_the_mesh_is_exact(order: float) -> None:
    """50 + 8 h^p: the extrapolated error of the finest mesh times 1.25 is the half-width."""
    found = extrapolate((50 + 8.0, 50 + 8 * 0.5**order, 50 + 8 * 0.25**order))
    assert found.value == pytest.approx(50, abs=1e-12)
    assert found.order == pytest.approx(order, abs=1e-12)
    assert found.half_width == pytest.approx(1.25 * 8 * 0.25**order, rel=1e-12)


@pytest.mark.parametrize(
    ("values", "half_width"),
    [
        ((51.0, 50.0, 50.6), 0.6),  # the changes alternate: 3 / (4 - 1) times the last one
        ((54.0, 50.0, 50.1), 1.0),  # a small last change: a quarter of the one before
        ((50.3, 50.2, 50.0), 0.2),  # the changes grow
        ((58.0, 50.25, 50.0), 1.9375),  # faster than order 4: not asymptotic
        ((50.0, 50.0, 50.0), 0.0),
    ],
)
def test_no_order_keeps_the_finest_value(values: tuple[float, float, float], half_width: float) -> None:
    found = extrapolate(values)
    assert (found.value, found.order) == (values[2], None)
    assert found.half_width == pytest.approx(half_width, abs=1e-12)


def test_second_formulation_is_extrapolated_with_order_two() -> None:
    assert extrapolate_pair(50 + 8.0, 50 + 2.0) == pytest.approx(50, abs=1e-12)


def test_extremes_are_compared_by_their_distance_from_the_mean() -> None:
    """1 N of 50 N is 2 %; 1 N of a minimum that lies 100 N below the mean is 1 %."""
    assert difference_pct("std_force_N", 50.0, 51.0, 120.0) == pytest.approx(2.0)
    assert difference_pct("min_force_N", 20.0, 21.0, 120.0) == pytest.approx(1.0)
    assert difference_pct("statistical_max_N", 220.0, 219.0, 120.0) == pytest.approx(-1.0)
    assert difference_pct("max_uplift_at_support_mm", 50.0, 51.0, None) == pytest.approx(2.0)
