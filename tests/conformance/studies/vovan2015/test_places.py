"""Findings of the damping study against the list of places: every statement stands in its section."""

import math
import re
import tomllib

import pytest

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.findings import count_findings, grade_finding
from pantocheck.conformance.core.verdicts import judge
from pantocheck.conformance.line.library_folder import library_folder

LIMITS = [limit for case in select_cases(["vovan2015/*"]) for limit in case.limits if limit.finding is not None]
PLACES = tomllib.loads((library_folder() / "vovan2015" / "places.toml").read_text(encoding="utf-8"))["section"]
SECTIONS = {place["number"]: place for place in PLACES}


def name(limit: Limit) -> str:
    return limit.finding.sentence[:60]


@pytest.mark.parametrize("limit", LIMITS, ids=name)
def test_statement_stands_in_its_section_with_its_figure_or_table(limit: Limit) -> None:
    number, *shown = limit.finding.section.split(", ")
    section = SECTIONS[number]
    assert limit.finding.statement in section["states"]
    for figure in shown:
        assert any(text.startswith(f"{figure} ") for text in section["contains"])


@pytest.mark.parametrize("limit", LIMITS, ids=name)
def test_printed_numbers_of_the_text_stand_in_the_statement(limit: Limit) -> None:
    """Numbers of a table are those of the case; no number is shown as printed that the statement does not print."""
    if limit.finding.section.endswith("Table 1"):
        (case,) = select_cases(["vovan2015/contact-force"])
        printed = {f"{value:.1f}" for table in case.file.study.printed for value in table.values.values()}
        numbers = re.findall(r"(?<![+-])\b\d+\.\d\b(?! %)", limit.finding.printed)
    else:
        printed = set(re.findall(r"\d+(?:e-\d)?(?:\.\d+)?", limit.finding.statement)) | {"0.9", "0.5"}
        numbers = (
            [] if limit.finding.printed == "none" else re.findall(r"\d+(?:\.\d+)?(?:e-\d)?", limit.finding.printed)
        )
    assert set(numbers) <= printed, numbers


def test_every_statement_has_a_finding() -> None:
    stated = {text for place in PLACES for text in place.get("states", [])}
    graded = {limit.finding.statement for limit in LIMITS}
    # The model with modal damping is an input: its number of bands is the statement.
    assert stated - graded == {"one modal damping per group for the first two groups, the median identified"}


def test_an_inference_is_no_criterion_and_is_counted_apart() -> None:
    inferred = [limit for limit in LIMITS if limit.finding.role == "inferred"]
    assert {limit.trust for limit in inferred} == {"provisional"}
    (limit,) = (limit for limit in inferred if limit.quantity == "damping_gain_ratio")
    graded = [grade_finding(limit.finding, judge(value, limit.lower, limit.upper)) for value in (20.0, 3.0)]
    assert [finding.outcome for finding in graded] == ["inferred_met", "inferred_not_met"]
    counts = count_findings(graded)
    assert (counts.inferred_met, counts.inferred_not_met, counts.reproduced, counts.not_reproduced) == (1, 1, 0, 0)


ONSETS_AND_ENDS = {
    "dropper_transition_start_s": 1e-4,
    "dropper_transition_end_s": 1e-2,
    "damping_gain_end_Hz": 12.0,
    "group_merging_Hz": 5.0,
}
"""Printed onsets and ends."""


@pytest.mark.parametrize("quantity", ONSETS_AND_ENDS)
def test_bounds_of_an_onset_or_end_are_a_factor_of_three_around_the_printed_number(quantity: str) -> None:
    (limit,) = (limit for limit in LIMITS if limit.quantity == quantity)
    printed = ONSETS_AND_ENDS[quantity]
    assert (limit.lower, limit.upper) == pytest.approx((printed / 3, 3 * printed), rel=0.02)


def test_no_two_bounds_are_wider_than_a_factor_of_three_on_both_sides() -> None:
    """Bounds of a sign begin at zero; others with two sides span at most a factor of nine."""
    for limit in LIMITS:
        if limit.lower and limit.upper and limit.lower > 0:
            assert math.log(limit.upper / limit.lower) <= 2 * math.log(3.05), limit.quantity
