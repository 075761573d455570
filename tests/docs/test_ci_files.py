"""Action, hooks, container file and hosted workflows: their steps run here, and what they name exists."""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml
from typer.testing import CliRunner

from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.app.file_check import check_input_file
from pantocheck.conformance.line.library_folder import library_folder

ROOT = Path(__file__).parents[2]
ACTION = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
HOOKS = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
WORKFLOW = yaml.safe_load((ROOT / ".github" / "workflows" / "checks.yml").read_text(encoding="utf-8"))
CONTAINER = (ROOT / "Containerfile").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))

WORKFLOWS = (ROOT / "action.yml", ROOT / ".github/workflows/checks.yml", ROOT / "docs/ci/github.yml")

PINNED = {
    "actions/checkout": "11bd71901bbe5b1630ceea73d27597364c9af683 # v4.2.2",
    "actions/setup-python": "a26af69be951a213d495a4c3e4e4022e16d87065 # v5.6.0",
    "actions/cache": "5a3ec84eff668545956fd18022155c47e93e2684 # v4.2.3",
    "actions/upload-artifact": "ea165f8d65b6e75b540449e92b4886f43607fa02 # v4.6.2",
}
"""Commit and version of each action; docs/ci.md states how they were verified."""

REPORT = "https://example.org/report.zip"


def test_actions_are_pinned_and_the_matrix_has_three_systems_and_the_supported_versions() -> None:
    for path in WORKFLOWS:
        for name, version in re.findall(r"uses: ([\w./-]+)@(.+)", path.read_text(encoding="utf-8")):
            assert PINNED[name] == version.strip(), path.name
    jobs = WORKFLOW["jobs"]
    assert jobs["others"]["strategy"]["matrix"]["os"] == ["windows-latest", "macos-latest"]
    versions = jobs["linux"]["strategy"]["matrix"]["python"]
    assert f">={versions[0]}" == PROJECT["project"]["requires-python"]
    assert set(jobs["others"]["strategy"]["matrix"]["python"]) <= set(versions)
    assert WORKFLOW["permissions"] == {"contents": "read"}
    assert all("timeout-minutes" in job for job in jobs.values())


def action_step(name: str) -> dict[str, Any]:
    [step] = [step for step in ACTION["runs"]["steps"] if name in (step.get("id"), step.get("name"))]
    return step  # type: ignore[no-any-return]


def run_step(name: str, folder: Path, **inputs: str) -> subprocess.CompletedProcess[str]:
    """Run a step of the action as the service does: inputs as variables, and files for output and summary."""
    values = {key: entry["default"] for key, entry in ACTION["inputs"].items()} | inputs
    known = {f"inputs.{key}": value for key, value in values.items()} | {
        "runner.temp": str(folder / "temp"),
        "steps.upload.outputs.artifact-url": REPORT if values["artifact"] else "",
        "steps.grade.outputs.exit-code": read_output(folder, "exit-code"),
    }
    step = action_step(name)
    variables = {
        key: re.sub(r"\$\{\{ (.*?) \}\}", lambda match: known[match[1]], text)
        for key, text in step.get("env", {}).items()
    }
    assert "${{" not in step["run"]  # an input would be code
    environment = {
        **os.environ, **variables, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "GITHUB_OUTPUT": str(folder / "output"), "GITHUB_STEP_SUMMARY": str(folder / "page.md"),
        "GITHUB_WORKSPACE": str(folder),
    }  # fmt: skip
    working = ROOT if "working-directory" in step else folder
    shell = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]]
    return subprocess.run(shell, cwd=working, env=environment, capture_output=True, text=True, check=False)


def read_output(folder: Path, name: str) -> str:
    output = folder / "output"
    lines = output.read_text().splitlines() if output.exists() else []
    return dict(line.split("=", 1) for line in lines).get(name, "")


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """Checkout with records, and the environment of the action with the command of this project."""
    shutil.copytree(library_folder() / "en50318-2002" / "known-passing-code", tmp_path / "my records")
    program = tmp_path / "temp" / "pantocheck-environment" / "bin" / "pantocheck"
    program.parent.mkdir(parents=True)
    program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m pantocheck "$@"\n')
    program.chmod(0o755)
    return tmp_path


def test_action_grades_annotates_and_summarises(checkout: Path) -> None:
    inputs = {
        "cases": "en50318-2002/250\nen50318-2002/300\n",
        "system": "record:my records",
        "formats": "md,annotations",
    }
    graded = run_step("grade", checkout, **inputs)
    assert (graded.returncode, read_output(checkout, "exit-code")) == (0, "1")
    token = re.search(r"^::stop-commands::(\w{32})$", graded.stdout, re.MULTILINE)
    assert token is not None
    before, after = graded.stdout.split(f"::{token[1]}::\n")
    assert "::error" not in before
    assert after.splitlines()
    assert all(line.startswith(("::error ", "::warning ")) for line in after.splitlines())
    ended = run_step("Summarise", checkout, **inputs)
    assert ended.returncode == 1
    assert (checkout / "page.md").read_text(encoding="utf-8").startswith("# FAIL")


def test_action_passes_a_plan_and_links_the_uploaded_certificate(checkout: Path) -> None:
    (checkout / "plan.toml").write_text(
        'cases = ["en50318-2002/250"]\nsystem = "record:my records"\nverdicts = "criteria"\n'
        'accept_unconfirmed = ["published passing code (Wang et al.)"]\n'
    )
    inputs = {"plan": "plan.toml", "formats": "html,md,annotations", "out": "my report"}
    graded = run_step("grade", checkout, **inputs)
    assert (graded.returncode, read_output(checkout, "exit-code")) == (0, "0")
    assert run_step("Summarise", checkout, **inputs).returncode == 0
    assert f"Certificate: [certificate.html]({REPORT})" in (checkout / "page.md").read_text(encoding="utf-8")


def test_inputs_of_the_action_are_no_code(checkout: Path) -> None:
    hostile = "$(touch hacked) `touch hacked`; touch hacked"
    inputs = {"cases": hostile, "system": hostile, "out": "out", "trust": hostile, "plan": "", "formats": "md"}
    assert run_step("grade", checkout, **inputs).returncode == 0
    assert read_output(checkout, "exit-code") == "2"
    assert not (checkout / "hacked").exists()
    assert run_step("Summarise", checkout, **inputs).returncode == 2


def test_cache_of_the_action_follows_packages_and_kernels(checkout: Path) -> None:
    digests = []
    for extras in ("simulator,pdf", "simulator"):
        assert run_step("digest", checkout, extras=extras).returncode == 0
        digests.append(read_output(checkout, "digest"))
    assert len(set(digests)) == 2
    assert all(re.fullmatch("[0-9a-f]{64}", digest) for digest in digests)


@pytest.mark.parametrize("hook", HOOKS, ids=lambda hook: hook["id"])
def test_hook_accepts_the_files_that_it_selects_and_refuses_damaged_ones(hook: dict[str, Any], tmp_path: Path) -> None:
    for kind, folder in (("line", "lines"), ("pantograph", "pantographs"), ("case", "cases")):
        (tmp_path / folder).mkdir()
        named = ["--line", "../lines/my.toml", "--pantograph", "../pantographs/my.toml"] if kind == "case" else []
        created = tmp_path / folder / "my.toml"
        assert CliRunner().invoke(app, ["new", kind, str(created), *named]).exit_code == 0
    shutil.copy(ROOT / "docs" / "ci" / "conformance.toml", tmp_path)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    selected = [
        path for path in tmp_path.rglob("*.toml") if re.search(hook["files"], path.relative_to(tmp_path).as_posix())
    ]
    assert selected
    assert "pyproject.toml" not in [path.name for path in selected]
    program, *arguments = hook["entry"].split()
    assert program in PROJECT["project"]["scripts"]
    assert CliRunner().invoke(app, [*arguments, *map(str, selected)]).exit_code == 0
    selected[0].write_text("nonsense = 1\n")
    assert CliRunner().invoke(app, [*arguments, *map(str, selected)]).exit_code == 2


def read_instructions() -> list[tuple[str, str]]:
    """Instructions of the container file, continued lines joined."""
    text = re.sub(r"\\\n\s*", " ", CONTAINER)
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    return [(line.split(maxsplit=1)[0], line.split(maxsplit=1)[1]) for line in lines]


def test_container_file_copies_all_packages_and_runs_as_a_user() -> None:
    instructions = read_instructions()
    copied = {
        name for kind, text in instructions if kind == "COPY" and "--from" not in text for name in text.split()[:-1]
    }
    assert all((ROOT / name).exists() for name in copied)
    needed = {PROJECT["project"]["readme"], *PROJECT["tool"]["setuptools"]["package-dir"].values(), "pyproject.toml"}
    assert needed <= copied
    names = [kind for kind, _ in instructions]
    assert names.count("FROM") == 2
    assert names.index("USER") < names.index("ENTRYPOINT")
    facts = dict(instructions)
    assert facts["USER"] not in ("root", "0")
    assert facts["ENTRYPOINT"] == '["pantocheck"]'
    [version] = re.findall(r"^ARG PYTHON=([\d.]+)$", CONTAINER, re.MULTILINE)
    lowest = PROJECT["project"]["requires-python"].removeprefix(">=")
    assert [int(part) for part in version.split(".")] >= [int(part) for part in lowest.split(".")]
    assert version == ACTION["inputs"]["python-version"]["default"]
    extras = ACTION["inputs"]["extras"]["default"]
    assert f"[{extras}]" in CONTAINER
    assert set(extras.split(",")) <= PROJECT["project"]["optional-dependencies"].keys()


@pytest.mark.thorough
def test_build_steps_of_the_container_make_a_wheel(tmp_path: Path) -> None:
    """The instructions of the first stage, run in a folder that holds the copied files only."""
    source, wheels = tmp_path / "source", tmp_path / "wheels"
    source.mkdir()
    first_stage = CONTAINER.split("\nFROM ")[1]
    for names in re.findall(r"^COPY (.*)$", first_stage, re.MULTILINE):
        *sources, target = names.split()
        for name in sources:
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, source / target, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy(ROOT / name, source)
    *_, command = re.findall(r"^RUN (.*)$", first_stage, re.MULTILINE)  # after those of the distribution
    command = command.replace("python ", f"{shlex.quote(sys.executable)} ", 1).replace("/wheels", str(wheels))
    subprocess.run(["sh", "-c", command], cwd=source, check=True, capture_output=True)
    [wheel] = wheels.glob("*.whl")
    assert wheel.name.startswith(f"pantocheck-{PROJECT['project']['version']}-")


def list_runs(jobs: dict[str, Any]) -> list[str]:
    return [line for job in jobs.values() for step in job["steps"] for line in step.get("run", "").splitlines()]


def test_commands_of_the_workflow_name_files_of_the_repository() -> None:
    runs = list_runs(WORKFLOW["jobs"])
    sections = re.findall(
        r"^    ([\w |]+)\) run=", (ROOT / ".ci" / "thorough").read_text(encoding="utf-8"), re.MULTILINE
    )
    known = {name.strip() for part in sections for name in part.split("|")}
    for line in runs:
        for word in line.split():
            if word.startswith(("tests/", ".ci/")) or word == "Containerfile":
                assert (ROOT / word).exists(), word
        if ".ci/thorough" in line:
            assert set(line.split(".ci/thorough", 1)[1].split()) <= known
    assert any(".ci/run" in line for line in runs)
    assert check_input_file(ROOT / "docs" / "ci" / "conformance.toml") == "plan file"


@pytest.mark.parametrize(
    ("schema", "names"),
    [
        (
            "vendor.github-workflows",
            [".github/workflows/checks.yml", "docs/ci/github.yml", "docs/ci/github-action.yml"],
        ),
        ("vendor.github-actions", ["action.yml"]),
        ("vendor.gitlab-ci", ["docs/ci/gitlab.yml"]),
    ],
)
def test_files_fit_the_schemas_of_their_services(schema: str, names: list[str]) -> None:
    pytest.importorskip("check_jsonschema", reason="check-jsonschema is not installed: pip install check-jsonschema")
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", schema]
    done = subprocess.run(
        [*command, *(str(ROOT / name) for name in names)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout
