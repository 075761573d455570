"""Section spread: known for a known force, and stored beside the value."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.wave_system import Wave, cut_bare
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.record_uncertainty import section_spread
from pantocheck.conformance.pages.quantity_tables import build_quantity_table
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals, evaluate_record
from pantocheck.conformance.runs.system import Delivered


@pytest.fixture
def growing(case_250: Case, wave: type[Wave]) -> tuple[Case, Record]:
    """The case with shifted analysis sections, and a record whose mean force grows by 1 N per span."""
    case = replace(case_250, file=case_250.file.model_copy(update={"compared_spans": (3, 8)}))
    record = wave().record(case)
    return case, replace(record, force=record.force + record.position / case.line.geometry.span_m)


def test_spread_is_the_largest_difference_over_shifted_sections(growing: tuple[Case, Record]) -> None:
    case, _ = growing
    assert case.analysis_section == (240.0, 360.0)
    assert case.shifted_sections == tuple((60.0 * n, 60.0 * (n + 2)) for n in (2, 3, 4, 5, 6))
    assert case.recorded_section == (120.0, 480.0)
    assert case.end >= 480.0
    # Spans 3-4 to 7-8 about 5-6: two spans, 2 N, either way; a sample of 0.07 m more or less gives 1e-3 N.
    case, record = growing
    spread = section_spread(RecordSignals(record, case.file.filter), case.shifted_sections)
    assert spread[1]["mean_force_N"] == pytest.approx(2.0, abs=5e-3)
    assert spread[1]["contact_loss_pct"] == 0.0
    case, record = growing
    inside = (record.position[0] >= 200) & (record.position[0] < 400)
    short = cut_bare(record, inside)
    assert section_spread(RecordSignals(short, case.file.filter), case.shifted_sections) == {}


def test_value_closer_to_a_limit_than_the_spread_is_marked(growing: tuple[Case, Record]) -> None:
    case, record = growing
    value = evaluate_record(record, case.file.filter).values[1]["mean_force_N"]
    limit = Limit(quantity="mean_force_N", lower=value - 1.0, upper=value + 50, trust="secondary", source="test")
    result = grade_case(replace(case, limits=(limit,)), Delivered(record), "secondary")
    (row,) = result.criteria
    assert row.spread == result.spread["1"]["mean_force_N"]
    # 2 N from the sections that the case compares, after a short run-in; 1.25 times 0.75 N from parts of a span.
    assert row.components == pytest.approx(
        {"start": 2.0, "section": 1.25 * 0.75, "sampling": 0.0, "resolution": 0.0}, abs=5e-3
    )
    assert any("less than its uncertainty of 2.2 N (mostly start)" in remark for remark in row.close)
    table = build_quantity_table(result)
    mean = next(row for row in table.rows if "mean_force_N" in str(row[0]))
    assert (table.columns[-1].heading, mean[-1]) == ("Shift", "2.0")


def test_case_without_compared_spans_has_no_spread(case_250: Case, wave: type[Wave]) -> None:
    result = grade_case(case_250, Delivered(wave().record(case_250)), "secondary")
    assert result.spread == {}
    assert all(row.spread is None for row in result.criteria)
    assert np.isfinite([row.value for row in result.criteria]).all()
