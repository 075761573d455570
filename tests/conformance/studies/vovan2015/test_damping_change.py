"""Change of the bands between two damping models: values of the printed table, and detection of wrong models."""

from dataclasses import dataclass, replace
from typing import Literal

import pytest
from numpy.testing import assert_allclose

from helpers.short_cases import change_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.execution.study_dispatch import run_study
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.line.elements.damping import Damping
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered, Outcome, Skipped, StudyResult
from pantocheck.conformance.studies.damping_sensitivity import draw_band_bars
from pantocheck.conformance.studies.vovan2015.damping_change import CHANGES, EARLIER_LEVEL, _compare_runs, compare_force


@dataclass(frozen=True)
class Unrefined:
    """The reference simulator without the refined run."""

    name: str = "unrefined"
    version: str = "1"
    kind: Literal["builtin"] = "builtin"

    def run(self, case: Case) -> Outcome:
        return ReferenceSimulator().run_unrefined(case)


def coarse_case(**changes: object) -> Case:
    """Case of the study with a coarse mesh and untuned mean forces: only the signs of the changes are graded."""
    (case,) = select_cases(["vovan2015/contact-force"])
    untuned = tuple(use.model_copy(update={"target_mean_force_N": None}) for use in case.file.pantograph)
    return change_case(case, mesh=(1.0, 0.002), pantograph=untuned, **changes)


@pytest.fixture(scope="module")
def case() -> Case:
    """Three spans are enough for the signs of the changes."""
    study = coarse_case().file.study.model_copy(update={"span": 8})
    return coarse_case(evaluated_spans=(7, 9), compared_spans=(7, 11), study=study)


@pytest.fixture(scope="module")
def delivered(case: Case) -> Delivered:
    """The study of the case."""
    return run_study(case, Unrefined())


def build_damping(mass: float, stiffness: float) -> Damping:
    rayleigh = {"mass_coefficient_1_s": mass, "stiffness_coefficient_s": stiffness}
    kinds = dict.fromkeys(("contact_wire", "messenger_wire", "droppers"), rayleigh)
    return Damping.model_validate({"trust": "provisional", "source": "test", **kinds})


def run_and_grade(
    case: Case, before: Damping | None = None, after: Damping | None = None
) -> dict[tuple[str, int], Criterion]:
    if before is not None:
        case = replace(case, dampings={"initial": before})
    if after is not None:
        case = replace(case, line=case.line.model_copy(update={"damping": after}))
    result = grade_case(case, run_study(case, Unrefined()), "primary")
    return {(row.quantity, row.pantograph): row for row in result.criteria}


LOW, MIDDLE = ("change_rms_0_5_pct", 1), ("change_rms_5_20_pct", 1)
FRONT, REAR = ("change_rms_20_50_pct", 1), ("change_rms_20_50_pct", 2)


def printed_changes(case: Case) -> dict[int, dict[str, float]]:
    printed = {(table.model, table.pantograph): dict(table.values) for table in case.file.study.printed}
    return compare_force(*({p: printed[name, p] for p in (1, 2)} for name in ("initial", "updated")))


def test_changes_of_the_printed_table(case: Case) -> None:
    """Table 1: 34.0 to 29.6 N, 26.0 to 29.7 N, 32.9 to 42.5 N."""
    # The coefficient of variation: 0.33 to 0.30 and 0.38 to 0.37 in front, 0.23 to 0.26 and 0.28 to 0.33 at the rear.
    changes = printed_changes(case)
    assert_allclose(changes[1]["change_rms_0_5_pct"], 0.0, atol=1e-12)
    assert_allclose(changes[1]["change_rms_5_20_pct"], -12.94, atol=0.01)
    assert_allclose(changes[1]["change_rms_20_50_pct"], 14.23, atol=0.01)
    assert_allclose(changes[2]["change_rms_20_50_pct"], 29.18, atol=0.01)
    assert_allclose(changes[0]["rear_over_front_change_20_50_pct"], 14.95, atol=0.01)
    found = [changes[p][f"change_cov_{cutoff}_pct"] for p in (1, 2) for cutoff in (20, 50)]
    assert_allclose(found, [-9.09, -2.63, 13.04, 17.86], atol=0.01)


def test_changes_need_a_value_on_both_sides_and_the_order_both_runs() -> None:
    """Values of the line, of a pantograph on one side alone, and zeros before the change give no change."""
    before = {0: {"rms_0_5_N": 1.0}, 1: {"rms_0_5_N": 20.0, "rms_5_20_N": 0.0, "rms_20_50_N": 10.0}, 2: {}}
    after = {0: {"rms_0_5_N": 2.0}, 1: {"rms_0_5_N": 30.0, "rms_5_20_N": 5.0, "rms_20_50_N": 9.0}, 3: {}}
    changes = {"change_rms_0_5_pct": 50.0, "change_rms_20_50_pct": pytest.approx(-10), EARLIER_LEVEL: 10.0}
    assert compare_force(before, after) == {1: changes}
    assert compare_force(after, {}) == {}
    # Without values of the front pantograph there is no difference between rear and front.
    values = [{2: {"rms_20_50_N": value}} for value in (32.0, 40.0)]
    assert compare_force(*values) == {2: {"change_rms_20_50_pct": 25.0, EARLIER_LEVEL: 32.0}}
    # Ratios of rear to front by hand: 0.5 and 2; a pantograph without the band gives none.
    before, after = ({1: {"rms_0_5_N": front}, 2: {"rms_0_5_N": rear}} for front, rear in ((20.0, 10.0), (0.5, 1.0)))
    ratios = {"smallest_rear_over_front_rms_0_5": 0.5, "largest_rear_over_front_rms_0_5": 2.0}
    assert compare_force(before, after)[0] == ratios
    assert 0 not in compare_force(before, {1: {"rms_0_5_N": 5.0}, 2: {}})
    assert 0 not in compare_force({1: before[1]}, {1: after[1]})


def test_updated_damping_raises_the_force_above_20_hz_in_table_and_chart(case: Case, delivered: Delivered) -> None:
    result = grade_case(case, delivered, "primary")
    rows = {(row.quantity, row.pantograph): row for row in result.criteria}
    assert [rows[key].verdict for key in (LOW, FRONT, REAR)] == ["pass"] * 3
    assert all(row.margin is not None for row in rows.values())
    assert result.tables[0].caption == "Findings"
    assert any("span 8" in chart.caption for chart in result.charts)
    pair = [chart for chart in delivered.study.charts if "span 8" in chart.caption]
    assert [("20 Hz" in chart.caption, chart.wide) for chart in pair] == [(True, False), (False, False)]
    record, (start, end) = delivered.record, case.line.geometry.span(8)
    inside = (record.position[-1] >= start) & (record.position[-1] <= end)
    force = case.file.filter(record.force[-1], record.rate)[inside]
    assert pair[0].series[1].y == pytest.approx(force, rel=1e-3)
    assert _compare_runs(case, None, delivered) is None
    same = _compare_runs(case, delivered, delivered)
    assert {same.study.findings[1][name] for name in CHANGES.values()} == {0.0}
    assert all([series.label for series in chart.series] == ["initial", "updated"] for chart in pair)
    # The limits express the findings of the paper.
    static = replace(case, file=case.file.model_copy(update={"speed_km_h": None, "study": None}))
    result = grade_case(static, Delivered(study=StudyResult(printed_changes(case))), "primary")
    assert {row.verdict for row in result.criteria} == {"pass"}


def test_spread_is_the_largest_difference_over_shifted_sections(case: Case, delivered: Delivered) -> None:
    """Three sections of three spans in spans 7 to 11; the first of them is the analysis section."""
    (table,) = (table for table in delivered.study.tables if "3 positions" in table.caption)
    row = next(row for row in table.rows if row[1] == "2" and "20–50" in row[0])
    value = delivered.study.findings[2]["change_rms_20_50_pct"]
    smallest, largest = (float(cell) for cell in row[4:])
    # The cells have three digits.
    assert float(row[3]) == pytest.approx(value, rel=0.01)
    spread = delivered.study.spread[2]["change_rms_20_50_pct"]
    assert spread == pytest.approx(max(value - smallest, largest - value), abs=0.1)
    assert spread > 0.1
    assert grade_case(case, delivered, "primary").spread["2"]["change_rms_20_50_pct"] == spread


def test_library_case_is_settled() -> None:
    """A shift of the analysis section by up to ten spans moves no change by more than two points."""
    # The whole run is needed: after 15 spans of run-in, the front pantograph in 20-50 Hz still moves by 5 points.
    outcome = run_study(coarse_case(), Unrefined())
    spread = [outcome.study.spread[p][name] for p in (1, 2) for name in CHANGES.values()]
    assert 0.1 < max(spread) < 2.0


def test_chart_mentions_printed_values_only_if_it_shows_them() -> None:
    values = {"initial": {1: {"rms_0_5_N": 30.0}}}
    (computed_only,), (compared,) = (
        draw_band_bars(values, printed, ["rms_0_5_N"]) for printed in ({}, {("initial", 1): {"rms_0_5_N": 34.0}})
    )
    assert "printed" in compared.caption
    assert "printed" in compared.alternative
    assert "computed under each damping model" in computed_only.caption
    assert "printed" not in computed_only.caption + computed_only.alternative


def test_exchanged_models_are_detected_above_20_hz(case: Case) -> None:
    """Damping that grows with frequency lowers the force above 20 Hz on both pantographs."""
    rows = run_and_grade(case, before=case.line.damping, after=case.dampings["initial"])
    assert [rows[key].verdict for key in (FRONT, REAR)] == ["fail"] * 2


@pytest.mark.parametrize(
    ("before", "after", "band", "verdict"),
    [
        # A mass coefficient of 1.5 1/s is 13 % of critical damping at 0.9 Hz.
        (None, (1.5, 1e-4), LOW, "fail"),
        # A line with almost no damping cannot have a lower force in this band.
        ((0.3, 1e-3), (0.0, 1e-6), MIDDLE, "fail"),
        ((0.0, 1e-6), (0.3, 1e-3), MIDDLE, "pass"),
    ],
)
def test_excessive_or_removed_damping_is_detected(
    case: Case, before: tuple[float, float] | None, after: tuple[float, float], band: tuple[str, int], verdict: str
) -> None:
    earlier = None if before is None else build_damping(*before)
    assert run_and_grade(case, before=earlier, after=build_damping(*after))[band].verdict == verdict


def test_study_is_skipped_without_a_record_of_each_model(case: Case) -> None:
    @dataclass(frozen=True)
    class OneModel(Unrefined):
        def run(self, case: Case) -> Outcome:
            return Skipped("there is no record of this case")

    result = grade_case(case, run_study(case, OneModel()), "primary")
    assert result.verdict == "skip"
    assert result.reason == "initial: there is no record of this case"
