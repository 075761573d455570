"""Tables of a study: findings graded like the limits of the case, and the origin of every limit."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.studies.vovan2015 import line_damping
from pantocheck.conformance.studies.vovan2015.study_report import build_findings_table, build_provenance_table

CHANGE = Limit(quantity="change_rms_0_5_pct", upper=0.0, trust="primary", source="test", note="less below 5 Hz")
SECOND = Limit(quantity="mode_frequency_Hz", item=2, lower=1.0, upper=2.0, trust="primary", source="test")


def computed_and_agreement(limit: Limit, value: Value) -> list[str]:
    (row,) = build_findings_table([limit], {limit.owner: {limit.quantity: value}}, {}).rows
    return row[2:]


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_finding_without_finite_value_is_not_evaluated(value: float) -> None:
    """The criterion of such a value is skipped, so the table calls it neither reproduced nor not reproduced."""
    assert computed_and_agreement(CHANGE, value) == ["-", "not evaluated"]
    assert computed_and_agreement(SECOND, (1.5, value)) == ["-", "not evaluated"]


def test_finding_is_reproduced_inside_its_limit() -> None:
    assert computed_and_agreement(CHANGE, -3.0) == ["-3 %", "reproduced"]
    assert computed_and_agreement(CHANGE, 3.0) == ["3 %", "not reproduced"]
    assert computed_and_agreement(SECOND, (0.5, 1.5)) == ["1.5 Hz", "reproduced"]
    assert computed_and_agreement(SECOND, (1.5,)) == ["-", "not evaluated"]


def limit_rows(case: Case) -> list[list[str]]:
    return [row for row in build_provenance_table(case).rows if row[0].startswith("limit of")]


@pytest.mark.parametrize(
    ("source", "trust", "origin"),
    [
        ("vovan2015", "primary", "printed in the paper"),
        (["vovan2015", "assumed"], "primary", "printed in the paper"),
        ("own", "primary", "published elsewhere"),
        (["wang2016"], "primary", "published elsewhere"),
        ("wang2016", "secondary", "published elsewhere"),
        ("vovan2015 as I read it", "primary", "published elsewhere"),
        ("own", "provisional", "assumed"),
        ("vovan2015", "provisional", "assumed"),
    ],
)
def test_limit_is_printed_in_the_paper_of_its_source(source: str | list[str], trust: Trust, origin: str) -> None:
    """Limits that a user puts in place of those of a study may be primary without being printed in its paper."""
    (case,) = select_cases(["vovan2015/contact-force"])
    limit = Limit(quantity="change_rms_0_5_pct", upper=0.0, trust=trust, source=source)
    (row,) = limit_rows(replace(case, limits=(limit,)))
    assert row[:2] == ["limit of change_rms_0_5_pct", origin]


@pytest.mark.parametrize("pattern", ["vovan2015/contact-force", "vovan2015/mass-drop/printed"])
def test_primary_limits_of_the_library_are_printed_in_the_paper(pattern: str) -> None:
    (case,) = select_cases([pattern])
    expected = ["printed in the paper" if limit.trust == "primary" else "assumed" for limit in case.limits]
    assert [row[1] for row in limit_rows(case)] == expected


# Damping of a line: every drop is simulated once, and damping ratios are drawn in percent.


def test_every_drop_of_a_case_is_simulated_and_identified(monkeypatch: pytest.MonkeyPatch) -> None:
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    monkeypatch.setattr(
        line_damping, "simulate_drop", lambda case, number, line: SimpleNamespace(record=f"record {number}")
    )
    monkeypatch.setattr(line_damping, "identify_modes", lambda records, highest: [(records, highest)])
    identified = line_damping.identify_drops(case)
    assert len(identified.drops) == 3
    assert identified.identification == (("record 1", "record 2", "record 3"), case.file.mass_drop.highest_Hz)


def test_damping_ratios_are_drawn_in_percent_with_intervals_of_95_percent() -> None:
    """Half an interval has 1.96 standard deviations."""
    modes = [
        Mode(frequency_Hz=f, damping_ratio=ratio, damping_ratio_std=deviation, sensor_shape=())
        for f, ratio, deviation in ((1.0, 0.02, 0.001), (2.5, 0.0125, 0.0005))
    ]
    series = line_damping.draw_damping_ratios("identified", modes)
    assert (series.label, series.x, series.y) == ("identified", [1.0, 2.5], [2.0, 1.25])
    assert series.error == [0.196, 0.098]
