"""Simulated drops as records: decimation, content of the record, and files."""

import shutil
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.signal
from numpy.testing import assert_allclose
from typer.testing import Result

from helpers.command_line import pantocheck
from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropDescription, DropRecord
from pantocheck.conformance.drops.drop_scene import build_drop_scene
from pantocheck.conformance.drops.drop_simulation import decimate, require_mass_drop, simulate_drop
from pantocheck.conformance.execution.plan import Plan, prepare_plan
from pantocheck.conformance.line.elements.damping import Damping
from pantocheck.conformance.line.library_folder import library_folder

DropCase = Callable[[dict[str, Any]], Path]
"""Function that writes the short drop case with changed values; gives its path."""

MODELS = ("initial", "updated", "updated-modal")
SHORT_DROP = {
    "line": "line.toml",
    "damping": "vovan2015/damping/updated.toml",
    "discretisation.element_m": 2.0,
    "mass_drop.record_s": 6.0,
    **{f"mass_drop.compared.{name}": f"vovan2015/damping/{name}.toml" for name in MODELS},
    **{f"mass_drop.drop.{n}.x_m": x for n, x in enumerate((40.5, 81.0, 72.0))},
    **{f"mass_drop.sensor.{n}.x_m": x for n, x in enumerate((85.5, 45.0, 99.0, 18.0))},
}
"""Changes of the library case for two spans and 6 s."""


@pytest.fixture
def drop_case(tmp_path: Path) -> DropCase:
    """A short version of the drops with the updated damping: two spans, 6 s."""

    def write(changes: dict[str, Any]) -> Path:
        folder = library_folder() / "vovan2015"
        shutil.copy(folder / "line.toml", tmp_path / "line.toml")
        shutil.copy(folder / "mass-drop" / "stand-in.toml", tmp_path / "drop.toml")
        edit_toml(tmp_path / "line.toml", {"geometry.spans": 2})
        return edit_toml(tmp_path / "drop.toml", {"id": "mass-drop/stand-in", **SHORT_DROP, **changes})

    return write


def test_decimation_keeps_the_pass_band_and_removes_what_would_alias() -> None:
    """A sine at 0.8 of half the new rate comes out as it is, up to the filter's ripple of 90 dB; no delay."""
    rate, every = 1000.0, 5
    time = np.arange(20_000) / rate
    for frequency in (1.0, 40.0, 80.0):
        wave = np.sin(2 * np.pi * frequency * time)[:, None]
        assert_allclose(decimate(wave, every)[200:-200], wave[::every][200:-200], atol=1e-4)
    rate, every = 1000.0, 5
    time = np.arange(20_000) / rate
    wave = np.sin(2 * np.pi * 101.0 * time)[:, None]
    assert np.abs(decimate(wave, every)[200:-200]).max() < 1e-4


def test_decimated_drift_is_that_of_scipy() -> None:
    """Ends at different levels, extended by a straight line; the same filter, so that rounding alone differs."""
    signals = np.cumsum(np.random.default_rng(1).standard_normal((3003, 2)), axis=0)
    length, beta = scipy.signal.kaiserord(90.0, 0.2 / 4)
    taps = scipy.signal.firwin(length | 1, 0.9 / 4, window=("kaiser", beta))
    expected = scipy.signal.resample_poly(signals, 1, 4, axis=0, window=taps, padtype="line")
    assert_allclose(decimate(signals, 4), expected, rtol=0, atol=1e-11)


def test_record_is_the_decay_at_the_rate_of_the_record(drop_case: DropCase) -> None:
    case = load_case(drop_case({"mass_drop.noise_rms": 0.0}))
    drop = simulate_drop(case, 1)
    record, decay = drop.record, drop.decay
    assert record.rate == 100.0
    assert record.drop == DropDescription(40, "CW", 40.5, 5)
    assert [(c.wire, c.axis, c.position) for c in record.channels][2:] == [("MW", "z", 99.0), ("MW", "z", 18.0)]
    assert record.line.spans_m == (63.0, 63.0)
    assert record.signals.shape == (1100, 4)
    # The mass hangs still before the release: the filter leaves a share of 1e-4 of the later motion, and it rings for
    # 0.3 s before the release.
    assert np.abs(record.signals[:470]).max() < 5e-4
    # Below 40 Hz the record is the simulated acceleration; what lies above has gone with the release's first moments.
    # It makes 7e-4 of the RMS at most.
    later = decay.time > 2.0
    rms = np.sqrt(np.mean(decay.motion[:, later, 2] ** 2, axis=1))
    assert_allclose(np.sqrt(np.mean(record.signals[700:] ** 2, axis=0)), rms, rtol=0.005)


def test_noise_is_reproducible_and_differs_between_drops(drop_case: DropCase) -> None:
    case = load_case(drop_case({}))
    first, again, other = simulate_drop(case, 1).record, simulate_drop(case, 1).record, simulate_drop(case, 3).record
    assert np.array_equal(first.signals, again.signals)
    quiet = slice(0, 480)
    assert_allclose(first.signals[quiet].std(), 0.003, rtol=0.05)  # 1920 samples: 1.6 % standard error
    correlation = np.corrcoef(first.signals[quiet].ravel(), other.signals[quiet].ravel())[0, 1]
    assert abs(correlation) < 0.1


@pytest.mark.parametrize("suffix", [".uff", ".csv", ".h5"])
def test_command_writes_records_that_read_back(drop_case: DropCase, tmp_path: Path, suffix: str) -> None:
    out = tmp_path / f"record{suffix}"
    done = pantocheck("drop", "simulate", drop_case({}), "--drop", 2, "--out", out)
    assert done.exit_code == 0, done.output
    (record,) = read_drop_records(out)
    assert (record.drop.mass, record.drop.wire, record.rate) == (30.0, "MW", 100.0)
    assert_allclose(record.signals, simulate_drop(load_case(drop_case({})), 2).record.signals, rtol=1e-6, atol=1e-6)


def test_command_writes_a_file_per_drop(drop_case: DropCase, tmp_path: Path) -> None:
    done = pantocheck("drop", "simulate", drop_case({}), "--out", tmp_path / "all.csv")
    assert done.exit_code == 0, done.output
    assert [read_drop_records(tmp_path / f"all-{n}.csv")[0].drop.mass for n in (1, 2, 3)] == [40.0, 30.0, 20.0]


def test_record_without_sidecar_or_of_a_single_drop_has_the_plain_name(drop_case: DropCase, tmp_path: Path) -> None:
    path = drop_case({})
    (first, *_) = tomllib.loads(path.read_text(encoding="utf-8"))["mass_drop"]["drop"]
    done = pantocheck("drop", "simulate", drop_case({"mass_drop.drop": [first]}), "--out", tmp_path / "one.csv")
    assert done.exit_code == 0, done.output
    assert [path.name for path in tmp_path.glob("one*.csv")] == ["one.csv"]
    path = drop_case({})
    content = path.read_bytes()
    done = pantocheck("drop", "simulate", path, "--drop", 2, "--out", path.with_suffix(".h5"))
    assert done.exit_code == 0, done.output
    assert path.read_bytes() == content


@pytest.mark.parametrize("suffix", [".uff", ".csv"])
def test_command_replaces_no_case_by_a_sidecar(drop_case: DropCase, tmp_path: Path, suffix: str) -> None:
    """The sidecar of the second of three records has the name of another case: nothing is simulated or written."""
    path, other = drop_case({}), tmp_path / "all-2.toml"
    other.write_bytes(path.read_bytes())
    done = pantocheck("drop", "simulate", path, "--out", tmp_path / f"all{suffix}")
    assert done.exit_code == 2
    assert "the sidecar would overwrite all-2.toml" in done.output
    assert other.read_bytes() == path.read_bytes()
    assert [file.name for file in tmp_path.glob("all-*")] == ["all-2.toml"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("en50318-2002/250", "--out", "x.uff"), "expected one case with a [mass_drop] table, found none"),
        (("vovan2015/mass-drop/*", "--out", "x.uff"), "found vovan2015/mass-drop/printed, vovan2015/mass-drop/stand"),
        (("vovan2015/mass-drop/stand-in", "--out", "x.mat"), "format '.mat' cannot be written"),
        (("vovan2015/mass-drop/stand-in", "--drop", "4", "--out", "x.uff"), "there is no drop 4"),
    ],
)
def test_wrong_input(arguments: tuple[str, ...], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = pantocheck("drop", "simulate", *arguments)
    assert done.exit_code == 2
    assert message in done.output


def test_damping_table_is_read_and_a_case_without_a_drop_named(drop_case: DropCase, case_250: Case) -> None:
    """The block that a fit writes stands in a case as it is, or in a file that the case names."""
    named = load_case(drop_case({}))
    file = library_folder() / "vovan2015" / "damping" / "updated.toml"
    path = drop_case({"damping": tomllib.loads(file.read_text(encoding="utf-8"))["damping"]})
    assert load_case(path).line == named.line
    assert load_case(path).digest == named.digest
    with pytest.raises(ValueError, match=r"^case en50318-2002/250 has no mass drop$"):
        require_mass_drop(case_250)


def test_studies_run_on_request_and_their_digest_covers_the_damping_models() -> None:
    """They take minutes, and one is expected to fail: a run without a case must not meet them."""
    assert not any(case.id.startswith("vovan2015") for case in prepare_plan(Plan()).cases)
    assert len(select_cases(["vovan2015/*"])) == 7
    (study,) = select_cases(["vovan2015/contact-force"])
    assert replace(study, dampings={"initial": study.line.damping}).digest != study.digest


def test_component_without_damping_in_the_model_keeps_that_of_the_line(drop_case: DropCase) -> None:
    case = load_case(drop_case({}))
    wire = {"mass_coefficient_1_s": 0.5}
    only = Damping.model_validate({"trust": "primary", "source": "test", "contact_wire": wire})
    other = case.with_damping("only", only)
    assert other.line.damping.contact_wire.mass_coefficient_1_s == 0.5
    assert other.line.damping.messenger_wire == case.line.damping.messenger_wire
    assert other.line.damping.trust == "provisional"
    assert set(other.line.damping.source) >= {"test"}
    assert other.id.endswith("/only")


# Simulated campaigns of mass drops: factors, names, noise, and the axes of the model.


SHORT_CAMPAIGN = {
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
    return edit_toml(tmp_path / "drop.toml", SHORT_CAMPAIGN)


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
        (("--axes", "up"), "is not a list of axes"),
        (("--place", "CW:999"), "999 m is not on the line"),
        (("--place", "40.5"), "is not a wire and a position"),
        (("--messenger-tension", "-5"), "messenger_wire.tension_N"),
    ],
)
def test_impossible_campaigns_are_refused(case_path: Path, options: tuple[str, str], message: str) -> None:
    result = run_campaign(case_path, *options)
    assert result.exit_code == 2
    assert message in " ".join(result.output.split())
    assert not (case_path.parent / "records").exists()


def test_moving_picture_agrees_with_the_simulated_drop(drop_case: DropCase) -> None:
    """Rises at the sensors after the release, within the stated error and half a step of the coding (at most 1 mm)."""
    case = load_case(drop_case({"mass_drop.record_s": 3.0}))
    scene, decay = build_drop_scene(case, 1), simulate_drop(case, 1).decay
    assert scene is not None
    [motion] = scene.motions
    time = motion.start_s + motion.step_s * np.arange(motion.wires[0].rise_mm.frames)
    after = (time > 0) & (time < 2.9)
    curves = scene.line_shape.side.curves
    for sensor, displacement in zip(require_mass_drop(case).sensor, 1e3 * decay.motion[:, :, 0], strict=True):
        [wire] = [wire for wire in motion.wires if curves[wire.curve].kind == sensor.wire]
        drawn = np.array([np.interp(sensor.x_m, wire.x_m, row) for row in wire.rise_mm.decode()])
        expected = np.interp(time[after], decay.time, displacement)
        assert np.ptp(expected) > 10
        assert motion.error_mm is not None
        assert_allclose(drawn[after], expected, atol=motion.error_mm + 0.5)
    assert [point.text for point in scene.line_shape.side.points if point.symbol == "mass"] == ["40 kg"]
    assert 0 < len(motion.model_dump_json()) <= 400_000
