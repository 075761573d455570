"""`pantocheck drop compare`: files, exit codes, damping files, and messages that name file and key."""

import json
import logging
from functools import partial
from pathlib import Path

import pytest
import tomli_w
from jsonschema import validate

from helpers.command_line import pantocheck
from helpers.recorded_drops import ELEMENT, damp_masses, read_short_line, record_drop
from pantocheck.conformance.app.commands.measured_comparison_command import name_damping_files
from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.core.step_log import TaskStep
from pantocheck.conformance.drops.drop_writing import write_drop_hdf5

LIMITS = """
schema = "pantocheck.comparison-limits/1"
[[limit]]
quantity = "rms_ratio"
sensors = [1, 2]
window_s = [0.0, 4.0]
band_Hz = [0.3, 20.0]
lower = 0.98
upper = 1.02
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Working folder with a record of two runs, its line, two damping files and limits."""
    monkeypatch.chdir(tmp_path)
    write_drop_hdf5((record_drop(), record_drop(noise=2e-3)), Path("drop.h5"))
    line = read_short_line().model_dump(mode="json", exclude_none=True, by_alias=True)
    Path("line.toml").write_text(tomli_w.dumps(line), encoding="utf-8")
    for name, coefficient in (("own", 0.1), ("other", 0.3)):
        tables = damp_masses(coefficient).model_dump(mode="json", exclude_unset=True)
        Path(f"{name}.toml").write_text(tomli_w.dumps({"damping": tables}), encoding="utf-8")
    Path("limits.toml").write_text(LIMITS, encoding="utf-8")
    return tmp_path


FILES = ("drop.h5", "--line", "line.toml", "--out", "out")
run = partial(pantocheck, "drop", "compare", *FILES, "--element", f"{ELEMENT}", "--window", "0:4")


def test_two_damping_files_are_compared_and_the_verdict_is_the_exit_code(folder: Path) -> None:
    done = run("--damping", "own.toml", "--damping", "other.toml", "--limits", "limits.toml", "--run", "2")
    assert done.exit_code == 0, done.output
    assert "drop run 2: 30 kg on CW, released at 3.0010 s" in done.output
    results = json.loads((folder / "out" / "drop_comparison.json").read_text())
    validate(results, build_schema("drop-comparison"))
    assert [model["name"] for model in results["models"]] == ["own", "other"]
    assert (folder / "out" / "drop_comparison.pdf").read_bytes().startswith(b"%PDF")
    # The other damping deviates by 15 %; without limits, nothing is judged.
    failed = run("--damping", "other.toml", "--limits", "limits.toml")
    assert (failed.exit_code, "FAIL" in failed.output) == (1, True), failed.output
    informative = run()
    assert (informative.exit_code, "INFO" in informative.output) == (3, True), informative.output
    results = json.loads((folder / "out" / "drop_comparison.json").read_text())
    assert [model["name"] for model in results["models"]] == ["line"]


def test_progress_has_a_share(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    """The shares of two models and of the refined simulation increase to the start of the report, at 95 %."""
    with caplog.at_level(logging.DEBUG, "pantocheck"):
        run("--damping", "own.toml", "--damping", "other.toml", "--limits", "limits.toml")
    steps = [record.step for record in caplog.records if isinstance(getattr(record, "step", None), TaskStep)]
    shares = [step.completed for step in steps]
    assert len(set(shares)) > 4
    assert shares == sorted(shares)
    assert (shares[0], steps[-1].name, shares[-1]) == (0.0, "report", pytest.approx(0.95))


def test_files_of_the_same_name_take_the_name_of_their_folder(folder: Path) -> None:
    """`drop fit` names its file damping.toml in every folder."""
    paths = [Path("fit4/damping.toml"), Path("fit/damping.toml"), Path("own.toml")]
    for path in paths[:2]:
        path.parent.mkdir()
        path.write_bytes(Path("own.toml").read_bytes())
    assert name_damping_files(paths) == ["fit4/damping", "fit/damping", "own"]
    assert name_damping_files([Path("damping.toml"), paths[1]]) == [f"{folder.name}/damping", "fit/damping"]
    done = run("--damping", "fit4/damping.toml", "--damping", "fit/damping.toml")
    results = json.loads((folder / "out" / "drop_comparison.json").read_text())
    assert [model["name"] for model in results["models"]] == ["fit4/damping", "fit/damping"], done.output


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--window", "4:1"], "--window: '4:1' is not a window after the release"),
        (["--window", "abc"], "--window: 'abc' is not a window after the release"),
        (["--run", "3"], "--run: there is no run 3"),
        (["--damping", "own.toml", "--damping", "own.toml"], "--damping: two files have the name "),
        (["--damping", "line.toml"], "damping 'line.toml', key title: unknown key"),
        (["--limits", "own.toml"], "limits 'own.toml', key"),
    ],
)
def test_wrong_option_is_named(folder: Path, arguments: list[str], message: str) -> None:
    done = run(*arguments)
    assert done.exit_code == 2, done.output
    assert message in done.output


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[0.3, 20.0]", "[0.3, 10.0]", "key limit[1].band_Hz: [0.3, 10.0] is not a compared band"),
        ("[1, 2]", "[1, 1]", "key limit[1].sensors: [1, 1] repeats a value"),
        ("lower = 0.98", "lower = 1.98", "key limit[1].lower: 1.98 is above upper = 1.02"),
        ("lower = 0.98\nupper = 1.02", "", "the limit of rms_ratio has no bound"),
        ('"rms_ratio"', '"ratio"', "key limit[1].quantity"),
        ("[0.0, 4.0]", "[0.0, 3.0]", "key limit[1].window_s: [0.0, 3.0] is not a compared window"),
    ],
)
def test_wrong_limit_is_named_with_its_file_and_key(folder: Path, old: str, new: str, message: str) -> None:
    (folder / "limits.toml").write_text(LIMITS.replace(old, new), encoding="utf-8")
    done = run("--limits", "limits.toml")
    assert done.exit_code == 2, done.output
    assert "limits" in done.output
    assert message in done.output
