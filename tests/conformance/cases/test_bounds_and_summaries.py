"""Edges of bounds, and summaries of another run: each value here lies just on the wrong side."""

import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.profile_file import BoundMissing, NamedBound, Rule, SpeedFormula, resolve_bounds
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record import Record, RecordInvalid
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.system import Errored

SUMMARY = library_folder() / "en50318-2002" / "known-passing-code" / "250.toml"


@pytest.fixture
def summary(tmp_path: Path) -> Path:
    """Copy of a published summary."""
    return Path(shutil.copy(SUMMARY, tmp_path / "a.toml"))


def _rule(upper: Any) -> Rule:
    return Rule(quantity="max_uplift_at_support_mm", upper=upper, trust="secondary", source="own")


def test_rule_above_a_speed_does_not_hold_at_this_speed() -> None:
    rule = _rule(SpeedFormula(per_speed_squared=0.001, constant=70.0, above_km_h=200.0))
    with pytest.raises(BoundMissing, match="above 200 km/h"):
        resolve_bounds(rule, 200.0, {}, None)
    assert resolve_bounds(rule, 200.1, {}, None)[1] == pytest.approx(110.04, rel=1e-6)


def test_bound_of_the_record_is_multiplied_by_its_factor() -> None:
    rule = _rule(NamedBound(given="uplift_space_mm", factor=0.5))
    assert resolve_bounds(rule, 250.0, {"uplift_space_mm": 120.0}, None) == (None, 60.0)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("speed_km_h", 248.0, "was made at 248 km/h, the case runs at 250 km/h"),
        ("speed_km_h", 252.0, "was made at 252 km/h, the case runs at 250 km/h"),
        ("filter_cutoff_Hz", 19.9, "has a filter of 19.9 Hz, the case requires 20 Hz"),
        ("filter_cutoff_Hz", 20.1, "has a filter of 20.1 Hz, the case requires 20 Hz"),
    ],
)
def test_summary_of_a_slower_run_or_a_lower_filter_is_refused(
    case_250: Case, summary: Path, key: str, value: float, message: str
) -> None:
    edit_toml(summary, {key: value})
    outcome = open_record_folder(summary.parent).run(case_250)
    assert isinstance(outcome, Errored)
    assert message in outcome.reason


def test_summary_with_a_negative_deviation_is_refused(summary: Path) -> None:
    edit_toml(summary, {"pantograph.0.std_force_50_N": -1.0})
    with pytest.raises(InputError, match="-1 is negative"):
        open_record_folder(summary.parent)


def test_pantograph_that_stands_still_is_refused(two_pantograph_record: Record) -> None:
    position = two_pantograph_record.position.copy()
    position[1, 10] = position[1, 9]
    with pytest.raises(RecordInvalid, match="position: does not increase from each sample"):
        replace(two_pantograph_record, position=np.asarray(position))
