"""Features: a program receives only cases whose parts it simulates, also those that it cannot know."""

import json
import shutil
import subprocess
import sys
import sysconfig
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import pytest
from pydantic import Field

from helpers.section_lines import section_line
from pantocheck.conformance.app.pytest_plugin.user_fixtures import run_and_grade
from pantocheck.conformance.app.self_test.adapter_check import build_short_case
from pantocheck.conformance.cases.case import RUN_FEATURES, Case, list_case_features
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.features import find_declaration
from pantocheck.conformance.core.sourced_table import InputTable, is_absent
from pantocheck.conformance.line.elements.point_mass import PointMassTable
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.runs.command_system import build_case_message
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Skipped
from pantocheck.conformance.runs.system_choice import choose_system

EXAMPLES = Path(__file__).parents[3] / "examples"


class BalloonTable(InputTable):
    """Part of a line that no program knows."""

    lift_N: Annotated[float, Field(gt=0, description="lift [N]")]


class LineWithBalloon(LineFile):
    """Line with a new element, declared without a feature."""

    balloon: Annotated[BalloonTable | None, Field(exclude_if=is_absent)] = None


@pytest.fixture
def new_case() -> Case:
    """Short case with the new element."""
    case = build_short_case()
    fields = {name: getattr(case.line, name) for name in LineFile.model_fields}
    return replace(case, line=LineWithBalloon.model_construct(**fields, balloon=BalloonTable(lift_N=10.0)))


@pytest.fixture(params=["python", "cpp", "octave", "external"])
def command(request: pytest.FixtureRequest) -> str:
    """Command of the adapter of each kit."""
    if request.param == "cpp":
        return f"'{request.getfixturevalue('compiled')}'"
    if request.param == "octave":
        if shutil.which("octave-cli") is None:
            pytest.skip("octave-cli is not installed")
        return f"octave-cli --quiet '{EXAMPLES / 'octave_catenary' / 'adapter.m'}'"
    folder = {"python": "string_catenary", "external": "external_program"}[request.param]
    program = f"'{Path(sysconfig.get_path('scripts'), 'pantocheck')}'" if request.param == "external" else ""
    return f"'{sys.executable}' '{EXAMPLES / folder / 'adapter.py'}' {program}"


def test_every_kit_refuses_a_new_element_itself(command: str, new_case: Case, tmp_path: Path) -> None:
    """The element states no feature, so that its key is the feature: the suite does not send the case."""
    outcome = choose_system(f"command:{command}", 60.0).run(new_case)
    assert outcome == Skipped("the system does not simulate balloon")
    # Second barrier: an adapter answers `skipped` even if a suite sent the case.
    message = {"message": "run", "id": 1, "folder": str(tmp_path), "time_limit_s": 9.0}
    content = build_case_message(build_short_case()) | {"features": list_case_features(new_case)}
    lines = [{"message": "start"}, message | {"case": content}, {"message": "stop"}]
    text = "\n".join(map(json.dumps, lines)) + "\n"
    done = subprocess.run(command, shell=True, input=text.encode(), cwd=tmp_path, capture_output=True, check=True)
    answer = json.loads(done.stdout.splitlines()[1])
    assert (answer["message"], answer["id"]) == ("skipped", 1)
    assert "neglects balloon" in answer["reason"]


def test_object_of_a_test_receives_only_the_features_that_it_lists() -> None:
    """An object without a list receives no case; the reference simulator simulates every feature."""

    class Own:
        name, version, kind = "own", "1", "record"

        def run(self, case: Case) -> Skipped:
            return Skipped("reached")

    own: Any = Own()
    case = "en50318-2002/250"
    assert "does not list the features" in (run_and_grade(case, own).result.reason or "")
    own.features = ["chain"]
    assert "does not simulate bending_stiffness, droppers" in (run_and_grade(case, own).result.reason or "")
    own.features = list_case_features(select_cases([case])[0])
    assert run_and_grade(case, own).result.reason == "reached"
    assert not hasattr(ReferenceSimulator(), "features")


def test_features_are_declared_documented_and_those_of_the_keys_in_use(monkeypatch: pytest.MonkeyPatch) -> None:
    [case] = select_cases(["en50318-2018/ac-stitched/320"])[-1:]
    features = list_case_features(case)
    assert {"chain", "stagger", "stitch_wire", "dropper_mass"} <= set(features)
    assert not {"sections", "point_masses", "matrices", "several_pantographs"} & set(features)
    mass = PointMassTable(x_m=150.0, wire="contact_wire", mass_kg=5.0, name="section insulator")
    added = replace(case, line=case.line.model_copy(update={"point_mass": (mass,)}))
    assert set(list_case_features(added)) - set(features) == {"point_masses"}
    monkeypatch.syspath_prepend(str(EXAMPLES.parent / "docs"))
    site = import_module("site_pages.feature_table")
    keys = list(site.list_file_keys())
    assert [path for path, field in keys if find_declaration(field) is None] == []
    names = {feature.name for _, field in keys if (feature := find_declaration(field)) and feature.name}
    assert site.RUN_USES.keys() == RUN_FEATURES.keys()
    assert [name for name in names | RUN_FEATURES.keys() if f"| `{name}` |" not in site.build_feature_table()] == []


def test_case_of_several_sections_reaches_a_program_that_simulates_them(case_250: Case) -> None:
    """The tables of the first section stand where those of a single section stand, the others behind them."""
    case = replace(case_250, line=section_line())
    assert "sections" in list_case_features(case)
    line = build_case_message(case)["derived"]["line"]
    [further] = line["further_sections"]
    limits = case.line.geometry.span_limits
    assert line["contact_wire"]["end_m"] == line["span_limits_m"][-1] > further["span_limits_m"][0]
    assert further["contact_wire"]["end_m"] == limits[-1]
    for section in (line, further):
        assert len(section["droppers"]["length_m"]) == len(section["span_limits_m"]) - 1
        assert len(section["steady_arms"]["position_m"]) == len(section["span_limits_m"]) - 2
        assert len(section["contact_wire"]["height_m"]) == len(section["span_limits_m"])
