"""Simulated campaigns of mass drops: factors, names, noise, and the axes of the model."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from typer.testing import Result

from helpers.command_line import pantocheck
from helpers.toml_edit import edit_toml
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.line.library_folder import library_folder

SHORT = {
    "id": "short",
    "line": "line.toml",
    "damping": "vovan2015/damping/printed.toml",
    "discretisation.element_m": 3.0,
    "mass_drop.record_s": 3.0,
    "mass_drop.hanging_s": 1.0,
    "mass_drop.drop": [{"mass_kg": 40.0, "wire": "contact_wire", "x_m": 40.5}],
    "mass_drop.sensor": [{"wire": "contact_wire", "x_m": 49.5}, {"wire": "messenger_wire", "x_m": 27.0}],
}
"""Changes of a library case: two spans, 4 s, one drop, two sensors."""


@pytest.fixture
def case_path(tmp_path: Path) -> Path:
    folder = library_folder() / "vovan2015"
    shutil.copy(folder / "line.toml", tmp_path / "line.toml")
    shutil.copy(folder / "mass-drop" / "printed.toml", tmp_path / "drop.toml")
    edit_toml(tmp_path / "line.toml", {"geometry.spans": 2})
    return edit_toml(tmp_path / "drop.toml", SHORT)


def run_campaign(case_path: Path, *options: str) -> Result:
    out = case_path.parent / "records" / "r.csv"
    return pantocheck("drop", "campaign", case_path, "--out", out, *options)


def read_campaign(case_path: Path, *options: str) -> list[DropRecord]:
    result = run_campaign(case_path, *options)
    assert result.exit_code == 0, result.output
    paths = sorted((case_path.parent / "records").glob("r-*.csv"))
    return [record for path in paths for record in read_drop_records(path)]


def test_every_combination_is_one_record_per_repeat(case_path: Path) -> None:
    """Two masses, two places, two tensions and two repeats: 16 records whose sidecars state their drop and line."""
    options = ("--mass", "20", "--mass", "40", "--place", "CW:40.5", "--place", "MW:81", "--repeats", "2")
    records = read_campaign(case_path, *options, "--messenger-tension", "14000", "--messenger-tension", "15000")
    factors = [(r.drop.mass, r.drop.wire, r.drop.position, r.line.messenger_wire_tension_N) for r in records]
    assert len(records) == 16
    assert len(set(factors)) == 8
    assert all(factors[k] == factors[k + 1] for k in range(0, 16, 2))
    assert factors[0] == (20, "CW", 40.5, 14e3)
    assert factors[-1] == (40, "MW", 81, 15e3)
    assert len({record.name for record in records}) == 16
    assert records[1].name == "short 20 kg CW 40.5 m, CW 20000 N, MW 14000 N, record 2"


def test_noise_depends_on_seed_and_number_alone(case_path: Path) -> None:
    """Noise of 0.01 m/s2 over 2 x 400 samples: 2.5 % standard error, with the rounding of the file ten times less."""
    first, second = read_campaign(case_path, "--repeats", "2", "--noise", "0.01")
    again = read_campaign(case_path, "--repeats", "2", "--noise", "0.01")[1]
    other = read_campaign(case_path, "--repeats", "2", "--noise", "0.01", "--seed", "2")[1]
    assert np.array_equal(second.signals, again.signals)
    for record in (first, other):
        difference = (second.signals - record.signals) / np.sqrt(2)
        assert difference.std() == pytest.approx(0.01, rel=0.1)
    (clean,) = read_campaign(case_path, "--repeats", "1", "--noise", "0")[:1]
    assert (first.signals - clean.signals).std() == pytest.approx(0.01, rel=0.1)


def test_lateral_channels_are_those_of_a_line_with_stagger(case_path: Path) -> None:
    """A vertical release also moves a staggered wire laterally, through its inclined droppers and arms, but less."""
    edit_toml(case_path.parent / "line.toml", {"geometry.stagger_contact_wire_m": 0.2})
    (record,) = read_campaign(case_path, "--axes", "z,y", "--noise", "0")
    assert [f"{c.name} {c.wire}" for c in record.channels] == ["S1y CW", "S1z CW", "S2y MW", "S2z MW"]
    assert [c.axis for c in record.channels] == ["y", "z", "y", "z"]
    lateral, vertical = (record.signals[100:, list(record.along(axis))].std() for axis in ("y", "z"))
    assert 1e-4 * vertical < lateral < 0.5 * vertical


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--axes", "z,y"), "its model has no lateral motion (y)"),
        (("--axes", "x"), "the model has no motion along the track (x)"),
        (("--axes", "up"), "is no list of axes"),
        (("--place", "CW:999"), "999 m is not on the line"),
        (("--place", "40.5"), "is no wire and position"),
        (("--messenger-tension", "-5"), "messenger_wire.tension_N"),
    ],
)
def test_impossible_campaigns_are_refused(case_path: Path, options: tuple[str, str], message: str) -> None:
    result = run_campaign(case_path, *options)
    assert result.exit_code == 2
    assert message in " ".join(result.output.split())
    assert not (case_path.parent / "records").exists()
