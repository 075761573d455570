"""Decision rules: verdicts by value, interval and joint sample, and the fail-closed ends of each rule."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pantocheck.conformance.core.decision import (
    SIMPLE,
    DecisionRule,
    GuardedAcceptance,
    SharedRisk,
    describe_decision,
    format_decision,
    judge_by_rule,
    parse_decision,
)
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.near_limit import ValueErrors

GUARDED, SHARED = GuardedAcceptance(), SharedRisk(0.1)
LIMITS = (20.0, 40.0)


@pytest.mark.parametrize("rule", [SIMPLE, GUARDED, SHARED, SharedRisk(0.5), SharedRisk(0.0125)])
def test_text_of_a_rule_reads_back(rule: DecisionRule) -> None:
    assert parse_decision(format_decision(rule)) == rule
    assert describe_decision(rule)


@pytest.mark.parametrize("text", ["", "Simple", "shared-risk", "shared-risk:0.6", "shared-risk:0.0", "guarded:0.1"])
def test_other_texts_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="Give simple, guarded, or a shared risk"):
        parse_decision(text)


@pytest.mark.parametrize(
    ("value", "width", "verdict"),
    [(30.0, 9.99, "pass"), (30.0, 10.0, "pass"), (30.0, 10.01, "undecided"), (40.0, 0.0, "pass"), (40.1, 5.0, "fail")],
)
def test_guarded_acceptance_needs_the_whole_interval(value: float, width: float, verdict: str) -> None:
    errors = ValueErrors(components={"start": width})
    assert judge_by_rule(value, LIMITS, errors, GUARDED)[0] == verdict
    assert judge_by_rule(value, LIMITS, errors, SIMPLE)[0] == ("fail" if value > 40 else "pass")


def test_uncertain_limit_widens_the_interval() -> None:
    """The root of 3^2 + 4^2 is 5: the interval reaches the limit at 35 and not beyond it."""
    errors = ValueErrors(components={"start": 3.0}, limit_uncertainty=4.0)
    assert judge_by_rule(35.0, LIMITS, errors, GUARDED)[0] == "pass"
    assert judge_by_rule(35.1, LIMITS, errors, GUARDED)[0] == "undecided"


def test_shared_risk_is_the_share_of_the_sample_outside() -> None:
    draws = (*[39.0] * 9, 41.0)
    errors = ValueErrors(components={"start": 1.0}, draws=draws)
    assert errors.find_conformity(LIMITS) == pytest.approx(0.9)
    assert judge_by_rule(39.0, LIMITS, errors, SharedRisk(0.11))[0] == "pass"
    assert judge_by_rule(39.0, LIMITS, errors, SharedRisk(0.09))[0] == "undecided"
    # A normal limit with a standard deviation of 1 N: every draw is 1 standard deviation from the upper limit.
    uncertain = ValueErrors(draws=draws, limit_uncertainty=1.959964)
    assert uncertain.find_conformity((None, 40.0)) == pytest.approx(0.9 * 0.841345 + 0.1 * 0.158655, abs=1e-6)


@pytest.mark.parametrize("rule", [GUARDED, SHARED])
def test_unknown_component_is_no_zero(rule: DecisionRule) -> None:
    errors = ValueErrors(components={"start": 0.1}, unknown=("length",))
    assert judge_by_rule(30.0, LIMITS, errors, rule) == (
        "undecided",
        "its uncertainty is not complete: length not known",
    )
    assert judge_by_rule(30.0, LIMITS, errors, SIMPLE)[0] == "pass"
    unstated = ValueErrors(components={"start": 0.1}, limit_uncertainty=None)
    assert judge_by_rule(30.0, LIMITS, unstated, rule)[0] == "undecided"


@pytest.mark.parametrize("rule", [SIMPLE, GUARDED, SHARED])
def test_sampling_and_resolution_must_stay_inside_under_every_rule(rule: DecisionRule) -> None:
    errors = ValueErrors(components={"sampling": 0.3, "resolution": 0.2})
    assert judge_by_rule(39.5, LIMITS, errors, rule)[0] == "pass"
    assert judge_by_rule(39.51, LIMITS, errors, rule)[0] == "undecided"
    assert judge_by_rule(20.49, LIMITS, errors, rule)[0] == "undecided"
    assert judge_by_rule(30.0, LIMITS, ValueErrors(unknown=("sampling",)), rule)[0] == "undecided"


@given(
    value=st.floats(0, 60),
    width=st.floats(0, 30),
    more=st.floats(0, 30),
    rule=st.sampled_from([SIMPLE, GUARDED, SHARED]),
)
def test_larger_errors_never_improve_a_verdict(value: float, width: float, more: float, rule: DecisionRule) -> None:
    order = ["fail", "undecided", "pass"]
    small, large = (
        judge_by_rule(value, LIMITS, ValueErrors(components={"start": x, "sampling": x}), rule)[0]
        for x in (width, width + more)
    )
    assert order.index(large) <= order.index(small)
