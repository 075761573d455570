"""Grading of one criterion: the value that a limit applies to, and the texts of a criterion."""

import math
from typing import Any

import pytest

from helpers.criterion_fixtures import build_requirement
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.grading.criterion_grading import (
    GradedValues,
    build_criterion,
    criterion_name,
    find_value,
    grade_limit,
)
from pantocheck.conformance.quantities.evaluation import Evaluation, Value
from pantocheck.conformance.quantities.uncertainty import Component, Uncertainty

Bound = float | None
LENGTHS = (1.017, 0.896, math.nan)


def limit(quantity: str = "std_force_N", **keys: Any) -> Limit:
    return Limit(**{"quantity": quantity, "lower": 26.0, "upper": 31.0, "trust": "secondary", "source": "test", **keys})


@pytest.mark.parametrize(
    ("item", "values", "expected"),
    [
        (None, LENGTHS, 1.017),
        (1, LENGTHS, 1.017),
        (2, LENGTHS, 0.896),
        (3, LENGTHS, None),  # not finite
        (4, LENGTHS, None),  # not delivered
        (None, 0.9, 0.9),
        (None, math.nan, None),
        (None, math.inf, None),
        (None, (), None),
    ],
)
def test_limit_applies_to_a_finite_item(item: int | None, values: Value, expected: float | None) -> None:
    """A limit without an item applies to the first one."""
    target = limit("dropper_length_m", item=item).target
    assert find_value(target, {0: {"dropper_length_m": values}}) == expected


def test_value_belongs_to_its_pantograph_unit_and_reason() -> None:
    values: dict[int, dict[str, Value]] = {1: {"std_force_N": 28.0}, 2: {"std_force_N": 30.0}}
    assert [find_value(limit(pantograph=number).target, values) for number in (1, 2, 3)] == [28.0, 30.0, None]
    evaluation = Evaluation({1: {}}, {1: {"std_force_N": "the record is too short"}})
    reasons = [grade_limit(limit(pantograph=number), GradedValues(evaluation), "secondary").reason for number in (1, 2)]
    assert reasons == ["the record is too short", "the system does not deliver this quantity"]
    found = build_criterion(build_requirement("cov_20", None, 0.3), 0.35, None, "secondary")
    assert found.reason == "0.05 above the upper limit"
    assert build_criterion(build_requirement("old", None, 0.3), 0.2, None, "secondary").unit == ""
    placed = build_criterion(build_requirement("std_force_N", None, 31.0), 33.5, None, "secondary", place=", at 3 m")
    assert placed.reason == "2.5 N above the upper limit, at 3 m"


@pytest.mark.parametrize(
    ("value", "lower", "upper", "verdict", "margin", "reason"),
    [
        (28.5, 26.0, 31.0, "pass", 1.0, None),
        (25.0, 26.0, 31.0, "fail", -0.4, "1 N below the lower limit"),
        (33.5, 26.0, 31.0, "fail", -1.0, "2.5 N above the upper limit"),
        (25.0, 26.0, None, "fail", -1 / 26, "1 N below the lower limit"),
        (33.0, None, 31.0, "fail", -2 / 31, "2 N above the upper limit"),
        (1.0, None, 0.0, "fail", -1.0, "1 N above the upper limit"),
        (26.0, 26.0, None, "pass", 0.0, None),
        (31.0, None, 31.0, "pass", 0.0, None),
        (28.0, None, None, "skip", None, "no data"),
        (None, 26.0, 31.0, "skip", None, "no data"),
        (28.5, 26.0, 31.0, "skip", 1.0, "no data"),
        (33.5, 26.0, 31.0, "skip", -1.0, "no data; 2.5 N above the upper limit"),
    ],
)
def test_criterion_states_verdict_margin_and_distance(
    value: float | None,
    lower: float | None,
    upper: float | None,
    verdict: str,
    margin: float | None,
    reason: str | None,
) -> None:
    missing = "no data" if verdict == "skip" else None
    found = build_criterion(build_requirement("std_force_N", lower, upper), value, missing, "secondary")
    assert (found.verdict, found.reason, found.unit, found.pantograph) == (verdict, reason, "N", 2)
    assert found.margin == (None if margin is None else pytest.approx(margin, abs=1e-12))
    hypothetical = build_criterion(
        build_requirement("std_force_N", lower, upper, trust="provisional"), value, missing, "secondary"
    )
    expected = {"pass": "would pass", "fail": f"would fail: {reason}", "skip": f"not graded: {reason}"}[verdict]
    assert hypothetical.verdict == "info"
    assert hypothetical.reason == f"{expected}; the limit is provisional and does not count"


def test_errors_belong_to_the_quantity_and_pantograph_of_the_limit() -> None:
    """The rear has its own discretisation error, spread and components; without them there is no uncertainty."""
    values = GradedValues(
        Evaluation({2: {"std_force_N": 28.0}}, {}),
        refined=Evaluation({1: {"std_force_N": 20.0}, 2: {"std_force_N": 28.5}}, {}),
        spread={1: {"std_force_N": 9.0}, 2: {"std_force_N": 0.25, "mean_force_N": 8.0}},
        uncertainty=Uncertainty(
            {
                "start": Component("other starts", {1: {"std_force_N": 9.0}, 2: {"std_force_N": 0.3}}),
                "section": Component("not known: one section", {1: {"std_force_N": 9.0}}),
                "length": Component("bootstrap", {2: {"std_force_N": 0.4, "mean_force_N": 7.0}}),
            }
        ),
    )
    found = grade_limit(limit(pantograph=2), values, "secondary", 0.75)
    assert (found.discretisation_error, found.spread, found.limit_uncertainty) == (0.5, 0.25, 0.75)
    assert found.uncertainty == pytest.approx(0.5, rel=1e-12)  # 0.3, 0.4, 0.5
    assert found.components == {"start": 0.3, "length": 0.4}
    bare = grade_limit(limit(pantograph=2), GradedValues(values.evaluation), "secondary")
    assert (bare.discretisation_error, bare.spread, bare.uncertainty, bare.limit_uncertainty) == (None, None, None, 0.0)
    assert bare.components == {}


@pytest.mark.parametrize(
    ("item", "pantograph", "name"),
    [
        (None, 0, "std_force_N of the line"),
        (None, 1, "std_force_N of pantograph 1"),
        (3, 2, "std_force_N[3] of pantograph 2"),
    ],
)
def test_name_of_a_criterion(item: int | None, pantograph: int, name: str) -> None:
    requirement = build_requirement("std_force_N", 26.0, 31.0, pantograph=pantograph, item=item)
    assert criterion_name(build_criterion(requirement, 28.0, None, "secondary")) == name
