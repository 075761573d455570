"""Rows of the printed Table 1: the mean forces that they imply do not agree."""

import pytest

from verification.tables.printed_table import change_at_equal_mean, imply_mean, list_means


def test_mean_force_of_a_row_by_hand() -> None:
    """Bands of 3 and 4 N are 5 N together; with 0.05, rounded, the mean lies between 5 / 0.055 and 5 / 0.045."""
    row = {"cov_20": 0.05, "cov_50": 0.1, "rms_0_5_N": 3.0, "rms_5_20_N": 4.0, "rms_20_50_N": 12.0}
    assert imply_mean(row, "cov_20") == pytest.approx((90.909, 111.111), abs=1e-3)
    assert imply_mean(row, "cov_50") == pytest.approx((13 / 0.105, 13 / 0.095))


def test_printed_rows_do_not_fit_one_mean_force() -> None:
    """The updated row in front contradicts itself; both rows of the rear contradict each other."""
    rows = {(pantograph, model): (low, high) for pantograph, model, low, high in list_means()}
    low, high = rows[1, "updated"]
    assert [*low, *high] == pytest.approx([153.6, 158.8, 147.9, 151.9], abs=0.05)
    assert [row for row, (low, high) in rows.items() if not low.meets(high)] == [(1, "updated")]
    both = [
        (max(low.low, high.low), min(low.high, high.high)) for low, high in (rows[2, m] for m in ("initial", "updated"))
    ]
    assert both == [pytest.approx((212.7, 217.6), abs=0.06), pytest.approx((201.9, 206.4), abs=0.06)]
    # With equal means, the coefficients would change by less than the printed -9.1 and +13.0 %.
    assert [change_at_equal_mean(p, "cov_20") for p in (1, 2)] == pytest.approx([-5.8, 5.3], abs=0.05)
