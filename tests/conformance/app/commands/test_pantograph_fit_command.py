"""`pantocheck pantograph fit`: pantograph file, reports, and messages that name the option."""

import json
import tomllib
from functools import partial
from pathlib import Path

import pytest
from jsonschema import validate

from helpers import response_records as rig
from helpers.command_line import pantocheck
from pantocheck.conformance.app.schemas import build_schema


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Working folder with a response of the two-mass pantograph of EN 50318:2002."""
    monkeypatch.chdir(tmp_path)
    stiffness = rig.add_noise(rig.chain_stiffness(rig.read_pantograph("en50318-2002/pantograph.toml")), seed=4)
    sidecar = {"modulus_uncertainty_pct": 1.96, "phase_uncertainty_deg": 0.98, "source": "rig test 12"}
    rig.write_response(tmp_path, rig.apparent_mass_columns(stiffness), **sidecar)
    return tmp_path


run = partial(pantocheck, "pantograph", "fit", "measured.csv", "--out", "fitted.toml")


def test_fitted_file_is_valid_and_names_its_record(folder: Path) -> None:
    """Two masses are chosen; their interval is 0.4 % in the mean of many measurements."""
    done = run("--title", "Rig 12")
    assert done.exit_code == 0, done.output
    assert "determined" in done.output  # of the table of parameters
    assert "times the stated noise" not in done.output
    tables = tomllib.loads((folder / "fitted.toml").read_text())
    assert tables["title"] == "Rig 12"
    assert tables["chain"]["masses_kg"] == pytest.approx([15.0, 7.2], rel=0.01)
    assert tables["chain"]["source"] == "pantocheck pantograph fit, from measured.csv (rig test 12)"
    assert "trust" not in tables["chain"]
    assert tables["contact"]["stiffness_N_m"] == 50e3
    assert tables["validity"]["supported_to_Hz"] == pytest.approx(50.0)
    checked = pantocheck("check", "fitted.toml")
    assert (checked.exit_code, "valid pantograph file" in checked.output) == (0, True), checked.output
    report = json.loads((folder / "fitted-fit.json").read_text())
    validate(report, build_schema("pantograph-fit"))
    assert [item["masses"] for item in report["candidates"]] == [2, 3, 4]
    assert report["natural_frequencies_Hz"][1] == pytest.approx(4.66, abs=0.02)
    assert report["comparison"]["responses"][0]["bands"][2]["deviations"]["complex_deviation_pct"] < 2
    assert (folder / "fitted-fit.pdf").read_bytes().startswith(b"%PDF")
    assert "Rig 12: chain of 2 masses" in (folder / "fitted-fit.html").read_text()


def test_fixed_value_is_written_and_a_needless_mass_warned_of(folder: Path) -> None:
    done = run("--masses", "2", "--fix", "stiffness_N_m.1=50", "--band", "0.6:40", "--contact-stiffness-N-m", "1e5")
    assert done.exit_code == 0, done.output
    tables = tomllib.loads((folder / "fitted.toml").read_text())
    assert tables["chain"]["stiffness_N_m"][0] == 50.0
    assert "stiffness_N_m fixed, " in tables["chain"]["note"]
    assert tables["contact"]["stiffness_N_m"] == 1e5
    report = json.loads((folder / "fitted-fit.json").read_text())
    assert [item["masses"] for item in report["candidates"]] == [2]
    assert report["parameters"][2]["determination"] == "fixed"
    assert (report["band_Hz"][0] > 0.6, report["band_Hz"][1] < 40) == (True, True)
    done = run("--masses", "3")
    assert done.exit_code == 0, done.output
    assert "the information criterion prefers 2 masses" in done.output


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--masses", "5"], "Invalid value for '--masses'"),
        (["--fix", "masses_kg.1=15"], "--fix: is given without a number of masses"),
        (["--masses", "2", "--fix", "masses_kg.3=15"], "--fix: there is no parameter 'masses_kg.3'"),
        (["--masses", "2", "--fix", "masses_kg.1=x"], "--fix: masses_kg.1 has the value 'x'"),
        (["--masses", "2", "--fix", "masses_kg.1=0"], "--fix: masses_kg.1 has the value '0'"),
        (["--masses", "2", "--fix", "masses_kg.1=1", "--fix", "masses_kg.1=2"], "--fix: masses_kg.1 is given 2 times"),
        (["--band", "50"], "--band: '50' is not a band"),
        (["--band", "5:1"], "--band: '5:1' is not a band"),
        (["--out", "fitted.json"], "--out: 'fitted.json' is not a TOML file"),
    ],
)
def test_wrong_option_is_named(folder: Path, arguments: list[str], message: str) -> None:
    done = run(*arguments)
    assert done.exit_code == 2, done.output
    assert message in done.output
    assert not (folder / "fitted.toml").exists()
