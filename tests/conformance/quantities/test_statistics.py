"""Statistics against signals whose values are known by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from pantocheck.conformance.quantities.statistics import (
    WHOLE_RECORD,
    coefficient_of_variation,
    contact_loss,
    force_histogram,
    statistical_extremes,
)
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered, NoMeanForce


def test_extremes_variation_and_contact_loss_by_hand() -> None:
    """Published figures of one code at 250 km/h: 118.2 N and 27.6 N give 35.4 and 201.0 (printed 35.5 and 201.1)."""
    assert_allclose(statistical_extremes(118.2, 27.6), (35.4, 201.0), rtol=1e-12)
    assert coefficient_of_variation(120.0, 36.0) == 0.3
    with pytest.raises(NoMeanForce, match="is 0 N"):
        coefficient_of_variation(0.0, 36.0)
    force = np.array([10.0, 0.0, 0.0, 5.0, 20.0, 0.0, 1e-6, 3.0])
    assert contact_loss(force, None, WHOLE_RECORD) == 37.5
    with pytest.raises(AlreadyFiltered, match="unfiltered"):
        contact_loss(np.zeros(10), 20.0, WHOLE_RECORD)


@settings(max_examples=50)
# No measuring chain or simulation delivers subnormal forces (below 2e-308 N), whose class number underflows to zero.
@given(values=st.lists(st.floats(-500, 500, allow_subnormal=False), min_size=1, max_size=300))
def test_histogram_holds_every_sample_once(values: list[float]) -> None:
    force = np.array(values)
    edges, share = force_histogram(force)
    assert edges[0] <= force.min()
    assert force.max() < edges[-1]
    assert share.size == edges.size - 1
    assert_allclose(share.sum(), 100.0, rtol=1e-12)
    assert share.size <= 35  # 30 classes and two that are cut by the ends


@pytest.mark.parametrize(
    ("values", "width", "first", "last"),
    [
        ((0.0, 300.0), 10, 0, 31),
        ((0.0, 301.0), 20, 0, 16),
        ((0.0, 310.0), 20, 0, 16),  # 31 classes would need 10 N
        ((0.0, 60.0), 2, 0, 31),
        ((0.0, 61.0), 5, 0, 13),
        ((0.0, 150.0), 5, 0, 31),
        ((0.0, 30.0), 1, 0, 31),
        ((0.0, 15.0), 0.5, 0, 31),
        ((-7.0, 24.0), 2, -4, 13),
        ((119.0, 119.0), 0.05, 2380, 2381),  # a constant force: a width for a spread of 1 N
        ((119.0, 119.5), 0.05, 2380, 2391),
    ],
)
def test_widths_are_powers_of_ten_times_1_2_5(values: tuple[float, float], width: float, first: int, last: int) -> None:
    """The smallest such width that gives at most 30 classes, besides one cut by each end."""
    edges, share = force_histogram(np.array(values))
    assert_allclose(edges, np.arange(first, last + 1) * width, rtol=1e-12, atol=1e-12)
    assert share[0] == pytest.approx(100.0 if values[0] == values[1] else 50.0)
    assert share.sum() == pytest.approx(100.0)
