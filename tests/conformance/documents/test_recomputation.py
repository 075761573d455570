"""Recomputation: correct numbers are accepted up to their rounding, and each wrong number is named."""

from typing import Any

import pytest

from helpers.criterion_fixtures import build_requirement
from pantocheck.conformance.documents.recomputation import check_components, find_discrepancies
from pantocheck.conformance.documents.verification import find_gaps
from pantocheck.conformance.results.results_format import Results


def recompute(results: dict[str, Any]) -> list[str]:
    """Discrepancies of results."""
    return find_discrepancies(Results.model_validate(results))


@pytest.fixture
def ungraded(passing: dict[str, Any]) -> dict[str, Any]:
    """Two pantographs without criteria, so that one changed number can contradict only the numbers around it."""
    case = passing["cases"][0]
    verdicts = {"verdict": "info", "criteria_verdict": "info"}
    case |= {"criteria": []} | verdicts
    return passing | verdicts


BANDS = ["rms_0_5_N", "rms_5_20_N", "rms_20_50_N"]
STATISTICS = ["statistical_min_N", "statistical_max_N", "cov_20", "cov_50"]

SCALED = {
    # Amplitudes and traces with six digits give RMS values, mean and deviation within 2e-5.
    "bands follow from the spectrum": ("quantities", dict(zip(BANDS, BANDS, strict=True)), 1e-5, 4e-5),
    "statistics follow exactly": ("quantities", dict(zip(STATISTICS, STATISTICS, strict=True)), 1e-10, 1e-7),
    "drawn levels": ("traces", {"mean_N": "mean_force_N", "std_N": "std_force_N"}, 1e-5, 4e-5),
}
"""Part of a case, its numbers with the quantities of the messages, an accepted change and one that is found [-]."""


@pytest.mark.parametrize("pantograph", ["1", "2"])
@pytest.mark.parametrize("relation", SCALED)
def test_numbers_that_follow_from_others(ungraded: dict[str, Any], relation: str, pantograph: str) -> None:
    part, names, accepted, wrong = SCALED[relation]
    numbers = ungraded["cases"][0][part][pantograph]
    for name, quantity in names.items():
        stated = numbers[name]
        for change in (accepted, -accepted, wrong, -wrong):
            numbers[name] = stated * (1 + change)
            texts = recompute(ungraded)
            assert len(texts) == (abs(change) == wrong), (name, change, texts)
            assert all(f"pantograph {pantograph}: {quantity}" in text for text in texts)
            assert all("follows from the spectrum" in text for text in texts if name in BANDS)
        numbers[name] = stated


@pytest.mark.parametrize("pantograph", ["1", "2"])
@pytest.mark.parametrize(("name", "sign"), [("max_force_N", 1), ("min_force_N", -1)])
@pytest.mark.parametrize(("share", "found"), [(1e-5, 0), (1e-4, 1), (-1e-4, 0)])
def test_drawn_force_stays_within_its_extremes(
    ungraded: dict[str, Any], pantograph: str, name: str, sign: int, share: float, found: int
) -> None:
    """Drawn beyond the stated extreme by a share of the largest force; 2e-5 are allowed for its six digits."""
    case = ungraded["cases"][0]
    case["traces"][pantograph]["histogram"] = None  # it has a check of its own
    force = case["traces"][pantograph]["force_20_N"]
    extreme = max(force) if sign > 0 else min(force)
    case["quantities"][pantograph][name] = extreme - sign * share * max(force)
    texts = recompute(ungraded)
    assert len(texts) == found
    assert all(f"pantograph {pantograph}: {name}" in text and "drawn" in text for text in texts)


def test_quantity_that_is_not_delivered_contradicts_nothing_and_hides_nothing(ungraded: dict[str, Any]) -> None:
    """A missing mean does not hide a wrong band."""
    quantities = ungraded["cases"][0]["quantities"]["2"]
    names = ("mean_force_N", "std_force_N", "std_force_50_N", *STATISTICS, *BANDS, "max_force_N", "min_force_N")
    for gone in (*names, "contact_loss_pct"):
        value = quantities.pop(gone)
        assert recompute(ungraded) == [], gone
        quantities[gone] = value
    del quantities["mean_force_N"], quantities["std_force_N"]
    quantities["rms_0_5_N"] *= 1.1
    assert len(recompute(ungraded)) == 1


def test_mean_without_contact_has_no_coefficient_of_variation(ungraded: dict[str, Any]) -> None:
    """A mean of zero: the quotient is not defined, and any stated one is left to the graded record."""
    case = ungraded["cases"][0]
    case["traces"]["2"] |= {"force_20_N": None, "histogram": None}
    quantities = case["quantities"]["2"]
    for name, value in (("mean_force_N", 0.0), ("statistical_min_N", -3.0), ("statistical_max_N", 3.0)):
        quantities[name] = value
    quantities["std_force_N"] = case["traces"]["2"]["std_N"] = 1.0
    case["traces"]["2"]["mean_N"] = 0.0
    assert recompute(ungraded) == []


@pytest.mark.parametrize(
    ("frequency", "amplitude", "checked"),
    [
        ([1.0, 2.0, 3.0, 4.0], [3.0, 0.0, 4.0, 0.0], True),
        ([0.0, 1.0, 2.0, 3.0], [7.0, 3.0, 0.0, 4.0], True),  # the mean belongs to no band
        ([1.0, 2.0, 3.0, 4.1], [3.0, 0.0, 4.0, 0.0], False),  # a line is missing: the curve was thinned
        ([1.0, 2.0, 3.0, 4.0001], [3.0, 0.0, 4.0, 0.0], False),
        ([1.0, 2.0, 3.0, 4.00002], [3.0, 0.0, 4.0, 0.0], True),  # six digits
        ([1.0], [5.0], False),
        ([], [], False),
        ([1.0, 3.0, 5.0, 7.0], [3.0, 4.0, 0.0, 0.0], False),  # a line on the edge of 5 Hz
        ([1.0, 2.9999, 4.9998, 6.9997], [3.0, 4.0, 0.0, 0.0], True),
        ([1.0, 2.99996, 4.99992, 6.99988], [3.0, 4.0, 0.0, 0.0], False),  # 8e-5 Hz from 5 Hz; rounding moves it by 1e-4
    ],
)
def test_band_is_checked_only_with_all_its_lines(
    ungraded: dict[str, Any], frequency: list[float], amplitude: list[float], checked: bool
) -> None:
    """Amplitudes of 3 N and 4 N below 5 Hz: an RMS of 5 / sqrt(2) N; stated is another one."""
    case = ungraded["cases"][0]
    case["traces"]["2"]["spectrum"] = {"frequency_Hz": frequency, "amplitude_N": amplitude}
    for name in BANDS[1:]:
        del case["quantities"]["2"][name]
    case["quantities"]["2"]["rms_0_5_N"] = 3.0
    texts = recompute(ungraded)
    assert len(texts) == checked
    case["quantities"]["2"]["rms_0_5_N"] = 12.5**0.5
    assert recompute(ungraded) == []


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ({}, False),
        ({"record": None}, True),
        ({"record": None, "run.evaluated_m": None}, False),  # a static case
        ({"record": None, "verdict": "skip", "reason": "not run"}, False),
        ({"record": None, "verdict": "error", "reason": "diverged"}, False),
        ({"record": None, "verdict": "skip", "reason": None}, True),
        ({"record": None, "verdict": "info", "reason": "not run"}, True),
    ],
)
def test_record_of_a_passage_has_a_state(ungraded: dict[str, Any], changes: dict[str, Any], found: bool) -> None:
    case = ungraded["cases"][0]
    for key, value in changes.items():
        (case["run"] if key.startswith("run.") else case)[key.removeprefix("run.")] = value
    gaps = find_gaps(Results.model_validate(ungraded))
    assert any("the state of the record is missing" in text for text in gaps) is found


def test_criterion_without_a_limit_needs_no_components(ungraded: dict[str, Any]) -> None:
    """A rule of a profile whose limit the record does not state: its value has an uncertainty, the criterion none."""
    case = ungraded["cases"][0]
    row = build_requirement("mean_force_N", None, None, pantograph=1).model_dump()
    value = case["quantities"]["1"]["mean_force_N"]
    case["criteria"] = [
        row | {"value": value, "verdict": "skip", "margin": None, "discretisation_error": None, "reason": "no limit"}
    ]
    gaps = find_gaps(Results.model_validate(ungraded))
    assert not any("components" in gap for gap in gaps)


@pytest.mark.parametrize(("start", "key"), [("differs", "warnings"), ("not stated", "notes")])
def test_remark_on_the_start_stands_at_its_place(ungraded: dict[str, Any], start: str, key: str) -> None:
    """A start that differs is a warning; a reader of the warnings alone must not miss it."""
    case = ungraded["cases"][0]
    case["record"] |= {"start": start, "start_text": "Another start."}
    for texts, missing in (([], True), (["Another start."], False)):
        case[key] = texts
        gaps = find_gaps(Results.model_validate(ungraded))
        assert any("the remark on the start of the record is missing" in text for text in gaps) is missing


def test_extremes_of_a_long_record_state_no_mean(ungraded: dict[str, Any]) -> None:
    """Samples above the mean alone, at uneven places: a curve of extremes has another mean than its record."""
    trace = ungraded["cases"][0]["traces"]["2"]
    kept = [n for n, force in enumerate(trace["force_20_N"]) if force > trace["mean_N"]]
    trace |= {key: [trace[key][n] for n in kept] for key in ("position_m", "force_N", "force_20_N")}
    trace["histogram"] = None
    assert recompute(ungraded) == []


def test_results_without_cases_lack_the_verdict_of_the_criteria(ungraded: dict[str, Any]) -> None:
    """It may be absent only if every case, and there is one, takes part in the verification alone."""
    ungraded["criteria_verdict"] = None
    only = {**ungraded, "verification_only": [case["id"] for case in ungraded["cases"]]}
    for results, missing in ((ungraded, True), (only, False), ({**ungraded, "cases": []}, True)):
        gaps = find_gaps(Results.model_validate(results))
        assert ("criteria_verdict is missing" in gaps) is missing


def test_curve_has_the_stated_mean_and_deviation(ungraded: dict[str, Any]) -> None:
    """The drawn force alone is changed: by 3 N in the mean, or by half in its deviation."""
    trace = ungraded["cases"][0]["traces"]["2"]
    drawn, mean = trace["force_20_N"], trace["mean_N"]
    for offset, factor in ((3.0, 1.0), (0.0, 1.5)):
        trace["force_20_N"] = [mean + offset + factor * (force - mean) for force in drawn]
        assert any("follow from the drawn curve" in text for text in recompute(ungraded)), (offset, factor)


def test_quantities_of_the_line_follow_from_each_other(ungraded: dict[str, Any]) -> None:
    """Case of 250 km/h; alpha of 0.4 and the Doppler factor (c - v) / (c + v) give their quotient."""
    line = ungraded["cases"][0]["quantities"]["0"]
    speed, wave = 250 / 3.6, line["wave_speed_m_s"]
    doppler = (wave - speed) / (wave + speed)
    line |= {"doppler_factor": doppler, "reflection_coefficient": 0.4}
    for amplification, found in ((0.4 / doppler, 0), (0.41 / doppler, 1)):
        line["amplification_coefficient"] = amplification
        assert len(recompute(ungraded)) == found
    del line["reflection_coefficient"]
    assert recompute(ungraded) == []


def test_components_belong_to_every_row_with_a_limit(passing: dict[str, Any]) -> None:
    """A row with one limit is checked as one with two; a drift and a row without limits have no components."""
    row = Results.model_validate(passing).cases[0].criteria[0].model_copy(update={"components": {}})
    reported = {str(row.pantograph): {row.quantity: {"start": 1.0}}}
    for changes, found in (
        ({}, 1),
        ({"lower": None}, 1),
        ({"upper": None}, 1),
        ({"lower": None, "upper": None}, 0),
        ({"baseline": 1.0}, 0),
    ):
        assert len(list(check_components(row.model_copy(update=changes), reported, ("start",)))) == found, changes


def test_minimum_above_maximum_is_found_without_samples(ungraded: dict[str, Any]) -> None:
    """A summary has no curve; its printed statistics may be rounded, but not in the wrong order."""
    case = ungraded["cases"][0]
    case["traces"] = {}
    case["run"]["rate_Hz"] = None
    case["quantities"]["1"]["cov_20"] *= 1.01
    assert recompute(ungraded) == []
    case["quantities"]["2"] |= {"min_force_N": 100.0, "max_force_N": 100.0}
    assert recompute(ungraded) == []
    case["quantities"]["2"]["min_force_N"] = 100.5
    assert recompute(ungraded) == ["en50318-2002/250, pantograph 2: min_force_N 100.5 above max_force_N 100"]


def test_item_of_a_list_is_compared_with_its_own_value(passing: dict[str, Any]) -> None:
    """Dropper lengths of the line: item 2, no item for the first, and an item that was not reported."""
    case = passing["cases"][0]
    case["quantities"]["0"]["dropper_length_m"] = [1.017, 0.896]
    row = case["criteria"][0]
    row |= {"quantity": "dropper_length_m", "pantograph": 0, "unit": "m", "lower": 0.5, "upper": 1.5, "spread": None}
    row |= {"discretisation_error": None, "uncertainty": None, "components": {}}
    for item, value, consistent in ((2, 0.896, True), (None, 1.017, True), (1, 1.017, True), (2, 1.017, False),
                                    (3, 0.896, False), (None, 0.896, False)):  # fmt: skip
        row |= {"item": item, "value": value, "margin": 2 * min(value - 0.5, 1.5 - value)}
        assert (recompute(passing) == []) is consistent


def test_width_of_a_joint_sample_may_differ_by_the_rounding_of_its_draws(ungraded: dict[str, Any]) -> None:
    """Draws are rounded to 1e-5 of the value: components of zero leave room for half of it, and not for its double."""
    case = ungraded["cases"][0]
    value = case["quantities"]["1"]["mean_force_N"]
    case["uncertainty_components"]["1"]["mean_force_N"] = {"discretisation": 0.0, "start": 0.0}
    for share, wrong in ((0.5e-5, 0), (2e-5, 1)):
        case["uncertainty"]["1"]["mean_force_N"] = share * value
        assert len(recompute(ungraded)) == wrong, share
