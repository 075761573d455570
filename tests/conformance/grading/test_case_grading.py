"""Grading of a case: its steps of the procedure, and deliveries that do not belong to it."""

import pytest

from helpers.case_fixtures import EditedCase
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import list_library, load_case, select_cases
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.runs.system import Delivered, Skipped
from pantocheck.conformance.studies.damping_sensitivity import add_damping_study


@pytest.mark.parametrize("name", list_library(library_folder()))
def test_steps_of_a_library_case(name: str) -> None:
    """Passages of an edition are reference models, static cases static checks; mass drops and studies are no step."""
    case = load_case(list_library(library_folder())[name])
    steps = grade_case(case, Skipped("not run"), "secondary").steps
    if case.file.mass_drop is not None or case.file.study is not None:
        assert steps == []
    elif case.file.speed_km_h is None:
        assert steps == (["static_check"] if case.file.apparent_mass is None else ["pantograph_model", "static_check"])
    else:
        assert steps == ([] if case.file.edition is None else ["reference_models"])


def test_study_of_a_passage_keeps_its_step(case_250: Case, edited_case: EditedCase) -> None:
    own = load_case(edited_case("250.toml", {"id": "own/250"}))
    steps = [grade_case(case, Skipped("not run"), "secondary").steps for case in (add_damping_study(case_250), own)]
    assert steps == [["reference_models"], []]
    (case,) = select_cases(["en50318-2018/ac-simple/static"])
    result = grade_case(case, Delivered(static={"wave_speed_m_s": 120.0}), "secondary")
    assert result.quantities == {"0": {"wave_speed_m_s": 120.0}}
    assert result.run.evaluated_m is None
    assert result.record is None


@pytest.mark.parametrize("name", ["unknown_m", "max_uplift_at_support_mm", "zzz_m"])
def test_every_static_quantity_must_be_one_of_the_line_at_rest(two_pantograph_case: Case, name: str) -> None:
    """The wrong name stands before or after correct ones in the order of the alphabet."""
    static = {"dropper_length_m": (1.0,), "presag_mm": (0.0,), "wave_speed_m_s": 120.0, name: 1.0}
    result = grade_case(two_pantograph_case, Delivered(Wave().record(two_pantograph_case), static), "secondary")
    assert result.verdict == "error"
    assert name in (result.reason or "")
