"""`identify` and `fit-damping` from files to pages."""

import json
import tomllib

import numpy as np
import pytest
from pantocheck.conformance.cases.damping import Damping
from pantocheck.conformance.cases.library import select
from pantocheck.conformance.command_line.app import app
from pantocheck.conformance.massdrop_records import Channel, Drop, DropRecord, Line, write_csv
from pantocheck.conformance.systems.line_model import catenary
from pantocheck.model import discretise
from pantocheck.model.modes import damping_ratios, deflection_at, modes
from typer.testing import CliRunner

CASE = "en50318-2002/250"
SENSORS = (("contact wire", "CW", 130.0), ("contact wire", "CW", 205.5), ("messenger wire", "MW", 77.0))
RATE, RELEASE = 25.0, 4.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A record of the line's own modes, superposed: 24 modes hit at one place, ringing at three sensors."""
    folder = tmp_path_factory.mktemp("drop")
    line = discretise(catenary(select([CASE])[0].line), 2.0, tuple(x for _, _, x in SENSORS))
    shapes = modes(line, 24)
    ratio = damping_ratios(line, shapes)
    at = np.array([deflection_at(line, shapes, line.mesh.row_of[wire, "z"], x) for wire, _, x in SENSORS])
    omega = 2 * np.pi * shapes.frequency
    poles = omega * (-ratio + 1j)
    t = np.arange(int(140 * RATE)) / RATE - RELEASE
    random = np.random.default_rng(0)
    signal = np.zeros((t.size, len(SENSORS)))
    for j, pole in enumerate(poles):
        signal += np.outer(np.where(t >= 0, np.exp(pole * np.maximum(t, 0)).real, 0), at[:, j] * random.choice([-1, 1]))
    signal += 1e-4 * random.standard_normal(signal.shape)
    channels = tuple(Channel(f"S{i}_z", i, "z", wire, x) for i, (_, wire, x) in enumerate(SENSORS, 1))
    record = DropRecord("T", "T", RATE, signal, channels, drop=Drop(20, "CW", 150.0, RELEASE), line=Line((60.0,) * 10))
    write_csv(record, folder / "T.csv")
    made = CliRunner().invoke(
        app, ["identify", str(folder / "T.csv"), "--out", str(folder / "out"), "--highest", "2.2"]
    )
    assert made.exit_code == 0, made.output
    return folder


def test_identify_writes_what_the_contract_says(folder):
    rows = json.loads((folder / "out" / "modes.json").read_text())
    wanted = {
        "frequency_Hz",
        "damping_ratio",
        "damping_ratio_std",
        "group",
        "sensor_shape",
        "error",
        "record",
        "warnings",
    }
    assert len(rows) > 10
    assert all(wanted <= set(row) for row in rows)
    assert [row["frequency_Hz"] for row in rows] == sorted(row["frequency_Hz"] for row in rows)
    assert (folder / "out" / "identification.pdf").read_bytes().startswith(b"%PDF")
    page = (folder / "out" / "identification.html").read_text()
    assert "Groups of span modes" in page
    assert "<script" not in page


def test_identify_is_deterministic(folder, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    for name in ("a", "b"):
        command = ["identify", str(folder / "T.csv"), "--out", str(folder / name), "--highest", "1.3"]
        assert CliRunner().invoke(app, command).exit_code == 0
    for file in ("modes.json", "identification.json", "identification.html", "identification.pdf"):
        assert (folder / "a" / file).read_bytes() == (folder / "b" / file).read_bytes()


def test_fit_damping_returns_the_line_its_own_damping(folder):
    """The record's damping is the case's: 0.0125 1/s and 1e-4 s on both wires come back within 10 %.

    Three sensors and modes up to 2.2 Hz only, where the stiffness part is a tenth of the damping: hence 10 %, and 30 %
    for the stiffness coefficients.
    """
    command = [
        "fit-damping",
        str(folder / "out" / "modes.json"),
        "--line",
        CASE,
        "--out",
        str(folder / "fit"),
        "--element",
        "2",
    ]
    made = CliRunner().invoke(app, command)
    assert made.exit_code == 0, made.output
    block = tomllib.loads((folder / "fit" / "damping.toml").read_text())["damping"]
    damping = Damping.model_validate(block)
    for wire in (damping.contact_wire, damping.messenger_wire):
        assert wire.mass_coefficient_1_s == pytest.approx(0.0125, rel=0.1)
        assert wire.stiffness_coefficient_s == pytest.approx(1e-4, rel=0.3)
    modal = tomllib.loads((folder / "fit" / "damping_with_modal.toml").read_text())["damping"]
    assert len(Damping.model_validate(modal).modal) >= 1
    assert (folder / "fit" / "damping.pdf").read_bytes().startswith(b"%PDF")
    assert json.loads((folder / "fit" / "damping.json").read_text())["schema"] == "pantocheck.damping/1"


@pytest.mark.parametrize(
    ("content", "message"),
    [(b"", "invalid JSON"), (b"{}", "valid array"), (b'[{"frequency_Hz": -1}]', "mode 1"), (b"[]", "holds no certain mode")],
)
def test_bad_modes_are_refused(tmp_path, content, message):
    (tmp_path / "modes.json").write_bytes(content)
    made = CliRunner().invoke(
        app, ["fit-damping", str(tmp_path / "modes.json"), "--line", CASE, "--out", str(tmp_path)]
    )
    assert made.exit_code == 2
    assert message in made.output


def test_missing_record_is_refused(tmp_path):
    made = CliRunner().invoke(app, ["identify", str(tmp_path / "none.csv"), "--out", str(tmp_path)])
    assert made.exit_code == 2
    assert "cannot be read" in made.output
