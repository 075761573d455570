"""Changes of inputs on the command line: a changed case is that of edited files, and all outputs state the changes."""

import csv
import json
import tomllib
from pathlib import Path
from typing import Any

import pytest

from helpers.case_fixtures import EditedCase
from helpers.command_line import pantocheck
from pantocheck.conformance import open_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.case_parts import change_tree
from pantocheck.conformance.cases.converged_file import find_converged
from pantocheck.conformance.cases.input_changes import InputChange, build_change, parse_changes
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.cases.limits import own_limits
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.case_identity import compare_with_library
from pantocheck.conformance.grading.case_verification import find_obstacle
from pantocheck.conformance.records.record_writing import write_record

TENSION = "line.contact_wire.tension_N=21e3"
STATED = "line.contact_wire.tension_N = 21000.0 (file: 20000.0)"


def change(*texts: str, case: str = "en50318-2002/250") -> Case:
    """Library case with changes."""
    return select_cases([case], parse_changes(texts))[-1]


@pytest.mark.parametrize(
    ("text", "file", "changes"),
    [
        ("speed_km_h=300", "250.toml", {"speed_km_h": 300.0}),
        ("evaluated_spans=[4, 6]", "250.toml", {"evaluated_spans": [4, 6]}),
        ("filter.cutoff_Hz = 10.0", "250.toml", {"filter.cutoff_Hz": 10.0}),
        ("pantograph.uplift_force_N=130", "250.toml", {"pantograph.0.uplift_force_N": 130.0}),
        (TENSION, "line.toml", {"contact_wire.tension_N": 21e3}),
        ("line.droppers.x_m[2]=11.0", "line.toml", {"droppers.x_m.1": 11.0}),
        ("line.steady_arm.static_share=none", "line.toml", {"steady_arm.static_share": "none"}),
        ("line.damping.droppers.stiffness_coefficient_s=2e-4", "line.toml", {"damping.droppers": None}),
        ("pantograph[1].chain.masses_kg=[15.0, 8.0]", "pantograph.toml", {"chain.masses_kg": [15.0, 8.0]}),
    ],
)
def test_changed_case_is_that_of_an_edited_file(
    text: str, file: str, changes: dict[str, Any], edited_case: EditedCase, case_250: Case
) -> None:
    if "damping" in text:  # a missing table is added
        droppers = case_250.line.damping.droppers.model_dump() | {"stiffness_coefficient_s": 2e-4}
        changes = {"damping.droppers": droppers}
    changed, edited = change(text), load_case(edited_case(file, changes))
    assert changed.digest == edited.digest != case_250.digest
    assert compare_with_library(changed) == compare_with_library(edited) == "modified"
    assert edited.limits == case_250.limits
    assert changed.limits == changed.file.limit == ()  # they were published for the inputs of the library
    assert len(changed.changes) == 1
    converged = find_converged(changed.id)
    assert find_obstacle(case_250, converged) is None
    assert find_obstacle(changed, converged) == find_obstacle(edited, converged) is not None


def test_changed_inputs_are_provisional_and_their_damping_kept() -> None:
    trust = {item.group: item.trust for item in change("speed_km_h=300", TENSION).inputs}
    assert trust["case"] == trust["line.contact_wire"] == "secondary"
    assert trust["case.speed_km_h"] == trust["line.contact_wire.tension_N"] == "provisional"
    case = open_case("vovan2015/mass-drop/printed").with_({"line.damping.stitch_wire.stiffness_coefficient_s": 1e-3})
    assert case.case.line.damping.stitch_wire.stiffness_coefficient_s == 1e-3


def test_value_of_the_file_changes_nothing(case_250: Case, edited_case: EditedCase) -> None:
    assert change("speed_km_h=250", "line.contact_wire.tension_N=20000") == case_250
    own = load_case(edited_case("250.toml", {"id": "own/a"}), parse_changes([TENSION]))
    assert (own.limits, len(own.changes)) == (own_limits(case_250.limits), 1)
    # A key that also takes a single number keeps it.
    changes = parse_changes(["spacing_m=85", "speed_km_h=300", "line.droppers.x_m[2]=9.5"])
    assert [change.value for change in changes] == [[85], 300, 9.5]


def test_pantographs_and_required_cases_are_changed_together() -> None:
    name = "en50318-2018/ac-simple/275-twin"
    both = change("pantograph.contact.stiffness_N_m=6e4", case=name)
    second = change("pantograph[2].contact.stiffness_N_m=6e4", "pantograph[2].target_mean_force_N=150", case=name)
    assert [model.contact.stiffness_N_m for model in both.pantographs] == [6e4, 6e4]
    assert [model.contact.stiffness_N_m for model in second.pantographs] == [5e4, 6e4]
    assert [use.target_mean_force_N for use in second.file.pantograph] == [144.0, 150.0]
    changes = parse_changes(["line.contact_wire.tension_N=23e3", "speed_km_h=280"])
    static, passage = select_cases(["en50318-2018/ac-simple/275"], changes)
    assert static.is_static
    assert static.line == passage.line
    assert static.changes == ("line.contact_wire.tension_N = 23000.0 (file: 22000.0)",)
    assert passage.changes == ("speed_km_h = 280 (file: 275.0)", *static.changes)


def test_changed_library_case_never_passes_by_its_limits(wave: Any, tmp_path: Path, case_250: Case) -> None:
    """Another filter could move a value into a limit that was published for the filter of the case."""
    write_record(tmp_path / "records" / "a.csv", wave().record(case_250), case_250.id)
    source = f"record:{tmp_path / 'records'}"
    arguments = ("run", case_250.id, "--system", source, "--formats", "json", "--out", tmp_path)
    result = pantocheck(*arguments, "--verdicts", "criteria", "--set", "filter.cutoff_Hz=5")
    assert (result.exit_code, result.output.split()[0]) == (3, "INFO")
    assert "The limits of the library do not apply." in result.output


def test_long_keys_and_values_are_shortened_in_messages() -> None:
    with pytest.raises(InputError, match=r" '\?{80}': is not a key"):
        build_change("?" * 100, 1.0)
    for length, shown in ((198, f'"{"x" * 198}"'), (199, f'"{"x" * 196}...')):
        title = InputChange("title", "case", None, ("title",), "x" * length)
        (text,) = change_tree({}, CaseFile, [title])[1]
        assert text == f"title = {shown} (not in the file)"
    assert change("line.title=Own").line.title == "Own"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("speed_kmh=300", "key speed_kmh: unknown key.\n  Did you mean speed_km_h ?"),
        ("tension_N=3", "Did you mean line.contact_wire.tension_N or line.messenger_wire.tension_N or"),
        ("contact_wire.tension_N=3", "Did you mean line.contact_wire.tension_N ?"),
        ("line.contact_wire.tension_kN=22", "Forces are given in newtons: did you mean tension_N = 22000.0 ?"),
        ("line.contact_wire.tenson_N=22", "Did you mean line.contact_wire.tension_N ?"),
        ("line.dropper=1", "Did you mean line.droppers ?"),
        ("pantograph[1].chain.mass_kg=[1]", "Did you mean pantograph[1].chain.masses_kg ?"),
        ("pantograph[2].chain.masses_kg=[1]", "the case has 1 pantograph"),
        ("pantograph[2].uplift_force_N=100", "the case has 1 pantograph"),
        ("pantograph[0].uplift_force_N=100", "is not of the form KEY=VALUE"),
        ("line.droppers.x_m[12]=55", "droppers.x_m has 9 items"),
        ("line=3", "key line: found 3, expected text in quotes"),
        ("pantograph=3", "key pantograph[1]: found 3, expected a table"),
        ("speed_km_h[1]=3", "key speed_km_h[1]: is not a list"),
        ("speed_km_h", "is not of the form KEY=VALUE"),
        ("speed_km_h=3 0", "'3 0' is not a value"),
        ("speed_km_h=fast", "found 'fast', expected a number"),
        ("speed_km_h=900", "250.toml' with --set speed_km_h = 900 (file: 250.0), key speed_km_h: 900 must be at most"),
        ("line.droppers.x_m=[70.0]", "70 m is not inside the span of 60 m"),
        ("id=own/a", "cannot be changed on the command line"),
        ("requires[1]=own/a", "cannot be changed on the command line"),
        ("line.geometry.trust=primary", "cannot be changed on the command line"),
        ("limit[1].upper=3", "Give your limits in a file with --limits"),
    ],
)
def test_wrong_change_names_the_key_and_suggests(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        change(text)
    assert message in str(caught.value)
    assert "--set" in str(caught.value)


def test_all_outputs_state_the_changes(wave: Any, tmp_path: Path) -> None:
    """A case with the same force record: it does not pass either, and its results name the changed inputs."""
    case = change(TENSION)
    write_record(tmp_path / "records" / "a.csv", wave().record(case), case.id)
    arguments = ("run", case.id, "--system", f"record:{tmp_path / 'records'}", "--formats", "json,csv,html,md,junit")
    plain, changed = tmp_path / "plain", tmp_path / "changed"
    exit_code = pantocheck(*arguments, "--out", plain).exit_code
    result = pantocheck(*arguments, "--out", changed, "--set", TENSION)
    assert (result.exit_code, exit_code) == (3, 1)
    assert STATED in result.output.replace("\n", " ")
    (graded,) = json.loads((changed / "results.json").read_text())["cases"]
    assert (graded["changes"], graded["library"]) == ([STATED], "modified")
    assert graded["verification"]["verdict"] == "info"
    rows = list(csv.DictReader((changed / "quantities.csv").read_text().splitlines()))
    assert rows
    assert {row["changes"] for row in rows} == {STATED}
    for name, text in (
        ("certificate.html", f"The limits of the library do not apply. Inputs changed with --set: {STATED}"),
        ("summary.md", "Cases with inputs changed with --set: 1."),
        ("junit.xml", STATED),
    ):
        assert text in (changed / name).read_text().replace("\\", "")
        assert text not in (plain / name).read_text().replace("\\", "")
    (graded,) = json.loads((plain / "results.json").read_text())["cases"]
    assert (graded["changes"], graded["library"]) == ([], "identical")


def test_record_of_a_changed_case_states_the_changes(tmp_path: Path, edited_case: EditedCase) -> None:
    """The record belongs to the changed case only."""
    path = edited_case("250.toml", {"id": "own/a", "evaluated_spans": [3], "discretisation": {"element_m": 2.0}})
    out = tmp_path / "records" / "a.csv"
    result = pantocheck("simulate", path, "--out", out, "--set", TENSION)
    assert result.exit_code == 0, result.output
    sidecar = tomllib.loads(out.with_suffix(".toml").read_text())
    changed = load_case(path, parse_changes([TENSION]))
    assert (sidecar["changes"], sidecar["case_digest"]) == ([STATED], changed.digest)
    arguments = ("run", path, "--system", f"record:{out.parent}", "--formats", "json", "--out", tmp_path / "report")
    assert pantocheck(*arguments, "--set", TENSION).exit_code == 1
    result = pantocheck(*arguments)
    assert result.exit_code == 2
    assert result.output.startswith("ERROR")


def test_changes_need_a_named_case_and_a_known_key_in_a_plan(tmp_path: Path) -> None:
    result = pantocheck("run", "--set", "speed_km_h=300", "--out", tmp_path)
    assert result.exit_code == 2
    assert "option --set: no case is named" in result.stderr
    plan = tmp_path / "plan.toml"
    plan.write_text('cases = ["en50318-2002/250"]\nsystem = "record:none"\nset = ["speed_kmh=300"]\n')
    result = pantocheck("run", "--plan", plan)
    assert result.exit_code == 2
    assert "Did you mean speed_km_h ?" in result.stderr


# Changes of the damping of a line that its case replaces.
@pytest.mark.parametrize("key", ["modal", "contact_wire.stiffness_coefficient_s"])
def test_a_change_without_effect_is_refused(key: str) -> None:
    """The case has its own damping of the wires, and modal bands are valid with one fit only."""
    value = [] if key == "modal" else 1e-3
    with pytest.raises(InputError, match=f"line.damping.{key}: has no effect.*\n.*key damping of the case"):
        open_case("vovan2015/mass-drop/printed").with_({f"line.damping.{key}": value})
