"""Limits of all comparisons: keys by quantity, bounds, and the grade of a value."""

from typing import Any

import pytest
from pydantic import ValidationError

from pantocheck.conformance.comparison.comparison_limits import ComparisonLimit, grade_difference, unit_of_difference

RESPONSE = {
    "quantity": "modulus_deviation_pct", "band_Hz": (5.0, 20.0), "static_forces_N": (70.0,), "upper": 3.0,
}  # fmt: skip
DROP = {"quantity": "correlation", "band_Hz": (5.0, 20.0), "sensors": (1,), "window_s": (0.0, 4.0), "lower": 0.9}
STATIC = {"quantity": "elasticity_difference_pct", "upper": 5.0}


@pytest.mark.parametrize("tables", [RESPONSE, DROP, STATIC])
def test_every_required_key_is_demanded(tables: dict[str, Any]) -> None:
    limit = ComparisonLimit.model_validate(tables)
    for key in limit.kind.required:
        kept = {name: value for name, value in tables.items() if name != key}
        with pytest.raises(ValidationError, match="missing"):
            ComparisonLimit.model_validate(kept)


@pytest.mark.parametrize(
    ("tables", "changes", "message"),
    [
        (RESPONSE, {"sensors": (1,)}, "is not a key of a limit of modulus_deviation_pct"),
        (RESPONSE, {"lower": 0.5}, "is not a key of a limit of modulus_deviation_pct"),
        (RESPONSE, {"upper": 0.0}, "0 is not positive"),
        (RESPONSE, {"heights_m": (1.0, 1.0)}, "repeats a value"),
        (RESPONSE, {"band_Hz": (0.3, 20.0)}, "is not a compared band"),
        (DROP, {"heights_m": (1.0,)}, "is not a key of a limit of correlation"),
        (DROP, {"band_Hz": (0.5, 5.0)}, "is not a compared band"),
        (DROP, {"upper": 0.8}, "0.9 is above upper = 0.8"),
        (DROP, {"lower": None}, "has no bound"),
        (STATIC, {"band_Hz": (5.0, 20.0)}, "is not a key of a limit of elasticity_difference_pct"),
    ],
)
def test_limit_that_fits_no_comparison_is_refused(tables: dict[str, Any], changes: Any, message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        ComparisonLimit.model_validate(tables | changes)


def test_unit_distance_and_uncertainty_of_a_grade() -> None:
    names = ("elasticity_difference_mm_N", "contact_wire_height_difference_mm", "phase_deviation_deg", "rms_ratio")
    assert [unit_of_difference(name) for name in names] == ["mm/N", "mm", "°", ""]
    # Half-widths 0.3 and 0.4 are 0.5 together: a value 0.45 below the limit is marked, one 0.55 below is not.
    limit = ComparisonLimit.model_validate(RESPONSE)
    for value, marks in ((2.55, 1), (2.45, 0)):
        item = grade_difference(limit, value, missing=None, discretisation=0.3, measurement=0.4)
        assert (item.verdict, len(item.close)) == ("pass", marks)
