"""The second pantograph is checked and graded like the first: each fault here is a fault of pantograph 2 alone."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.comparison.profile_grading import assess_record
from pantocheck.conformance.core.criterion import ComponentName
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.grading.assessed_record import AssessedRecord, load_assessed_record
from pantocheck.conformance.quantities.uncertainty import Component, Uncertainty
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals, evaluate_record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.runs.record_checks import check_record


def _scale_second(values: np.ndarray | None, factor: float) -> np.ndarray:
    return values * np.array([[1.0], [factor]])


def _noise(record: Record) -> np.ndarray:
    """Content up to half the rate, 30 N."""
    return 30 * np.random.default_rng(3).standard_normal(record.time.size)


@pytest.mark.parametrize(("stated", "checked"), [(19.999, True), (20.001, True), (20.03, False)])
def test_filter_to_a_thousandth(two_pantograph_case: Case, record: Record, stated: float, checked: bool) -> None:
    """It must be checked, because the suite does not filter again; further above, it does."""
    rough = replace(record, force=record.force + _noise(record), filter_applied_Hz=stated)
    findings = check_record(two_pantograph_case, RecordSignals(rough, two_pantograph_case.file.filter))
    assert (findings["roll-off"].kind != "confirmed") is checked


def test_contact_height_is_that_of_the_pantograph(two_pantograph_case: Case, record: Record) -> None:
    doubled = replace(record, contact_height=_scale_second(record.contact_height, 2.0))
    values = evaluate_record(doubled, two_pantograph_case.file.filter).values
    first, second = (values[number]["contact_height_range_mm"] for number in (1, 2))
    assert second == pytest.approx(2 * first, rel=0.01)


@pytest.fixture
def assessed(two_pantograph_case: Case, wave: Any, tmp_path: Path) -> Callable[..., AssessedRecord]:
    """Assessed record of two pantographs with given standard deviations."""

    def load(*sigma: float, profile: str = "acceptance-ac") -> AssessedRecord:
        records = [wave(sigma=value, rate=250.0).record(two_pantograph_case) for value in sigma]
        rows = np.array([record.force[i] for i, record in enumerate(records)])
        heights = np.array([r.contact_height[i] for i, r in enumerate(records) if r.contact_height is not None])
        record = replace(records[0], force=rows, contact_height=heights, position=records[0].position[: len(sigma)])
        path = write_record(tmp_path / f"{'_'.join(map(str, sigma))}.csv", record)
        return load_assessed_record(path, load_profile(profile), LineTable(span_m=60.0, wave_speed_m_s=120.0))

    return load


def test_assessment_fails_by_the_second_pantograph_alone(assessed: Callable[..., AssessedRecord]) -> None:
    """At most 0.3 of the mean of 119 N is 35.7 N."""
    results = assess_record(assessed(28.0, 38.0), load_profile("acceptance-ac"))
    verdicts = {c.pantograph: c.verdict for c in results.cases[0].criteria if c.quantity == "cov_20"}
    assert verdicts == {1: "pass", 2: "fail"}
    values = {c.pantograph: c.value for c in results.cases[0].criteria if c.quantity == "cov_20"}
    assert values[2] == pytest.approx(38 / 119, rel=0.01)
    limit = Limit(quantity="cov_20", pantograph=1, upper=0.5, trust="primary", source="own")
    results = assess_record(assessed(28.0, 38.0), load_profile("acceptance-ac"), limits=[limit])
    rows = {c.pantograph: (c.upper, c.verdict) for c in results.cases[0].criteria if c.quantity == "cov_20"}
    assert rows == {1: (0.5, "pass"), 2: (0.3, "fail")}


@pytest.mark.parametrize(("subject", "measured"), [((28.0, 29.0), (30.0,)), ((28.0,), (30.0, 31.0))])
def test_records_of_different_trains_are_not_compared(
    assessed: Callable[..., AssessedRecord], subject: tuple[float, ...], measured: tuple[float, ...]
) -> None:
    records = [assessed(*sigma, profile="line-test") for sigma in (subject, measured)]
    with pytest.raises(InputError, match="Compare records of the same train"):
        assess_record(records[0], load_profile("line-test"), measured=records[1])


def test_line_test_compares_every_pantograph(assessed: Callable[..., AssessedRecord]) -> None:
    """The measured deviations are 28 N and 38 N with 20 % of tolerance: 22.4 to 33.6 N and 30.4 to 45.6 N."""
    # A train with the forces exchanged fails at both. The sine of whole spans has its deviation within 1 %.
    profile = load_profile("line-test")
    measured = assessed(28.0, 38.0, profile="line-test")
    for sigma, verdict in (((28.5, 38.5), "pass"), ((38.5, 28.5), "fail")):
        subject = assessed(*sigma, profile="line-test")
        (case,) = assess_record(subject, profile, "provisional", measured).cases
        rows = {c.pantograph: c for c in case.criteria if c.quantity == "std_force_N"}
        assert {number: row.verdict for number, row in rows.items()} == {1: verdict, 2: verdict}
        assert (rows[1].lower, rows[1].upper) == pytest.approx((22.4, 33.6), rel=0.01)
        assert (rows[2].lower, rows[2].upper) == pytest.approx((30.4, 45.6), rel=0.01)


@pytest.mark.parametrize(("sigma", "close"), [(41.0, True), (40.4, False)])
def test_measured_uncertainty_counts(assessed: Callable[..., AssessedRecord], sigma: float, close: bool) -> None:
    """3 N and 4 N make 5 N; 41.0 N and 40.4 N lie 4.6 N and 5.2 N below 45.6 N; pantograph 1 is far from its limits."""
    profile = load_profile("line-test")
    uncertainty = [
        Uncertainty({"length": Component("bootstrap", {1: {"std_force_N": 0.1 * half}, 2: {"std_force_N": half}})})
        for half in (3.0, 4.0)
    ]
    subject = replace(assessed(28.5, sigma, profile="line-test"), uncertainty=uncertainty[0])
    measured = replace(assessed(28.0, 38.0, profile="line-test"), uncertainty=uncertainty[1])
    (case,) = assess_record(subject, profile, "provisional", measured).cases
    rows = {c.pantograph: c for c in case.criteria if c.quantity == "std_force_N"}
    assert (rows[1].verdict, rows[2].verdict) == ("pass", "pass")
    assert rows[1].close == []
    assert ["its uncertainty of 5 N" in remark for remark in rows[2].close] == [True] * close


@pytest.mark.parametrize("name", ["sampling", "resolution", "alignment"])
@pytest.mark.parametrize(("known", "verdict"), [(True, "pass"), (False, "skip")])
def test_measured_value_of_unknown_error_is_no_centre(
    assessed: Callable[..., AssessedRecord], name: ComponentName, known: bool, verdict: str
) -> None:
    """No value passes with an unknown bounded component; a tolerance around such a value decides nothing either."""
    subject, measured = assessed(28.5, 38.5, profile="line-test"), assessed(28.0, 38.0, profile="line-test")
    widths = {1: {"std_force_N": 0.1}, 2: {"std_force_N": 0.1} if known else {}}
    uncertainty = Uncertainty({name: Component("bounds", widths)}, measured.values.values)
    results = assess_record(
        subject, load_profile("line-test"), "provisional", replace(measured, uncertainty=uncertainty)
    )
    rows = {row.pantograph: row for row in results.cases[0].criteria if row.quantity == "std_force_N"}
    assert (rows[1].verdict, rows[2].verdict) == ("pass", verdict)
    reason = f"the uncertainty of the measured value of {measured.name} is not complete: {name} not known"
    assert (rows[2].reason, rows[2].value) == (None if known else reason, pytest.approx(38.5, rel=0.01))
    assert find_discrepancies(results) == []
