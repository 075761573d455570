"""The commands `identify` and `drop fit`, from the record to the pages."""

import json
import tomllib
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from helpers.command_line import pantocheck
from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.drop_simulation import describe_line
from pantocheck.conformance.drops.drop_writing import write_drop_csv
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.damping import Damping
from pantocheck.model import discretise
from pantocheck.model.modal.modes import compute_modes, damping_ratios, deflection_at

CASE = "en50318-2002/250"
SENSORS = (("contact wire", "CW", 130.0), ("contact wire", "CW", 205.5), ("messenger wire", "MW", 77.0))
RATE, RELEASE = 25.0, 4.0


def run_identify(folder: Path, name: str, *options: str) -> str:
    exports = [option for suffix in ("csv", "uff") for option in ("--export", folder / name / f"modes.{suffix}")]
    out = ("--out", folder / name, "--highest", "2.2")
    result = pantocheck("drop", "identify", folder / "T.csv", *out, *exports, *options, SOURCE_DATE_EPOCH="0")
    assert result.exit_code == 0, result.output
    return result.output


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with a record of 24 superposed modes of the line at three sensors, and its identification."""
    folder = tmp_path_factory.mktemp("drop")
    file = select_cases([CASE])[0].line
    line = discretise(build_catenary(file), 2.0, tuple(x for _, _, x in SENSORS))
    shapes = compute_modes(line, 24)
    ratio = damping_ratios(line, shapes)
    amplitudes = np.array([deflection_at(line, shapes, line.mesh.row_of[wire, "z"], x) for wire, _, x in SENSORS])
    omega = 2 * np.pi * shapes.frequency
    poles = omega * (-ratio + 1j)
    t = np.arange(int(90 * RATE)) / RATE - RELEASE
    random = np.random.default_rng(0)
    signal = np.zeros((t.size, len(SENSORS)))
    for j, pole in enumerate(poles):
        signal += np.outer(
            np.where(t >= 0, np.exp(pole * np.maximum(t, 0)).real, 0), amplitudes[:, j] * random.choice([-1, 1])
        )
    signal += 1e-4 * random.standard_normal(signal.shape)
    channels = tuple(DropChannel(f"S{i}_z", i, "z", wire, x) for i, (_, wire, x) in enumerate(SENSORS, 1))
    drop = DropDescription(20, "CW", 150.0, RELEASE)
    record = DropRecord("T", "T", RATE, signal, channels, drop=drop, line=describe_line(file))
    write_drop_csv(record, folder / "T.csv")
    run_identify(folder, "out")
    return folder


def test_modes_json_has_the_keys_that_other_tools_read(folder: Path) -> None:
    rows = json.loads((folder / "out" / "modes.json").read_text())
    required = {
        *("frequency_Hz", "damping_ratio", "damping_ratio_std", "group"),
        *("sensor_shape", "error", "record", "warnings"),
    }
    assert len(rows) > 10
    assert all(required <= set(row) for row in rows)
    assert [row["frequency_Hz"] for row in rows] == sorted(row["frequency_Hz"] for row in rows)
    jsonschema.validate(rows, build_schema("modes"))
    identification = json.loads((folder / "out" / "identification.json").read_text())
    jsonschema.validate(identification, build_schema("identification"))
    assert (folder / "out" / "identification.pdf").read_bytes().startswith(b"%PDF")
    page = (folder / "out" / "identification.html").read_text()
    assert "Groups of span modes" in page
    assert page.count("<script") == 2  # that of every page, and the moving mode shapes


def test_fit_damping_recovers_the_damping_of_the_line(folder: Path) -> None:
    """The fitted model gives every mode its measured ratio within 1 %."""
    # Both wires of the case have the same damping and only two groups of modes are measured, so the share of each wire
    # is not determined: damping.toml leaves the coefficients out. Other tests cover wires with different damping.
    options = ("--line", CASE, "--out", folder / "fit", "--element", "2")
    result = pantocheck("drop", "fit", folder / "out" / "modes.json", *options)
    assert result.exit_code == 0, result.output
    text = (folder / "fit" / "damping.toml").read_text()
    Damping.model_validate(tomllib.loads(text)["damping"])
    results = json.loads((folder / "fit" / "damping.json").read_text())
    assert (results["line"]["state"], results["line"]["missing"]) == ("consistent", [])
    assert results["matching"]["matched_share"] == 1.0
    assert sum(row["value"] for row in results["coefficients"] if row["matrix"] == "mass") > 0.0125
    for row in results["coefficients"]:
        assert (row["determined"], row["reason"]) == (False, "it is not observable in the modes")
        assert f"\n# not determined, left out: {row['kind']}.{row['matrix']}_coefficient" in text
    assert results["schema"] == "pantocheck.damping/1"
    jsonschema.validate(results, build_schema("damping-fit"))
    for row in results["pairs"]:
        assert row["fitted"] == pytest.approx(row["measured"], rel=0.01)
        assert row["mac"] > 0.99
    modal = tomllib.loads((folder / "fit" / "damping_with_modal.toml").read_text())["damping"]
    assert len(Damping.model_validate(modal).modal) >= 1
    assert (folder / "fit" / "damping.pdf").read_bytes().startswith(b"%PDF")
    page = (folder / "fit" / "damping.html").read_text()
    assert "Mode shapes" in page
    first = results["shapes"]["modes"][0]
    assert f"{first['measured_Hz']:.4f}\N{NO-BREAK SPACE}Hz, MAC {first['mac']:.3f}" in page


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is not valid JSON"),
        (b"{}", "valid list"),
        (b'[{"frequency_Hz": -1}]', "key [1].frequency_Hz"),
        (b"[]", "holds no certain vertical mode in a group"),
    ],
)
def test_bad_modes_are_refused(tmp_path: Path, content: bytes, message: str) -> None:
    (tmp_path / "modes.json").write_bytes(content)
    result = pantocheck("drop", "fit", tmp_path / "modes.json", "--line", CASE, "--out", tmp_path)
    assert result.exit_code == 2
    assert message in result.output


def test_unknown_export_or_missing_record_is_refused(tmp_path: Path, folder: Path) -> None:
    result = pantocheck("drop", "identify", folder / "T.csv", "--out", tmp_path / "out", "--export", "modes.xlsx")
    assert result.exit_code == 2
    assert "format '.xlsx' cannot be written" in result.output
    assert not (tmp_path / "out").exists()
    result = pantocheck("drop", "identify", tmp_path / "none.csv", "--out", tmp_path)
    assert result.exit_code == 2
    assert "cannot be read" in result.output


@pytest.mark.usefixtures("fresh_figures")
def test_identify_each_writes_the_population(folder: Path) -> None:
    """One record: a population of one test, which agrees with itself; the identification is deterministic."""
    output = run_identify(folder, "each", "--each")
    written = sorted(path.name for path in (folder / "out").iterdir())
    names = ["identification.html", "identification.json", "identification.pdf"]
    assert written == [*names, "modes.csv", "modes.json", "modes.uff"]
    for file in written:
        assert (folder / "out" / file).read_bytes() == (folder / "each" / file).read_bytes(), file
    population = json.loads((folder / "each" / "population.json").read_text())
    jsonschema.validate(population, build_schema("population"))
    assert [record["record"] for record in population["records"]] == ["T"]
    assert all(group["agrees"] for group in population["groups"])
    assert "group 1: median over tests" in output
    assert (folder / "each" / "population.pdf").read_bytes().startswith(b"%PDF")
    page = (folder / "each" / "population.html").read_text()
    assert "1 test identified one by one" in page
