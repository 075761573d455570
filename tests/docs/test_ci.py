"""The workflow files: valid YAML for their services, and steps that gate in a temporary project."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from typer.testing import CliRunner

from helpers.toml_edit import edit_toml
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.line.library_folder import library_folder

CI = Path(__file__).parents[2] / "docs" / "ci"
PASSING = library_folder() / "en50318-2002" / "known-passing-code"
GITHUB = yaml.safe_load((CI / "github.yml").read_text())
GITLAB = yaml.safe_load((CI / "gitlab.yml").read_text())

STEPS = [step for step in GITHUB["jobs"]["conformance"]["steps"] if "run" in step and step["name"] != "Install"]


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Repository as on the page; its simulator copies published results, which the plan accepts unconfirmed."""
    shutil.copy(CI / "conformance.toml", tmp_path)
    shutil.copytree(PASSING, tmp_path / "solver")
    script = tmp_path / "simulate.sh"
    script.write_text('#!/bin/sh\nmkdir -p "$1" && cp solver/*.toml "$1"\n')
    script.chmod(0o755)
    plan = tmp_path / "conformance.toml"
    formats = ["json", "junit", "md", "badge", "annotations", "codequality"]  # the certificate is tested elsewhere
    accepted = {"accept_unconfirmed": ["published passing code (Wang et al.)"], "verdicts": "criteria"}
    edit_toml(plan, accepted | {"formats": formats})
    gated = plan.read_text()
    edit_toml(plan, {"baseline": None, "drift_pct": None})
    monkeypatch.chdir(tmp_path)
    subprocess.run(["./simulate.sh", "records"], check=True)
    assert CliRunner().invoke(app, ["run", "--plan", "conformance.toml"]).exit_code == 0
    (tmp_path / "baseline").mkdir()
    shutil.move(tmp_path / "report" / "results.json", tmp_path / "baseline")
    plan.write_text(gated)
    return tmp_path


def run_job(folder: Path) -> int:
    """Run the steps of the job in order and return its exit code; some steps run after a failure, too."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "GITHUB_STEP_SUMMARY": str(folder / "page.md"), "OMP_NUM_THREADS": "1"}
    code = 0
    for step in STEPS:
        if code == 0 or step.get("if") == "always()":
            shell = ["bash", "-eo", "pipefail", "-c", step["run"]]
            done = subprocess.run(shell, cwd=folder, env=environment, capture_output=True, text=True, check=False)
            assert "Traceback" not in done.stderr
            check_suspended_commands(done.stdout)
            code = code or done.returncode
    return code


def check_suspended_commands(output: str) -> None:
    """Everything between the suspension of commands and its end is text; the annotations follow."""
    if found := re.search(r"^::stop-commands::(\w{32})$", output, re.MULTILINE):
        assert output.count(f"::{found[1]}::") == 1
        assert "::error" not in output.split(f"::{found[1]}::", 1)[0]


@pytest.mark.thorough
def test_job_passes_and_fails_by_the_baseline(project: Path) -> None:
    assert run_job(project) == 0
    solver = project / "solver" / "250.toml"
    # A standard deviation 2 % larger is within its limits, so only the baseline detects it.
    edit_toml(solver, {"pantograph.0.std_force_N": 28.15})
    assert run_job(project) == 1
    assert "drift of std_force_N" in (project / "report" / "junit.xml").read_text()
    [line] = (project / "report" / "annotations.txt").read_text().splitlines()
    assert re.match(r"::error file=conformance\.toml,line=\d+,title=.*drift of std_force_N of pantograph 1::28", line)
    assert [line.split(":")[0] for line in (project / "page.md").read_text().splitlines() if line[:2] == "# "] == [
        "# PASS", "# FAIL",
    ]  # fmt: skip


def test_both_services_run_the_same_commands_by_their_keys() -> None:
    job = [step["run"] for step in STEPS if step.get("if") != "always()"]
    assert GITLAB["conformance"]["script"][0] == job[0]
    assert GITLAB["conformance"]["script"][1] in job[1]
    job = GITHUB["jobs"]["conformance"]
    assert GITHUB[True] == ["push", "pull_request"]  # YAML 1.1 reads the key `on` as true; the service does not
    assert {"runs-on", "steps", "timeout-minutes"} <= set(job)
    assert all(("uses" in step) != ("run" in step) for step in job["steps"])
    assert GITLAB["conformance"]["artifacts"]["reports"]["junit"] == "report/junit.xml"
    assert GITLAB["conformance"]["artifacts"]["when"] == "always"
    installs = [step["run"] for step in job["steps"] if step.get("name") == "Install"]
    assert installs == GITLAB["conformance"]["before_script"]
