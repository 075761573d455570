"""Building of results: finite numbers, and owners as text."""

import math

from pantocheck.conformance.grading.results_building import key_by_owner, select_finite


def test_quantity_with_a_number_that_is_not_finite_is_left_out() -> None:
    """A list with one such number is left out as a whole: its items are graded by their position."""
    values = {
        0: {"dropper_length_m": (1.0, math.nan), "presag_mm": (0.0, 55.0), "wave_speed_m_s": math.inf},
        2: {"mean_force_N": 119.0, "std_force_N": math.nan, "min_force_N": -math.inf},
    }
    assert select_finite(values) == {0: {"presag_mm": [0.0, 55.0]}, 2: {"mean_force_N": 119.0}}


def test_owners_without_content_are_left_out() -> None:
    assert key_by_owner({0: {}, 1: {"mean_force_N": 119.0}, 2: {}}) == {"1": {"mean_force_N": 119.0}}
