"""Summary records: a published code passes, a value outside a limit fails, impossible values are refused."""

import math
from pathlib import Path
from typing import Any

import pytest

from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record_reading import open_record
from pantocheck.conformance.records.record_summary import RecordSummary
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.system_choice import choose_system

PASSING = library_folder() / "en50318-2002" / "known-passing-code"
SPEEDS = ("250", "300")
QUANTITIES = (
    *("mean_force_N", "std_force_N", "statistical_max_N", "statistical_min_N", "max_force_N", "min_force_N"),
    *("max_uplift_at_support_mm", "contact_loss_pct"),
)


def change_summary(folder: Path, changes: dict[str, Any], speed: str = "250") -> Path:
    """Copy of the summary of the passing code with changed keys."""
    path = folder / "a.toml"
    path.write_bytes((PASSING / f"{speed}.toml").read_bytes())
    return edit_toml(path, changes)


def grade(folder: Path) -> CaseResult:
    """Grade the summary in a folder as a run of the case at 250 km/h."""
    (result,) = run_cases(select_cases(["en50318-2002/250"]), open_record_folder(folder)).cases
    return result


def test_published_passing_code_passes_on_all_criteria() -> None:
    results = run_cases(select_cases(["en50318-2002/*"]), choose_system("record:en50318-2002/known-passing-code"))
    assert results.verdict == "unconfirmed"  # numbers without samples cannot be checked
    assert [item.verdict for case in results.cases for item in case.criteria] == ["pass"] * 16
    assert find_discrepancies(results) == []
    # The printed extremes at 300 km/h contradict the printed mean and deviation: a warning; they are graded as printed.
    assert [len(case.warnings) for case in results.cases] == [0, 2]


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_value_just_outside_its_limit_fails_only_that_criterion(speed: str, quantity: str, tmp_path: Path) -> None:
    (case,) = select_cases([f"en50318-2002/{speed}"])
    (limit,) = (limit for limit in case.limits if limit.quantity == quantity)
    key = f"quantities.{quantity}" if quantity == "max_uplift_at_support_mm" else f"pantograph.0.{quantity}"
    for bound, step in ((limit.lower, -1e-6), (limit.upper, 1e-6)):
        if bound is None or (bound == 0 and step < 0):
            continue  # a share below 0 % is impossible
        change_summary(tmp_path, {key: bound + step}, speed)
        (result,) = run_cases([case], open_record_folder(tmp_path)).cases
        assert result.verdict == "fail"
        assert [item.quantity for item in result.criteria if item.verdict == "fail"] == [quantity]
        assert sum(item.verdict == "pass" for item in result.criteria) == 7


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"pantograph.0.std_force_kN": 0.0276}, r"pantograph\[1\].std_force_kN: not a quantity of this table"),
        ({"pantograph.0.std_force_N": -27.6}, "-27.6 is negative"),
        ({"pantograph.0.std_force_50_N": -1.0}, "-1 is negative"),
        ({"pantograph.0.std_force_N": math.nan}, "not a finite number"),
        ({"pantograph.0.std_force_N": "27.6"}, "found '27.6', expected a number"),
        ({"pantograph.0.contact_loss_pct": 101.0}, "101 % is above 100 %"),
        ({"pantograph.0.min_force_N": 200.0}, "200 is above max_force_N = 193.7"),
        ({"quantities": {"mean_force_N": 52.2}}, r"quantities.mean_force_N: not a quantity of this table"),
        ({"pantograph": None, "pantographs": []}, "key pantographs: unknown key.\n  Did you mean pantograph"),
        ({"source": None}, "key source: missing, although the trust is"),
        ({"evaluated_m": [360.0, 360.0]}, "the end is not greater than the start"),
    ],
)
def test_impossible_summary_is_refused_with_its_key(changes: dict[str, Any], message: str, tmp_path: Path) -> None:
    path = change_summary(tmp_path, changes)
    with pytest.raises(InputError, match=message):
        open_record(path)


@pytest.mark.parametrize(("speed", "mean", "std"), [("250", 118.2, 27.6), ("300", 118.7, 32.8)])
def test_shipped_numbers_are_the_published_ones(speed: str, mean: float, std: float) -> None:
    summary = open_record(PASSING / f"{speed}.toml")
    assert (summary.pantograph[0]["mean_force_N"], summary.pantograph[0]["std_force_N"]) == (mean, std)


@pytest.mark.parametrize(
    ("quantity", "expected", "tolerance"),
    [("statistical_min_N", 28.0, 0.3), ("statistical_max_N", 208.0, 0.3), ("cov_20", 30 / 118, 0.006)],
)
@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("number", [1, 2])
def test_statistic_beyond_the_rounding_of_print_is_a_contradiction(
    quantity: str, expected: float, tolerance: float, sign: int, number: int, tmp_path: Path
) -> None:
    """Mean 118 N and deviation 30 N: mean plus and minus three deviations, and their ratio."""
    tables = [{"mean_force_N": 118.0, "std_force_N": 30.0} for _ in range(2)]
    for factor, contradicts in ((0.99, False), (1.01, True)):
        tables[number - 1][quantity] = expected + sign * factor * tolerance
        summary = open_record(change_summary(tmp_path, {"pantograph": tables}))
        assert len(summary.contradictions) == contradicts
        assert all(text.startswith(f"{quantity} of pantograph {number} is ") for text in summary.contradictions)


@pytest.mark.parametrize(
    "table",
    [
        {"std_force_N": 30.0, "statistical_max_N": 300.0},
        {"mean_force_N": 118.0, "statistical_max_N": 300.0},
        {"mean_force_N": 0.0, "std_force_N": 30.0, "cov_20": 9.0},
        {"mean_force_N": -5.0, "std_force_N": 30.0, "cov_20": 9.0},
    ],
)
def test_comparison_needs_a_deviation_and_a_positive_mean(table: dict[str, float], tmp_path: Path) -> None:
    assert open_record(change_summary(tmp_path, {"pantograph": [table]})).contradictions == ()


def test_statistics_of_each_pantograph_stay_apart_and_a_missing_one_is_skipped(tmp_path: Path) -> None:
    tables = [{"mean_force_N": 118.0}, {"std_force_N": 30.0}]
    changes = {"pantograph": tables, "quantities": {"max_uplift_at_support_mm": 52.0, "wave_speed_m_s": 120.0}}
    summary = open_record(change_summary(tmp_path, changes))
    evaluation = summary.evaluation
    assert evaluation.values == {0: changes["quantities"], 1: tables[0], 2: tables[1]}
    assert "max_uplift_at_support_mm" not in evaluation.skipped[0]
    assert "mean_force_N" not in evaluation.skipped[1]
    assert evaluation.skipped[2]["mean_force_N"] == "the summary does not state this quantity"
    change_summary(tmp_path, {"pantograph.0.max_force_N": None})
    result = grade(tmp_path)
    assert result.verdict == "skip"
    (skipped,) = (item for item in result.criteria if item.verdict == "skip")
    assert (skipped.quantity, skipped.reason) == ("max_force_N", "the summary does not state this quantity")


@pytest.mark.parametrize(
    "changes",
    [
        {"pantograph.0.contact_loss_pct": 100.0},
        {"pantograph.0.max_force_N": 60.0, "pantograph.0.min_force_N": 60.0},
        {"pantograph.0.min_force_N": -3.0},
        {"pantograph.0.std_force_N": 0.0},
        {"evaluated_m": [240.0, 360.0]},
    ],
)
def test_values_at_a_bound_are_possible(changes: dict[str, Any], tmp_path: Path) -> None:
    assert isinstance(open_record(change_summary(tmp_path, changes)), RecordSummary)


@pytest.mark.parametrize(("schema", "found"), [(None, "missing"), (3, "found '3'"), ("x" * 70, f"found '{'x' * 60}'")])
def test_schema_that_is_not_known_is_named_with_the_known_ones(schema: object, found: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        open_record(change_summary(tmp_path, {"schema": schema}))
    assert caught.value.found == found
    assert caught.value.hint == 'Write schema = "pantocheck.record/1" or "pantocheck.summary/1".'
