"""Comparison of static records with the model: known differences, completeness, outliers and wrong units."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.static_records import SPACING, Array, measure_line, read_unequal_line, write_static_record
from pantocheck.conformance.comparison.static_comparison import (
    SAME_POSITION_M,
    ValuePair,
    build_tolerances,
    compare_statics,
    find_static_gaps,
    grade_static_difference,
)
from pantocheck.conformance.comparison.static_record import StaticSidecar, read_static_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.results.comparison_format import StaticComparison, StaticQuantity
from pantocheck.model import discretise
from pantocheck.model.statics.elasticity import rest_height

LINE = read_unequal_line()
COMPLETE = {"evaluated_spans": [2, 5], "largest_distance_m": SPACING}
Tolerances = dict[StaticQuantity, float | None]
TOLERANCES: Tolerances = {"elasticity_difference_mm_N": 0.05, "contact_wire_height_difference_mm": 5.0}


@pytest.fixture(scope="module")
def computed() -> dict[str, Array]:
    """Values of the model itself, every 6 m."""
    return measure_line()


def compare(folder: Path, columns: dict[str, Array], tolerances: Tolerances, **sidecar: Any) -> StaticComparison:
    """Comparison with elements of 0.5 m."""
    path = write_static_record(folder, columns, **sidecar)
    return compare_statics(read_static_record(path, LINE.geometry), LINE, 0.5, build_tolerances(tolerances))


def change(columns: dict[str, Array], name: str, row: int, change: float) -> dict[str, Array]:
    """Columns with one value changed; rows count from 1."""
    values = columns[name].copy()
    values[row - 1] += change
    return columns | {name: values}


def test_model_agrees_with_itself_in_equal_bytes(tmp_path: Path, computed: dict[str, Array]) -> None:
    """Nine digits in the table. The mesh of half the length moves heights by less than 0.1 mm."""
    comparison = compare(tmp_path, computed, TOLERANCES, **COMPLETE)
    assert comparison.verdict == "pass"
    for item in comparison.criteria:
        assert item.value < 1e-6
        assert item.uncertainty < 0.1
        assert item.close == []
    assert [span.values for span in comparison.values[0].spans] == [11, 10, 10, 10, 9, 11]
    assert all(not values.outlier_rows for values in comparison.values)
    ends = {(values.curve_position_m[0], values.curve_position_m[-1]) for values in comparison.values}
    spans = comparison.values[0].spans
    assert ends == {(spans[0].start_m, spans[-1].end_m)}
    first, second = (compare(tmp_path, computed, TOLERANCES, **COMPLETE).model_dump_json() for _ in range(2))
    assert first == second


def test_known_differences_are_found_with_their_place_and_sign(tmp_path: Path, computed: dict[str, Array]) -> None:
    """Row 21 lies in span 2 and measures 0.08 mm/N more than the model; row 31, in span 3, 7 mm less."""
    columns = change(change(computed, "elasticity_mm_N", 21, 0.08), "contact_wire_height_m", 31, -0.007)
    comparison = compare(tmp_path, columns, TOLERANCES | {"elasticity_difference_pct": 10.0}, **COMPLETE)
    assert comparison.verdict == "fail"
    elasticity, height, percent = comparison.criteria
    measured = columns["elasticity_mm_N"][20]
    assert elasticity.value == pytest.approx(0.08, rel=1e-4)
    assert height.value == pytest.approx(7.0, rel=1e-4)
    assert percent.value == pytest.approx(100 * 0.08 / measured, rel=1e-4)
    assert "above the upper limit, at 121.5 m" in str(elasticity.reason)
    assert comparison.values[0].outlier_rows == (21,)
    assert comparison.values[1].outlier_rows == (31,)
    assert comparison.values[0].spans[1].largest_difference == pytest.approx(-0.08, rel=1e-4)
    assert comparison.values[1].spans[2].largest_difference == pytest.approx(7.0, rel=1e-4)


def test_common_offset_has_no_outliers_and_shows_the_error_of_the_mesh(
    tmp_path: Path, computed: dict[str, Array]
) -> None:
    """All heights are measured 4 mm too low; elements of 2 m are 0.2 mm too high in the mean, and say so."""
    columns = {name: computed[name] for name in ("position_m", "contact_wire_height_m")}
    columns["contact_wire_height_m"] = columns["contact_wire_height_m"] - 0.004
    record = read_static_record(write_static_record(tmp_path, columns, **COMPLETE), LINE.geometry)
    comparison = compare_statics(record, LINE, 2.0, build_tolerances({"contact_wire_height_difference_mm": 5.0}))
    assert comparison.values[0].outlier_rows == ()
    assert comparison.values[0].mean_difference == pytest.approx(4.2, abs=0.1)
    (height,) = comparison.criteria
    assert height.uncertainty is not None
    assert 0.02 < height.uncertainty < 1.0


def test_difference_of_two_forces_is_the_slope_between_them(tmp_path: Path, computed: dict[str, Array]) -> None:
    """Droppers slacken under 200 N: the slope from 100 N to 200 N exceeds the elasticity, but not at supports."""
    one, two = (
        compare(tmp_path, computed, {}, **COMPLETE, force_N=force).values[0].model
        for force in ([100.0], [100.0, 200.0])
    )
    assert np.all(np.array(two) >= np.array(one) - 1e-9)
    assert max(np.array(two) / np.array(one)) > 1.05
    assert min(np.array(two) / np.array(one)) == pytest.approx(1.0, abs=1e-6)


def test_stated_uncertainty_marks_a_close_criterion(tmp_path: Path, computed: dict[str, Array]) -> None:
    columns = change(computed, "elasticity_mm_N", 21, 0.045)
    comparison = compare(tmp_path, columns, TOLERANCES, **COMPLETE, elasticity_uncertainty_mm_N=0.01)
    assert "could reverse the verdict" in comparison.criteria[0].close[0]
    assert comparison.verdict == "pass"


@pytest.mark.parametrize(
    ("sidecar", "reason"),
    [
        ({"largest_distance_m": SPACING}, "no measured value between 355.5 and 364.5 m"),
        ({"evaluated_spans": [2, 5]}, "does not state largest_distance_m"),
        ({"evaluated_spans": [2, 5], "largest_distance_m": 5.9}, "no measured value between 67.5 and 73.5 m"),
    ],
)
def test_incomplete_record_does_not_pass(
    tmp_path: Path, computed: dict[str, Array], sidecar: dict[str, Any], reason: str
) -> None:
    """The last measured position is removed: the end of the line is then 9 m away."""
    columns = {name: values[:-1] for name, values in computed.items()}
    comparison = compare(tmp_path, columns, TOLERANCES, **sidecar)
    assert comparison.verdict == "skip"
    assert reason in str(comparison.criteria[0].reason)


def test_missing_values_leave_the_criterion_open_and_are_named_with_outliers(
    tmp_path: Path, computed: dict[str, Array]
) -> None:
    columns = change(computed, "elasticity_mm_N", 30, np.nan)
    comparison = compare(tmp_path, columns, TOLERANCES, **COMPLETE)
    elasticity, height = comparison.criteria
    assert elasticity.verdict == "skip"
    assert [values.missing_rows for values in comparison.values] == [(30,), ()]
    assert "no measured value between 169.5 and 181.5 m" in str(elasticity.reason)
    assert height.verdict == "pass"
    assert comparison.values[0].missing_rows == (30,)
    # A verdict on one kind of values must not be taken for one on the other kind.
    columns = change(change(computed, "elasticity_mm_N", 21, 0.08), "contact_wire_height_m", 30, np.nan)
    graded = compare(tmp_path, columns, {"elasticity_difference_mm_N": 0.05}, **COMPLETE)
    assert graded.warnings == (
        "elasticity: the differences of row 21 are outliers among those of the record; they count",
        "contact wire height: no tolerance was given, so that the differences are not graded",
        "contact wire height: no value in row 30",
    )
    assert len(compare(tmp_path, columns, {}, **COMPLETE).warnings) == 2
    comparison = compare(tmp_path, computed, {}, **COMPLETE)
    assert (comparison.verdict, comparison.criteria) == ("info", ())
    outside = {name: values[:5] for name, values in computed.items()}  # 1.5 to 25.5 m, in span 1
    (none, _) = compare(tmp_path, outside, {}, **COMPLETE).values
    assert (none.mean_difference, none.rms_difference) == (None, None)


@pytest.mark.parametrize(
    ("name", "factor", "offset", "message"),
    [
        ("elasticity_mm_N", 10.0, 0.0, "the median is 10 times that of the model"),
        ("elasticity_mm_N", 5.5, 0.0, "the median is 5.5 times"),
        ("elasticity_mm_N", 1e-3, 0.0, "the median is 0.001 times"),
        ("contact_wire_height_m", 1.0, 5.3, "give datum_m = 5.3 in the sidecar"),
    ],
)
def test_evident_error_of_unit_or_datum_is_refused(
    tmp_path: Path, computed: dict[str, Array], name: str, factor: float, offset: float, message: str
) -> None:
    columns = computed | {name: factor * computed[name] + offset}
    with pytest.raises(InputError, match=message):
        compare(tmp_path, columns, {}, **COMPLETE)


def test_hint_on_the_datum_adds_to_the_stated_one(tmp_path: Path, computed: dict[str, Array]) -> None:
    columns = computed | {"contact_wire_height_m": computed["contact_wire_height_m"] + 5.3}
    with pytest.raises(InputError, match=r"the median is 4\.3 m above .*\n.* datum_m = 5\.3 "):
        compare(tmp_path, columns, {}, **COMPLETE, datum_m=1.0)


def test_heights_of_a_line_that_counts_from_the_rail_need_no_datum(tmp_path: Path) -> None:
    """The line of the page on line tables, 5.3 m above the rail: every height of the model is 5.3 m greater."""
    tables = LINE.model_dump(mode="json", exclude_none=True)
    tables["geometry"]["contact_wire_height_m"] = 5.3
    raised = LineFile.model_validate(tables)
    columns = {"position_m": np.array([100.0, 150.0]), "contact_wire_height_m": np.array([5.299, 5.297])}
    record = read_static_record(write_static_record(tmp_path, columns, force_N=None), raised.geometry)
    (heights,) = compare_statics(record, raised, 0.5, ()).values
    catenary = discretise(build_catenary(LINE), 0.5)
    assert heights.model == pytest.approx(5300 + 1e3 * rest_height(catenary, columns["position_m"]), abs=1e-3)


def test_gaps_are_counted_and_named_up_to_a_number() -> None:
    """Every second distance of 5 m is too long; a distance that is too long by a rounding error is not."""
    section = (0.0, 5.0 + SAME_POSITION_M)
    assert find_static_gaps(np.array(section), section, 5.0) == []
    measured = np.full(7, 5e-4)
    position = np.arange(0.0, 61.0, 10.0)
    pair = ValuePair(position, measured, measured, measured, np.arange(1, 8), np.zeros(0, dtype=np.int64))
    (limit,) = build_tolerances({"elasticity_difference_mm_N": 0.1})
    reason = str(grade_static_difference(limit, {"elasticity": pair}, SIDECAR, (0.0, 60.0)).reason)
    assert "40 and 50 m and 1 more" in reason


POSITION = np.arange(0.0, 100.1, 5.0)
SIDECAR = StaticSidecar(schema="pantocheck.static/1", file="a.csv", force_N=(100.0,), largest_distance_m=5.0)


def grade(rows: list[int], sidecar: StaticSidecar) -> str:
    """Verdict of a record with these rows, of which row 7 is 0.2 mm/N off, with a tolerance of 0.1 mm/N."""
    measured = np.full(POSITION.size, 5e-4)
    measured[7] += 2e-4
    model = np.full(len(rows), 5e-4)
    index = np.array(rows, dtype=np.int64)
    pair = ValuePair(POSITION[index], measured[index], model, model, index + 1, np.zeros(0, dtype=np.int64))
    (limit,) = build_tolerances({"elasticity_difference_mm_N": 0.1})
    return grade_static_difference(limit, {"elasticity": pair} if rows else {}, sidecar, (0.0, 100.0)).verdict


def test_failing_record_fails() -> None:
    assert grade(list(range(POSITION.size)), SIDECAR) == "fail"


@settings(max_examples=40, deadline=None)
@given(st.sets(st.integers(0, POSITION.size - 1), max_size=POSITION.size), st.booleans())
def test_no_removal_of_rows_or_metadata_makes_a_failing_record_pass(kept: set[int], stated: bool) -> None:
    sidecar = SIDECAR if stated else SIDECAR.model_copy(update={"largest_distance_m": None})
    assert grade(sorted(kept), sidecar) in {"fail", "skip"}
