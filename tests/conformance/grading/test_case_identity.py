"""Identity of a case: copies of library cases, digests of limits, limits that a limits file weakens."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from helpers.case_fixtures import EditedCase
from helpers.command_line import pantocheck
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import list_library, load_case, overlay_limits, select_cases
from pantocheck.conformance.cases.limits import Limit, LimitOverride
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.case_identity import (
    compare_with_library,
    describe_limit_change,
    limits_digest,
    list_limit_changes,
)
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.limit_text import raises_trust_only
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.runs.system import Delivered, Skipped
from pantocheck.conformance.studies.damping_sensitivity import add_damping_study

LIBRARY = list_library(library_folder())


@pytest.mark.parametrize("name", LIBRARY)
def test_every_library_case_is_identical_to_itself(name: str) -> None:
    assert compare_with_library(load_case(LIBRARY[name])) == "identical"


@pytest.mark.parametrize(
    ("file", "changes"),
    [
        ("250.toml", {"limit.6.upper": 255.0}),
        ("250.toml", {"limit.1.trust": "primary"}),
        ("250.toml", {"limit": []}),
        ("250.toml", {"speed_km_h": 249.0}),
        ("250.toml", {"title": "Another title"}),
        ("250.toml", {"source": "another source"}),
        ("250.toml", {"edition": "EN 50318:2018"}),
        ("250.toml", {"superseded_by": None}),
        ("line.toml", {"contact_wire.tension_N": 20001.0}),
        ("pantograph.toml", {"title": "Another pantograph"}),
    ],
)
def test_copy_with_other_content_is_modified(edited_case: EditedCase, file: str, changes: dict[str, Any]) -> None:
    """A wider limit, other inputs, another source or title: the id alone does not make a library case."""
    assert compare_with_library(load_case(edited_case(file, changes))) == "modified"


def test_copies_are_told_apart(two_pantograph_case: Case, edited_case: EditedCase, case_250: Case) -> None:
    assert compare_with_library(two_pantograph_case) == "modified"
    assert compare_with_library(load_case(edited_case("250.toml", {}))) == "identical"
    assert compare_with_library(load_case(edited_case("250.toml", {"id": "en50318-2002/250-copy"}))) == "own"
    wide = LimitOverride(quantity="std_force_N", upper=900.0, trust="secondary", source="own")
    assert compare_with_library(overlay_limits([case_250], [wide])[0]) == "identical"
    assert compare_with_library(add_damping_study(case_250)) == "identical"
    # An edition is provenance.
    file = case_250.file.model_copy(update={"edition": None, "superseded_by": None})
    assert replace(case_250, file=file).digest == case_250.digest
    assert (case_250.file.edition, case_250.file.superseded_by) == ("EN 50318:2002", "EN 50318:2018")


@pytest.mark.parametrize("change", [{"upper": 31.5}, {"trust": "primary"}, {"source": "another"}, {"pantograph": 2}])
def test_digest_of_limits_notices_bounds_trust_and_source(change: dict[str, Any]) -> None:
    limits = (
        Limit(quantity="std_force_N", pantograph=1, upper=31.0, trust="secondary", source="own"),
        Limit(quantity="mean_force_N", pantograph=2, upper=120.0, trust="secondary", source="own"),
    )
    assert limits_digest(limits[::-1]) == limits_digest(limits)
    assert limits_digest((limits[0].model_copy(update=change), limits[1])) != limits_digest(limits)


def test_result_states_identity_digests_and_removed_limits(case_250: Case) -> None:
    own = LimitOverride(quantity="std_force_N", upper=900.0, trust="secondary", source="own")
    plain, wide = (
        grade_case(case, Skipped("not run"), "secondary") for case in (case_250, *overlay_limits([case_250], [own]))
    )
    assert (plain.library, plain.edition, plain.steps) == ("identical", "EN 50318:2002", ["reference_models"])
    assert plain.limits_digest == plain.stated_limits_digest == wide.stated_limits_digest != wide.limits_digest
    assert not plain.limit_changes
    assert wide.limit_changes == ["std_force_N of pantograph 1: the limit 26 to 31 is widened to <= 900"]
    changes = list_limit_changes(replace(case_250, limits=case_250.limits[1:]))
    assert changes == ["mean_force_N of pantograph 1: the limit 110 to 120 is removed"]


STATED = Limit(quantity="std_force_N", pantograph=2, lower=26.0, upper=31.0, trust="secondary", source="wang2016")


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({}, None),
        ({"upper": 30.0}, None),
        ({"lower": 27.0, "source": "own", "note": "stricter"}, None),
        ({"trust": "own"}, "the trust of the limit is own in place of secondary"),
        ({"trust": "computed"}, "the trust of the limit is computed in place of secondary"),
        ({"trust": "provisional"}, "the trust of the limit is lowered from secondary to provisional"),
        ({"trust": "primary"}, "the trust of the limit is raised from secondary to primary"),
        ({"upper": 32.0}, "the limit 26 to 31 is widened to 26 to 32"),
        ({"lower": 25.0}, "the limit 26 to 31 is widened to 25 to 31"),
        ({"upper": None}, "the limit 26 to 31 is widened to >= 26"),
        ({"lower": None, "trust": "provisional"}, "the limit 26 to 31 is widened to <= 31, and the trust of the limit "
         "is lowered from secondary to provisional"),
    ],
)  # fmt: skip
def test_weaker_limit_is_described(change: dict[str, Any], text: str | None) -> None:
    expected = text and f"std_force_N of pantograph 2: {text}"
    assert describe_limit_change(STATED, STATED.model_copy(update=change)) == expected


@pytest.mark.parametrize(
    ("change", "raised"),
    [
        ({"trust": "primary"}, True),
        ({"trust": "primary", "upper": 30.0}, True),
        ({"trust": "provisional"}, False),
        ({"trust": "primary", "upper": 32.0}, False),
        ({"upper": 32.0}, False),
    ],
)
def test_raised_trust_alone_weakens_nothing(change: dict[str, Any], raised: bool) -> None:
    text = describe_limit_change(STATED, STATED.model_copy(update=change))
    assert raises_trust_only(text) == raised


def test_command_names_a_case_file_that_borrows_the_id_of_the_library(edited_case: EditedCase, tmp_path: Path) -> None:
    """The uplift limit of the copy is 255 mm in place of 55 mm; its id, source and input digest are unchanged."""
    path = edited_case("250.toml", {"limit.6.upper": 255.0})
    system = "record:en50318-2002/known-passing-code"
    out = tmp_path / "out"
    done = pantocheck("run", path, "--system", system, "--formats", "json,junit,md", "--out", out)
    output = " ".join(done.output.split())
    assert "Modified copies of the library: 1." in output
    assert "modified copy of en50318-2002/250" in output
    [case] = read_results(out / "results.json").cases
    assert (case.id, case.library) == ("en50318-2002/250", "modified")
    assert case.input_digest == load_case(LIBRARY["en50318-2002/250"]).digest
    for name in ("junit.xml", "summary.md"):
        assert "modified copy of en50318-2002/250" in (out / name).read_text(encoding="utf-8")


# Grading of a case: its steps of the procedure, and deliveries that do not belong to it.


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
