"""The same passage under two damping models: the arithmetic on the printed table, and models that are broken."""

from dataclasses import dataclass, replace
from typing import Literal

import pytest
from numpy.testing import assert_allclose

from pantocheck.conformance.cases.damping_file import Damping
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.results.outcome import Delivered, Skipped, StudyResult
from pantocheck.conformance.studies.force_charts import draw_band_bars
from pantocheck.conformance.studies.study_dispatch import run_study
from pantocheck.conformance.studies.vovan2015.damping_change import band_changes
from pantocheck.conformance.systems.reference_simulator import ReferenceSimulator


@dataclass(frozen=True)
class Once:
    """The reference simulator without its refinement pair."""

    name: str = "once"
    version: str = "1"
    kind: Literal["builtin"] = "builtin"

    def run(self, case):
        return ReferenceSimulator().run_unrefined(case)


@pytest.fixture(scope="module")
def case():
    (found,) = select_cases(["vovan2015/contact-force"])
    # Three spans on a coarse mesh: the changes keep their signs, which is all that is graded.
    coarse = found.file.discretisation.model_copy(update={"element_m": 1.0, "time_step_s": 0.002})
    file = found.file.model_copy(update={"discretisation": coarse, "evaluated_spans": (7, 9)})
    study = file.study.model_copy(update={"span": 8})
    return replace(found, file=file.model_copy(update={"study": study}))


def model(mass, stiffness):
    both = {"mass_coefficient_1_s": mass, "stiffness_coefficient_s": stiffness}
    return Damping.model_validate(
        {"trust": "provisional", "source": "test", "contact_wire": both, "messenger_wire": both, "droppers": both}
    )


def rows(case, before=None, after=None):
    if before is not None:
        case = replace(case, dampings={"initial": before})
    if after is not None:
        case = replace(case, line=case.line.model_copy(update={"damping": after}))
    result = grade_case(case, run_study(case, Once()), "primary")
    return {(row.quantity, row.pantograph): row for row in result.criteria}, result


LOW, MIDDLE = ("change_rms_0_5_pct", 1), ("change_rms_5_20_pct", 1)
FRONT, REAR = ("change_rms_20_50_pct", 1), ("change_rms_20_50_pct", 2)
DIFFERENCE = ("rear_over_front_change_20_50_pct", 0)


def test_changes_of_the_printed_table(case):
    """Table 1: 34.0 to 29.6 N, 26.0 to 29.7 N, 32.9 to 42.5 N."""
    printed = {(one.model, one.pantograph): dict(one.values) for one in case.file.study.printed}
    found = band_changes(*({p: printed[name, p] for p in (1, 2)} for name in ("initial", "updated")))
    assert_allclose(found[1]["change_rms_0_5_pct"], 0.0, atol=1e-12)
    assert_allclose(found[1]["change_rms_5_20_pct"], -12.94, atol=0.01)
    assert_allclose(found[1]["change_rms_20_50_pct"], 14.23, atol=0.01)
    assert_allclose(found[2]["change_rms_20_50_pct"], 29.18, atol=0.01)
    assert_allclose(found[0]["rear_over_front_change_20_50_pct"], 14.95, atol=0.01)


def test_changes_of_the_rear_pantograph_alone():
    """Where a paper prints those of one pantograph, there is nothing to compare it with."""
    values = [{2: {"rms_20_50_N": value}} for value in (32.0, 40.0)]
    assert band_changes(*values) == {2: {"change_rms_20_50_pct": 25.0}}


def test_the_printed_values_meet_every_limit(case):
    """The limits are those of the paper's own findings."""
    printed = {(one.model, one.pantograph): dict(one.values) for one in case.file.study.printed}
    found = band_changes(*({p: printed[name, p] for p in (1, 2)} for name in ("initial", "updated")))
    static = replace(case, file=case.file.model_copy(update={"speed_km_h": None, "study": None}))
    assert {row.verdict for row in grade_case(static, Delivered(study=StudyResult(found)), "primary").criteria} == {
        "pass"
    }


def test_the_updated_damping_brings_more_above_20_hz(case):
    found, result = rows(case)
    assert [found[key].verdict for key in (LOW, FRONT, REAR, DIFFERENCE)] == ["pass"] * 4
    assert all(row.margin is not None for row in found.values())
    assert result.tables[0].caption == "Findings"
    assert any("span 8" in chart.caption for chart in result.charts)


def test_charts_say_what_is_drawn_beside_the_computed_bars():
    """Without printed values there are no printed bars, and no table of computed beside printed ones."""
    values = {"one": {1: {"rms_0_5_N": 30.0}}}
    (alone,), (beside,) = (
        draw_band_bars(values, printed, ["rms_0_5_N"]) for printed in ({}, {("one", 1): {"rms_0_5_N": 34.0}})
    )
    assert "printed" in beside.caption
    assert "printed" in beside.alternative
    assert "computed under each damping model" in alone.caption
    assert "printed" not in alone.caption + alone.alternative


def test_damping_that_grows_with_frequency_takes_the_extended_band_away(case):
    """The exchange of the two models: less above 20 Hz on both pantographs, most on the rear."""
    found, _ = rows(case, before=case.line.damping, after=case.dampings["initial"])
    assert [found[key].verdict for key in (FRONT, REAR, DIFFERENCE)] == ["fail"] * 3


def test_mass_damping_out_of_scale_is_caught_below_5_hz(case):
    """A mass coefficient of 1.5 1/s is 13 % of critical damping at 0.9 Hz."""
    assert rows(case, after=model(1.5, 1e-4))[0][LOW].verdict == "fail"


def test_less_stiffness_damping_is_caught_between_5_and_20_hz(case):
    """Taking nearly all damping away cannot lower the force there."""
    assert rows(case, before=model(0.3, 1e-3), after=model(0.0, 1e-6))[0][MIDDLE].verdict == "fail"
    assert rows(case, before=model(0.0, 1e-6), after=model(0.3, 1e-3))[0][MIDDLE].verdict == "pass"


def test_a_system_without_a_record_of_one_model_is_skipped(case):
    @dataclass(frozen=True)
    class OneModel(Once):
        def run(self, case):
            return Skipped("there is no record of this case")

    result = grade_case(case, run_study(case, OneModel()), "primary")
    assert result.verdict == "skip"
    assert result.reason == "initial: there is no record of this case"
