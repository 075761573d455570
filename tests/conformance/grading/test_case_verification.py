"""Verification of a case: limits from converged values, and a verdict apart from the EN 50318 criteria."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from helpers.converged_fixtures import StateConverged, build_converged
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.trust import LEVELS, decides_verdict
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.case_verification import (
    VERIFIED_QUANTITIES,
    build_requirements,
    include_start,
    tolerance,
)
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.system import Delivered, Errored, Skipped

Values = dict[int, dict[str, float]]
UPLIFT, EXTENDED = (0, "max_uplift_at_support_mm"), (2, "rms_20_50_N")


@pytest.fixture
def twin(two_pantograph_case: Case) -> Case:
    """Two pantographs without limits, so that the verification alone gives a verdict."""
    return replace(two_pantograph_case, limits=())


@pytest.fixture
def record(twin: Case) -> Record:
    return Wave().record(twin)


@pytest.fixture
def values(twin: Case, record: Record) -> Values:
    """Verified quantities of that record."""
    evaluation = CaseEvaluation(twin, Delivered(record)).evaluation
    return {
        owner: {name: float(value) for name, value in quantities.items() if name in VERIFIED_QUANTITIES}
        for owner, quantities in evaluation.values.items()
    }


def grade(case: Case, record: Record) -> CaseResult:
    return grade_case(case, Delivered(record, case_digest=case.digest), "secondary")


def change(values: Values, target: tuple[int, str], value: float) -> Values:
    owner, name = target
    return values | {owner: values[owner] | {name: value}}


def verdict(result: CaseResult) -> str | None:
    return None if result.verification is None else result.verification.verdict


@pytest.mark.parametrize(
    ("quantity", "value", "mean", "expected"),
    [
        ("mean_force_N", 120.0, 120.0, 1.2),
        ("std_force_N", 30.0, 120.0, 1.5),
        ("rms_0_5_N", 20.0, 120.0, 0.6),
        ("rms_5_20_N", 20.0, 120.0, 1.0),
        ("rms_20_50_N", 10.0, 120.0, 1.0),
        ("max_uplift_at_support_mm", 60.0, None, 3.0),
        ("elasticity_mm_N", 0.5, None, 0.015),
        ("elasticity_non_uniformity_pct", 30.0, None, 0.9),
        ("max_force_N", 180.0, 120.0, 3.0),
        ("min_force_N", 50.0, 120.0, 3.5),
        ("statistical_max_N", 210.0, 120.0, 4.5),
        ("statistical_min_N", -30.0, 120.0, 7.5),
    ],
)
def test_tolerance_by_hand(quantity: str, value: float, mean: float | None, expected: float) -> None:
    """1 % of the mean, 3 % below 5 Hz, 5 % to 20 Hz, 10 % to 50 Hz; extremes by their distance from the mean."""
    assert tolerance(quantity, value, mean) == pytest.approx(expected, rel=1e-12)


def test_tolerance_of_an_extreme_needs_the_mean_and_computed_limits_their_trust() -> None:
    with pytest.raises(ValueError, match="max_force_N needs a mean"):
        tolerance("max_force_N", 180.0, None)
    assert "computed" not in LEVELS
    assert not any(decides_verdict("computed", level) or decides_verdict(level, "computed") for level in LEVELS)
    assert decides_verdict("computed", "computed")


def test_values_at_rest_or_of_the_passage_limit_their_own_cases_only(twin: Case) -> None:
    converged = build_converged(twin, {1: {"mean_force_N": 120.0, "min_force_N": 50.0}, 2: {"rms_20_50_N": 10.0}})
    limits = {(entry.pantograph, entry.quantity): entry for entry in build_requirements(converged, is_static=False)}
    mean, low, band = limits[1, "mean_force_N"], limits[1, "min_force_N"], limits[2, "rms_20_50_N"]
    assert (mean.lower, mean.upper) == (pytest.approx(120 - 0.12 - 1.2), pytest.approx(120 + 0.12 + 1.2))
    assert (low.lower, low.upper) == (pytest.approx(50 - 0.05 - 3.5), pytest.approx(50 + 0.05 + 3.5))
    assert (band.lower, band.upper) == (pytest.approx(10 - 0.01 - 1), pytest.approx(10 + 0.01 + 1))
    assert {entry.trust for entry in limits.values()} == {"computed"}
    assert "finite differences" in mean.source
    # A record of a passage has no quantities of the line at rest: they would be skipped in every record.
    converged = build_converged(twin, {0: {"elasticity_mm_N": 0.5, "max_uplift_at_support_mm": 50.0}})
    assert [entry.quantity for entry in build_requirements(converged, is_static=True)] == ["elasticity_mm_N"]
    assert [entry.quantity for entry in build_requirements(converged, is_static=False)] == ["max_uplift_at_support_mm"]


def test_missing_values(state_converged: StateConverged, twin: Case, record: Record, values: Values) -> None:
    assert grade(twin, record).verification is None
    assert grade_case(twin, Errored("reason"), "secondary").verification is None
    state_converged(twin, values, case_digest="sha256:0")
    result = grade(twin, record)
    assert (verdict(result), result.verification.criteria) == ("info", [])
    assert result.verification.reason == "the converged values belong to another version of this case"
    omitted = [{"quantity": "rms_20_50_N", "pantograph": 1, "reason": "the formulations differ by 2 %"}]
    state_converged(twin, {}, omitted=omitted)
    result = grade(twin, record)
    assert verdict(result) == "info"
    assert result.verification.omitted == ["rms_20_50_N of pantograph 1: the formulations differ by 2 %"]


def test_verified_record_passes(state_converged: StateConverged, twin: Case, record: Record, values: Values) -> None:
    state_converged(twin, values)
    result = grade(twin, record)
    assert verdict(result) == "pass", result.verification
    assert (result.criteria_verdict, result.criteria) == ("info", [])
    assert {(row.pantograph, row.quantity) for row in result.verification.criteria} == {
        (owner, name) for owner, quantities in values.items() for name in quantities
    }
    assert result.verification.confirmed_by == "finite differences"
    state_converged(twin, values)
    assert verdict(grade(twin, replace(record, contact_height=None))) == "unconfirmed"
    contradicted = grade(twin, replace(record, contact_height=2 * record.contact_height))
    assert (contradicted.criteria_verdict, verdict(contradicted)) == ("error", "error")
    assert contradicted.verification.criteria == []
    # The converged solution has the same section, so that another section says nothing about the difference.
    state_converged(twin, values)
    sections = replace(twin, file=twin.file.model_copy(update={"compared_spans": (3, 8)}))
    state_converged(sections, values)
    rows = grade(sections, replace(record, evaluated=sections.analysis_section)).verification.criteria
    assert {row.spread for row in rows} == {None}


@pytest.mark.parametrize(
    ("owner", "name"), [UPLIFT, EXTENDED, (1, "rms_0_5_N"), (2, "std_force_N"), (1, "min_force_N")]
)
def test_every_verified_quantity_of_every_pantograph_can_fail(
    state_converged: StateConverged, twin: Case, record: Record, values: Values, owner: int, name: str
) -> None:
    """A converged value 20 % off exceeds the widest tolerance, 10 %; a sine has next to nothing in the upper bands."""
    state_converged(twin, change(values, (owner, name), max(1.2 * values[owner][name], 1.0)))
    result = grade(twin, record)
    assert verdict(result) == "fail"
    assert [(row.pantograph, row.quantity) for row in result.verification.criteria if row.verdict == "fail"] == [
        (owner, name)
    ]


@pytest.mark.parametrize(("outcome", "expected"), [(Skipped("not supported"), "skip"), (Errored("crash"), "error")])
def test_case_without_a_result_is_not_verified(
    state_converged: StateConverged, twin: Case, values: Values, outcome: Skipped | Errored, expected: str
) -> None:
    state_converged(twin, values)
    result = grade_case(twin, outcome, "secondary")
    assert (verdict(result), result.verification.reason) == (expected, outcome.reason)


def remove(record: Record, parts: tuple[str, ...]) -> Record:
    """Record without some of its parts."""
    for part in parts:
        match part:
            case "height":
                record = replace(record, contact_height=None)
            case "uplift":
                record = replace(record, support_position=None, support_uplift=None)
            case "support":
                if record.support_position is not None:
                    kept = record.support_position != 300.0
                    position, uplift = record.support_position[kept], record.support_uplift[kept]
                    record = replace(record, support_position=position, support_uplift=uplift)
            case "samples":
                n = int(np.searchsorted(record.position[1], 350.0))
                rows = ("position", "force", "contact_height", "support_uplift")
                changes = {k: v[:, :n] for k in rows if (v := getattr(record, k)) is not None}
                record = replace(record, time=record.time[:n], **changes)
            case "pantograph":
                rows = ("position", "force", "contact_height")
                record = replace(record, **{k: v[:1] for k in rows if (v := getattr(record, k)) is not None})
            case "rate":
                rows = ("position", "force", "contact_height", "support_uplift")
                changes = {k: v[:, ::4] for k in rows if (v := getattr(record, k)) is not None}
                record = replace(record, time=record.time[::4], **changes)
    return record


PARTS = ("height", "support", "uplift", "rate", "samples", "pantograph")


@pytest.mark.parametrize("wrong", [UPLIFT, EXTENDED])
def test_removing_information_never_verifies_a_record(
    state_converged: StateConverged, twin: Case, record: Record, values: Values, wrong: tuple[int, str]
) -> None:
    """Every combination of removed parts; the wrong quantity is one that a removal can make unavailable."""
    state_converged(twin, change(values, wrong, 2 * values[wrong[0]][wrong[1]] + 1))
    assert verdict(grade(twin, record)) == "fail"
    for count in (1, 2, 3):
        for parts in combinations(PARTS, count):
            assert verdict(grade(twin, remove(record, parts))) != "pass", parts


def test_limits_of_the_case_never_change_the_verification(
    state_converged: StateConverged, two_pantograph_case: Case, record: Record, values: Values
) -> None:
    """Limits that fail and limits that pass: the verification is that of the converged values alone."""
    state_converged(two_pantograph_case, values)
    with_limits, without = (
        grade(case, record) for case in (two_pantograph_case, replace(two_pantograph_case, limits=()))
    )
    assert with_limits.verification == without.verification
    assert {row.trust for row in with_limits.criteria} == {"secondary"}


def test_start_widens_a_limit_by_its_half_width_and_no_more(twin: Case) -> None:
    """A false statement can move a verdict by the stored change of the value with the start only."""
    converged = build_converged(twin, {1: {"std_force_N": 30.0, "min_force_N": 50.0, "mean_force_N": 120.0}})
    widths = {"std_force_N": 1.1, "min_force_N": 3.6, "mean_force_N": None}
    value = tuple(v.model_copy(update={"start_half_width": widths[v.quantity]}) for v in converged.value)
    converged = converged.model_copy(update={"value": value})
    for limit in build_requirements(converged, is_static=False):
        other = include_start(limit, converged)
        width = widths[limit.quantity] or 0.0
        assert (other.lower, other.upper) == (limit.lower - width, limit.upper + width)


def test_other_start_widens_limits(twin: Case, record: Record, values: Values, state_converged: StateConverged) -> None:
    """A force beyond 10 % in 20-50 Hz passes with another start whose half-width reaches it, and only then."""
    # The certificate names the statement beside every widened limit, and where a criterion needs it.
    true = values[2]["rms_20_50_N"]
    converged = state_converged(twin, change(values, EXTENDED, true / 1.2))
    known = converged.model_copy(
        update={"value": tuple(v.model_copy(update={"start_half_width": 0.2 * v.value}) for v in converged.value)}
    )
    expected = twin.start_table
    other = expected.model_copy(update={"place_m": expected.place_m + 5.0})
    verdicts, named, widened = {}, {}, {}
    for name, file in (("unknown", converged), ("known", known)):
        state_converged(twin, change(values, EXTENDED, true / 1.2), value=[v.model_dump() for v in file.value])
        for start in (None, expected, other):
            delivered = Delivered(record, case_digest=twin.digest, start=start)
            result = grade_case(twin, delivered, "secondary")
            verdicts[name, start], rows = result.verification.verdict, result.verification.criteria
            named[name, start] = {row.quantity for row in rows if "which is not checked" in (row.reason or "")}
            widened[name, start] = {row.quantity for row in rows if "widened for the start" in row.source}
    # Only the criterion that needs the statement has the remark; every widened limit names the statement.
    assert {key: names for key, names in named.items() if names} == {("known", other): {EXTENDED[1]}}
    assert {key for key, names in widened.items() if names} == {("known", other)}
    assert widened["known", other] == set(VERIFIED_QUANTITIES) - {"elasticity_mm_N", "elasticity_non_uniformity_pct"}
    assert [key for key, value in verdicts.items() if value == "pass"] == [("known", other)]
    assert set(verdicts.values()) == {"pass", "fail"}
