"""Verdicts and margins: sign, scale, and the published results of a code that passes."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.core.trust import LEVELS, decides_verdict
from pantocheck.conformance.core.verdicts import Verdict, judge, margin, worst_verdict
from pantocheck.conformance.line.library_folder import library_folder

NAMES = """mean_force_N std_force_N statistical_max_N statistical_min_N
max_force_N min_force_N max_uplift_at_support_mm contact_loss_pct"""
KNOWN_PASSING_CODE = {  # Wang et al., Table III: results of a published code
    "250": (118.2, 27.6, 201.1, 35.5, 193.7, 70.3, 52.2, 0.0),
    "300": (118.7, 32.8, 213.2, 19.2, 195.4, 54.7, 59.7, 0.0),
}

bounds = st.floats(-1e4, 1e4)


@given(value=bounds, a=bounds, b=bounds)
def test_margin_is_negative_exactly_where_the_verdict_is_fail(value: float, a: float, b: float) -> None:
    lower, upper = min(a, b), max(a, b)
    for low, high in ((lower, upper), (lower, None), (None, upper), (lower, lower)):
        assert (margin(value, low, high) < 0) == (judge(value, low, high) == "fail")


@given(a=bounds, width=st.floats(1e-3, 1e3), share=st.floats(0, 1))
def test_margin_between_two_limits_is_from_zero_to_one(a: float, width: float, share: float) -> None:
    # Rounding of the bounds relative to their distance: 1e4 / 1e-3 * 1e-16.
    assert -1e-8 <= margin(a + share * width, a, a + width) <= 1 + 1e-8


@pytest.mark.parametrize(
    ("value", "lower", "upper", "expected"),
    [
        (28.5, 26, 31, 1.0),
        (0.0, 0, 5e-324, 0.0),  # half of the smallest distance would be zero
        (5e-324, 0, 5e-324, 0.0),
        (-1e308, 0, 1e12, -2e296),  # twice the value would not be finite
        (26.0, 26, 31, 0.0),
        (33.5, 26, 31, -1.0),
        (28.4, 26, 31, 0.96),
        (0.0, 0, 0, 0.0),
        (0.5, 0, 0, -0.5),
        (210.0, 200, 200, -0.05),
        (0.27, None, 0.3, 0.1),
        (15.0, 20, None, -0.25),
        (2.0, 0, None, 2.0),
    ],
)
def test_margin_by_hand(value: float, lower: float | None, upper: float | None, expected: float) -> None:
    assert margin(value, lower, upper) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("speed", ["250", "300"])
def test_published_results_pass_and_each_value_outside_its_limits_fails_alone(speed: str) -> None:
    limits = {limit.quantity: limit for limit in load_case(library_folder() / "en50318-2002" / f"{speed}.toml").limits}
    known = dict(zip(NAMES.split(), KNOWN_PASSING_CODE[speed], strict=True))
    assert set(limits) == set(known)

    def failing(values: dict[str, float]) -> list[str]:
        return [name for name, limit in limits.items() if judge(values[name], limit.lower, limit.upper) == "fail"]

    assert failing(known) == []
    for name, limit in limits.items():
        assert failing(known | {name: limit.upper + 0.01}) == [name]
        assert failing(known | {name: limit.lower - 0.01}) == [name]


def test_worst_verdict_decides_and_limits_count_from_the_lowest_trust_up() -> None:
    order: tuple[Verdict, ...] = ("pass", "unconfirmed", "info", "skip", "fail", "error")
    for better, worse in pairwise(order):
        assert worst_verdict([better, worse, "pass"]) == worst_verdict([worse, better]) == worse
    assert worst_verdict(["pass", "skip"]) == "skip"
    assert worst_verdict(["skip", "fail", "pass"]) == "fail"
    assert worst_verdict(["fail", "error"]) == "error"
    assert worst_verdict([]) == "info"
    # Rows: trust of the limit; columns: lowest trust that counts; both from primary to provisional.
    assert LEVELS == ("primary", "secondary", "provisional")
    counts = [[decides_verdict(trust, lowest) for lowest in LEVELS] for trust in LEVELS]
    assert counts == [[True, True, True], [False, True, True], [False, False, True]]
    with pytest.raises(ValueError, match="at least one"):
        margin(1.0, None, None)
