"""Statements on mass drops by hand: groups that merge, and lateral modes."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pantocheck.conformance.studies.vovan2015.mass_drop_study import find_merging, select_lateral

FREQUENCY = np.array([1.0, 1.2, 2.0, 2.4, 2.8, 3.4])
GROUPS = [1, 1, 2, 2, 3, 3]


@pytest.mark.parametrize(("gap", "place"), [(0.5, None), (0.85, 2.6), (1.0, 2.6), (2.7, 1.6)])
def test_groups_merge_where_their_gap_is_smaller_than_their_widths(gap: float, place: float | None) -> None:
    """Gaps of 0.8 and 0.4 Hz beside mean widths of 0.3 and 0.5 Hz: 2.67 and 0.8 of them."""
    assert find_merging(FREQUENCY, GROUPS, gap) == (None if place is None else pytest.approx(place))


def test_a_gap_as_wide_as_its_groups_is_a_gap() -> None:
    """Widths of 0.5 Hz and a gap of 0.5 Hz, all exact in binary; a missing group is passed over."""
    frequency, groups = np.array([1.0, 1.5, 2.0, 2.5]), [1, 1, 3, 3]
    assert find_merging(frequency, groups) is None
    assert find_merging(frequency, groups, 1.01) == 1.75
    assert find_merging(np.array([]), []) is None


def test_lateral_modes_move_sideways_by_the_larger_part() -> None:
    """Antisymmetric shapes of one vertical and one lateral row: their squares add up, their values do not."""
    shape = np.zeros((2, 2, 2, 2))
    shape[..., 0] = [[[1.0, -1.0], [0.1, 0.1]], [[0.1, 0.1], [1.0, -1.0]]]
    modes: Any = SimpleNamespace(shape=shape, frequency=np.array([1.0, 2.0]))
    assert select_lateral(modes).tolist() == [2.0]
