"""Findings of a publication beside computed values: as a case's limits grade them."""

import math

import pytest

from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.studies.vovan2015.findings_table import build_findings_table

CHANGE = Limit(quantity="change_rms_0_5_pct", upper=0.0, trust="primary", source="test", note="less below 5 Hz")
SECOND = Limit(quantity="mode_frequency_Hz", item=2, lower=1.0, upper=2.0, trust="primary", source="test")


def row(limit, value):
    of = {limit.owner: {limit.quantity: value}}
    (found,) = build_findings_table([limit], of, {}).rows
    return found[2:]


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_value_that_is_no_number_is_not_evaluated(value):
    """Graded it is skipped: the table must not call it reproduced, or not."""
    assert row(CHANGE, value) == ["-", "not evaluated"]
    assert row(SECOND, (1.5, value)) == ["-", "not evaluated"]


def test_values_inside_and_outside_a_limit():
    assert row(CHANGE, -3.0) == ["-3 %", "reproduced"]
    assert row(CHANGE, 3.0) == ["3 %", "not reproduced"]
    assert row(SECOND, (0.5, 1.5)) == ["1.5 Hz", "reproduced"]
    assert row(SECOND, (1.5,)) == ["-", "not evaluated"]
