"""Annotations: failed criteria at the lines of the user's files, and texts of other people that stay in their field."""

import json
import os
import re
import shutil
from pathlib import Path
from typing import Any, NamedTuple

import jsonschema
import pytest
from typer.testing import CliRunner

from helpers.toml_edit import edit_toml
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pages.ci_reports import (
    MOST_SHOWN,
    list_annotations,
    render_code_quality,
    render_workflow_commands,
    shorten_path,
)
from pantocheck.conformance.results.file_places import FilePlace, ReportPlaces
from pantocheck.conformance.results.results_format import Results

PASSING = library_folder() / "en50318-2002" / "known-passing-code"
ACCEPTED = "published passing code (Wang et al.)"


class Command(NamedTuple):
    """Workflow command as the service reads it."""

    name: str
    properties: dict[str, str]
    message: str


def read_command(line: str) -> Command:
    """Reading of a line by the rules of the service: properties end at the first `::`, and `,` separates them."""
    found = re.fullmatch(r"::([a-z]+) (.*?)::(.*)", line)
    assert found is not None
    pairs = dict(part.split("=", 1) for part in found[2].split(","))
    properties = {key: unescape(text.replace("%3A", ":").replace("%2C", ",")) for key, text in pairs.items()}
    return Command(found[1], properties, unescape(found[3]))


def unescape(text: str) -> str:
    return text.replace("%0D", "\r").replace("%0A", "\n").replace("%25", "%")


def line_of(path: Path, start: str) -> int:
    return next(i for i, line in enumerate(path.read_text().splitlines(), 1) if line.startswith(start))


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Plan with a library case, an own case whose second limit fails, and a limits file that the library case fails."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("GITHUB_WORKSPACE", raising=False)
    shutil.copytree(PASSING, tmp_path / "records")
    own = (library_folder() / "en50318-2002" / "300.toml").read_text().replace('id = "en50318-2002/300"', 'id = "mine"')
    (tmp_path / "mine.toml").write_text(own)
    models = {"line": "en50318-2002/line.toml", "pantograph.0.model": "en50318-2002/pantograph.toml"}
    edit_toml(tmp_path / "mine.toml", {"limit.1.upper": 27.0, "limit.1.lower": 26.0, **models})
    edit_toml(tmp_path / "records" / "300.toml", {"case": "mine"})
    (tmp_path / "limits.toml").write_text(
        '# own\n[[limit]]\ncase = "*/250"\nquantity = "mean_force_N"\nupper = 100.0\n'
        'trust = "primary"\nsource = "own"\n'
    )
    (tmp_path / "plan.toml").write_text(
        'system = "record:records"\nout = "report"\nverdicts = "criteria"\nlimits = "limits.toml"\n'
        f'accept_unconfirmed = ["{ACCEPTED}"]\nformats = ["annotations", "codequality", "junit", "md"]\n'
        'cases = ["en50318-2002/250", "mine.toml"]\n'
    )
    return tmp_path


def run_plan(folder: Path, *arguments: str) -> list[Command]:
    assert CliRunner().invoke(app, ["run", "--plan", "plan.toml", *arguments]).exit_code == 1
    text = (folder / "report" / "annotations.txt").read_text("utf-8")
    return [read_command(line) for line in text.splitlines()]


def test_failed_limits_are_annotated_at_their_lines(project: Path) -> None:
    commands = run_plan(project)
    own = line_of(project / "mine.toml", 'quantity = "std_force_N"') - 1
    assert [(command.name, command.properties) for command in commands] == [
        ("error", {"file": "limits.toml", "line": "2", "title": "en50318-2002/250: mean_force_N of pantograph 1"}),
        ("error", {"file": "mine.toml", "line": str(own), "title": "mine: std_force_N of pantograph 1"}),
    ]
    assert commands[0].message.startswith("118.2 N, limits <= 100, margin -0.182, own")
    # The code quality report has the same places.
    issues = json.loads((project / "report" / "codequality.json").read_text())
    assert [issue["location"] for issue in issues] == [
        {"path": "limits.toml", "lines": {"begin": 2}},
        {"path": "mine.toml", "lines": {"begin": own}},
    ]
    assert {issue["severity"] for issue in issues} == {"critical"}
    assert len({issue["fingerprint"] for issue in issues}) == len(issues)
    # Required keys as in the documentation of GitLab CI/CD, code quality report format.
    required = ["description", "check_name", "fingerprint", "severity", "location"]
    jsonschema.validate(issues, {"type": "array", "items": {"type": "object", "required": required}})


def test_missing_record_is_a_warning_at_the_case_and_drift_an_error_at_the_baseline(project: Path) -> None:
    (project / "limits.toml").unlink()
    edit_toml(project / "plan.toml", {"limits": None, "cases": ["en50318-2002/250"]})
    assert CliRunner().invoke(app, ["run", "--plan", "plan.toml"]).exit_code == 0
    assert (project / "report" / "annotations.txt").read_text() == ""
    assert json.loads((project / "report" / "codequality.json").read_text()) == []
    shutil.move(project / "report" / "results.json", project / "earlier.json")
    edit_toml(project / "plan.toml", {"baseline": "earlier.json", "cases": ["en50318-2002/250", "mine.toml"]})
    edit_toml(project / "records" / "250.toml", {"pantograph.0.max_force_N": 197.0})  # 1.7 % more; 1 % may drift
    (project / "records" / "300.toml").unlink()
    drift, *missing = run_plan(project)
    baseline = str(line_of(project / "plan.toml", "baseline"))
    title = "en50318-2002/250: drift of max_force_N of pantograph 1"
    assert drift[:2] == ("error", {"file": "plan.toml", "line": baseline, "title": title})
    assert {command.name for command in missing} == {"warning"}
    assert {command.properties["file"] for command in missing} <= {"mine.toml", "plan.toml"}
    assert any(command.properties["file"] == "mine.toml" for command in missing)


def test_library_case_without_a_plan_has_no_file(project: Path) -> None:
    arguments = ["run", "en50318-2002/250", "--limits", "limits.toml", "--system", "record:records"]
    CliRunner().invoke(app, [*arguments, "--verdicts", "criteria", "--formats", "annotations,codequality"])
    first, record = map(read_command, (project / "report" / "annotations.txt").read_text().splitlines())
    assert first.properties["file"] == "limits.toml"
    assert record.properties == {"title": "en50318-2002/250: record"}
    paths = [i["location"]["path"] for i in json.loads((project / "report" / "codequality.json").read_text())]
    assert paths == ["limits.toml", "report/results.json"]  # a place is required there


def test_assessed_record_and_own_profile_are_the_places_of_an_assessment(project: Path) -> None:
    (project / "profile.toml").write_text(
        'schema = "pantocheck.profile/1"\nname = "mine"\ntitle = "Mine"\n\n[[rule]]\nquantity = "mean_force_N"\n'
        'upper = 100.0\ntrust = "primary"\nsource = "own"\n'
    )
    arguments = ["assess", "records/250.toml", "--profile", "profile.toml", "--formats", "annotations"]
    assert CliRunner().invoke(app, arguments).exit_code == 1
    commands = [read_command(line) for line in (project / "report" / "annotations.txt").read_text().splitlines()]
    (command,) = commands
    assert (command.properties["file"], command.properties.get("line")) == ("profile.toml", "5")


HOSTILE = "50 %::stop-commands::x\r\n::add-mask::secret,file=other.toml\n##[add-mask]a\x1b[31m\u202e%0A::error::"


def test_texts_of_other_people_stay_in_their_field(results: dict[str, Any], tmp_path: Path) -> None:
    """A case, a reason and a file name that imitate workflow commands; one line per annotation, and nothing is lost."""
    case = results["cases"][1]
    case |= {"id": HOSTILE, "title": HOSTILE}
    case["criteria"][0] |= {"verdict": "fail", "quantity": HOSTILE, "reason": HOSTILE, "unit": HOSTILE}
    path = tmp_path / "a,line=9::b%0A:c.toml"
    annotations = list_annotations(Results.model_validate(results), ReportPlaces(FilePlace(path, 3)))
    text = render_workflow_commands(annotations).decode()
    lines = re.split("[\r\n\v\f\x1c-\x1e\x85\u2028\u2029]", text.removesuffix("\n"))
    assert len(lines) == len(annotations) > 1
    for line, annotation in zip(lines, annotations, strict=True):
        command = read_command(line)
        title = f"{annotation.group}: {annotation.name}"
        assert command.properties == {"file": path.as_posix(), "line": "3", "title": title}
        assert command.message == annotation.text
    issues = json.loads(render_code_quality(annotations, tmp_path / "results.json"))
    assert [issue["location"]["path"] for issue in issues] == [path.as_posix()] * len(annotations)


def test_more_errors_than_the_service_shows_end_in_their_number(results: dict[str, Any]) -> None:
    rows = results["cases"][0]["criteria"]
    results["cases"][0]["criteria"] = [rows[0] | {"verdict": "fail", "item": i + 1} for i in range(25)]
    annotations = list_annotations(Results.model_validate(results), ReportPlaces())
    errors = [line for line in render_workflow_commands(annotations).decode().splitlines() if line[:7] == "::error"]
    total = sum(annotation.severity == "error" for annotation in annotations)
    assert len(errors) == MOST_SHOWN
    assert errors[-1].startswith(f"::error title=pantocheck::{total - 9} more")


def test_run_without_a_limit_that_counts_has_one_warning(passing: dict[str, Any]) -> None:
    case = passing["cases"][0]
    case |= {"verdict": "info", "criteria": [row | {"verdict": "info"} for row in case["criteria"]]}
    passing |= {"verdict": "info", "cases": [case]}
    [annotation] = list_annotations(Results.model_validate(passing), ReportPlaces())
    assert (annotation.severity, annotation.text) == ("warning", "1 case computed, no limit to judge it.")


def test_paths_are_relative_to_the_checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CI_PROJECT_DIR", str(tmp_path))
    monkeypatch.delenv("GITHUB_WORKSPACE", raising=False)
    assert shorten_path(tmp_path / "a" / ".." / "b" / "c.toml") == "b/c.toml"
    monkeypatch.setenv("GITHUB_WORKSPACE", str(tmp_path / "b"))
    monkeypatch.chdir(tmp_path)
    assert shorten_path(Path("b", "c.toml")) == "c.toml"
    assert shorten_path(Path("c.toml")) == (tmp_path / "c.toml").as_posix()
    assert os.sep == "/" or "\\" not in shorten_path(Path("c.toml"))


def test_summary_and_junit_name_the_certificates(project: Path) -> None:
    edit_toml(project / "plan.toml", {"formats": ["html", "junit", "md"]})
    CliRunner().invoke(app, ["run", "--plan", "plan.toml"])
    assert "\nCertificate: [certificate.html](certificate.html)\n" in (project / "report" / "summary.md").read_text()
    assert '<property name="certificate" value="certificate.html" />' in (project / "report" / "junit.xml").read_text()
    assert (project / "report" / "certificate.html").is_file()
