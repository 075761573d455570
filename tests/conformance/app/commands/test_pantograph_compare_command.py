"""`pantocheck pantograph compare`: files, exit codes, and messages that name file and key."""

import json
import shutil
from functools import partial
from pathlib import Path

import pytest
from jsonschema import validate

from helpers import response_records as rig
from helpers.command_line import pantocheck
from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.line.library_folder import library_folder

LIMITS = """
schema = "pantocheck.comparison-limits/1"
[[limit]]
quantity = "complex_deviation_pct"
band_Hz = [20.0, 50.0]
static_forces_N = [70.0]
upper = 3.0
source = "plan 3"
"""

DROP_LIMIT = """
[[limit]]
quantity = "correlation"
sensors = [1]
window_s = [0.0, 4.0]
band_Hz = [0.3, 20.0]
lower = 0.9
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Working folder with a response of the pantograph, one of a heavier head, and limits."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(library_folder() / "en50318-2018" / "pantograph.toml", "pantograph.toml")
    pantograph = rig.read_pantograph()
    for name, factor in (("right", 1.0), ("heavy", 1.05)):
        stiffness = rig.add_noise(rig.chain_stiffness(rig.scale_head(pantograph, factor)), seed=3)
        rig.write_response(tmp_path, rig.apparent_mass_columns(stiffness), name)
    Path("limits.toml").write_text(LIMITS, encoding="utf-8")
    return tmp_path


run = partial(pantocheck, "pantograph", "compare", "--pantograph", "pantograph.toml", "--out", "out")


def test_reports_are_written_and_the_exit_code_follows_the_verdict(folder: Path) -> None:
    done = run("right.csv", "--limits", "limits.toml")
    assert done.exit_code == 0, done.output
    assert all(f"{band} Hz" in done.output for band in ("0.5 to 5", "5 to 20", "20 to 50"))
    results = json.loads((folder / "out" / "response_comparison.json").read_text())
    validate(results, build_schema("response-comparison"))
    assert (folder / "out" / "response_comparison.pdf").read_bytes().startswith(b"%PDF")
    assert "right.csv" in (folder / "out" / "response_comparison.html").read_text()
    failed = run("right.csv", "heavy.toml", "--limits", "limits.toml")
    assert (failed.exit_code, "FAIL" in failed.output) == (1, True), failed.output
    informative = run("right.csv")
    assert (informative.exit_code, "INFO" in informative.output) == (3, True), informative.output


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[20.0, 50.0]", "[20.0, 40.0]", "key limit[1].band_Hz: [20.0, 40.0] is not a compared band"),
        ("[70.0]", "[70.0, 70.0]", "key limit[1].static_forces_N: [70.0, 70.0] repeats a value"),
        ("static_forces_N = [70.0]", "", "key limit[1].static_forces_N: missing"),
        ("upper = 3.0", "upper = 0.0", "key limit[1].upper"),
        ('"complex_deviation_pct"', '"deviation"', "key limit[1].quantity"),
        ('"complex_deviation_pct"', '"elasticity_difference_pct"', "key limit[1].band_Hz: is not a key of a limit of"),
        (LIMITS[LIMITS.index("[[") :], DROP_LIMIT, "key limit[1].quantity: 'correlation' does not belong to"),
    ],
)
def test_wrong_limit_is_named_with_its_file_and_key(folder: Path, old: str, new: str, message: str) -> None:
    (folder / "limits.toml").write_text(LIMITS.replace(old, new), encoding="utf-8")
    done = run("right.csv", "--limits", "limits.toml")
    assert done.exit_code == 2, done.output
    assert "limits 'limits.toml', " + message in done.output


def test_response_is_checked_and_a_missing_sidecar_named(folder: Path) -> None:
    done = pantocheck("check", "right.csv", "right.toml", "limits.toml", COLUMNS="140")
    assert done.exit_code == 0, done.output
    valid = "valid response record: apparent mass at 120 frequencies, 0.5 to 50 Hz, in right.csv"
    _, *lines = done.output.splitlines()
    assert [line.split(": ", 1)[1] for line in lines] == [valid, valid, "valid comparison-limits file"]
    (folder / "right.toml").unlink()
    done = run("right.csv")
    assert done.exit_code == 2, done.output
    assert "sidecar 'right.toml'" in done.output
