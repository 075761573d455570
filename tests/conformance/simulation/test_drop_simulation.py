"""Simulated drops as records: decimation, content of the record, and files."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

from pantocheck.conformance.cases.library import library_folder, load_case, select_cases
from pantocheck.conformance.command_line.app import app
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_reading import read_drop_records
from pantocheck.conformance.plan import Plan, prepare_plan
from pantocheck.conformance.simulation.drop_simulation import decimate, simulate_drop


def pantocheck(*arguments: object):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def own_case(tmp_path):
    """A short version of the drops with the updated damping: two spans, 6 s; texts replaced on the way."""

    def write(*replacements):
        folder = library_folder() / "vovan2015"
        line = (folder / "line.toml").read_text().replace("spans = 6 ", "spans = 2 ")
        (tmp_path / "line.toml").write_text(line)
        text = (folder / "mass-drop" / "updated.toml").read_text()
        text = text.replace('"../line.toml"', '"line.toml"').replace("../damping/", "vovan2015/damping/")
        text = text.replace('id = "vovan2015/', 'id = "').replace("record_s = 120.0", "record_s = 6.0")
        for old, new in (
            ("212.25", "40.5"), ("81.0", "81.0"), ("268.5", "72.0"), ("211.5", "85.5"), ("171.0", "45.0"),
            ("99.0", "99.0"), ("267.75", "18.0"), ("element_m = 0.75", "element_m = 2.0"), *replacements,
        ):  # fmt: skip
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "drop.toml"
        path.write_text(text)
        return path

    return write


def test_decimation_keeps_the_pass_band_and_its_phase() -> None:
    """A sine at 0.8 of half the new rate comes out as it is, up to the filter's ripple of 90 dB; no delay."""
    rate, every = 1000.0, 5
    time = np.arange(20_000) / rate
    for frequency in (1.0, 40.0, 80.0):
        wave = np.sin(2 * np.pi * frequency * time)[:, None]
        assert_allclose(decimate(wave, every)[200:-200], wave[::every][200:-200], atol=1e-4)


def test_decimation_removes_frequencies_that_would_alias() -> None:
    rate, every = 1000.0, 5
    time = np.arange(20_000) / rate
    wave = np.sin(2 * np.pi * 101.0 * time)[:, None]
    assert np.abs(decimate(wave, every)[200:-200]).max() < 1e-4


def test_record_is_the_decay_at_the_rate_of_the_record(own_case: Callable[..., Path]) -> None:
    case = load_case(own_case(("noise_rms = 0.003", "noise_rms = 0.0")))
    drop = simulate_drop(case, 1)
    record, decay = drop.record, drop.decay
    assert record.rate == 100.0
    assert (record.drop.mass, record.drop.wire, record.drop.position, record.drop.trigger_nominal) == (
        40,
        "CW",
        40.5,
        5,
    )
    assert [(c.wire, c.axis, c.position) for c in record.channels][2:] == [("MW", "z", 99.0), ("MW", "z", 18.0)]
    assert record.line.spans == (63.0, 63.0)
    assert record.signals.shape == (1100, 4)
    # The mass hangs still before the release, up to what the static solve leaves: as little as the noise of a sensor.
    # The filter rings for half its length, 0.1 s.
    assert np.abs(record.signals[:480]).max() < 0.005
    # Below 40 Hz the record is the simulated acceleration; what lies above has gone with the release's first moments.
    # It makes 7e-4 of the RMS at most.
    later = decay.time > 2.0
    rms = np.sqrt(np.mean(decay.motion[:, later, 2] ** 2, axis=1))
    assert_allclose(np.sqrt(np.mean(record.signals[700:] ** 2, axis=0)), rms, rtol=0.005)


def test_noise_is_reproducible_and_differs_between_drops(own_case: Callable[..., Path]) -> None:
    case = load_case(own_case())
    first, again, other = simulate_drop(case, 1).record, simulate_drop(case, 1).record, simulate_drop(case, 3).record
    assert np.array_equal(first.signals, again.signals)
    quiet = slice(0, 480)
    assert_allclose(first.signals[quiet].std(), 0.003, rtol=0.05)  # 1920 samples: 1.6 % standard error
    correlation = np.corrcoef(first.signals[quiet].ravel(), other.signals[quiet].ravel())[0, 1]
    assert abs(correlation) < 0.1


@pytest.mark.parametrize("suffix", [".uff", ".csv", ".h5"])
def test_command_writes_records_that_read_back(own_case: Callable[..., Path], tmp_path: Path, suffix: str) -> None:
    out = tmp_path / f"record{suffix}"
    done = pantocheck("drop", own_case(), "--drop", 2, "--out", out)
    assert done.exit_code == 0, done.output
    (record,) = read_drop_records(out)
    assert (record.drop.mass, record.drop.wire, record.rate) == (30.0, "MW", 100.0)
    assert_allclose(record.signals, simulate_drop(load_case(own_case()), 2).record.signals, rtol=1e-6, atol=1e-6)


def test_command_writes_a_file_per_drop(own_case: Callable[..., Path], tmp_path: Path) -> None:
    done = pantocheck("drop", own_case(), "--out", tmp_path / "all.csv")
    assert done.exit_code == 0, done.output
    assert [read_drop_records(tmp_path / f"all-{n}.csv")[0].drop.mass for n in (1, 2, 3)] == [40.0, 30.0, 20.0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("en50318-2002/250", "--out", "x.uff"), "expected one case with a [mass_drop] table, found none"),
        (("vovan2015/mass-drop/*", "--out", "x.uff"), "found vovan2015/mass-drop/initial, vovan2015/mass-drop/printed"),
        (("vovan2015/mass-drop/updated", "--out", "x.mat"), "format '.mat' cannot be written"),
        (("vovan2015/mass-drop/updated", "--drop", "4", "--out", "x.uff"), "there is no drop 4"),
    ],
)
def test_command_reports_wrong_input(
    arguments: tuple[str, ...], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = pantocheck("drop", *arguments)
    assert done.exit_code == 2
    assert message in done.output


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("rate_Hz = 100.0", "rate_Hz = 30.0", "mass_drop.rate_Hz"),
        ("rate_Hz = 100.0", "rate_Hz = 10.0", "mass_drop.highest_Hz"),
        ("x_m = 40.5", "x_m = 126.0", "mass_drop.drop[1].x_m"),
        ("x_m = 18.0", "x_m = 400.0", "mass_drop.sensor[4].x_m"),
        ("mass_kg = 20.0", "mass_kg = -1.0", "mass_drop.drop[3].mass_kg"),
        ("mass_kg = 20.0", "mass_kN = 20.0", "mass_drop.drop[3].mass"),
        ('wire = "messenger_wire"', 'wire = "MW"', "wire"),
        ("vovan2015/damping/initial.toml", "vovan2015/damping/none.toml", "damping model 'initial'"),
        ('damping = "vovan2015', 'speed_km_h = 300.0\ndamping = "vovan2015', "mass_drop"),
    ],
)
def test_impossible_drops_are_refused_with_their_key(
    own_case: Callable[..., Path], old: str, new: str, key: str
) -> None:
    path = own_case()
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError) as refused:
        load_case(path)
    assert key in str(refused.value)


def test_damping_table_and_damping_file_are_the_same(own_case: Callable[..., Path]) -> None:
    """The block that a fit writes stands in a case as it is, or in a file that the case names."""
    named = load_case(own_case())
    path = own_case()
    block = (library_folder() / "vovan2015" / "damping" / "updated.toml").read_text().split("\n\n", 1)[1]
    text = path.read_text().replace('damping = "vovan2015/damping/updated.toml"\n', "", 1) + "\n" + block
    path.write_text(text)
    assert load_case(path).line == named.line
    assert load_case(path).digest == named.digest


def test_studies_run_on_request_only() -> None:
    """They take minutes, and one is expected to fail: a run without a case must not meet them."""
    assert not any(case.id.startswith("vovan2015") for case in prepare_plan(Plan()).cases)
    assert len(select_cases(["vovan2015/*"])) == 8


def test_component_without_damping_in_the_model_keeps_that_of_the_line(own_case: Callable[..., Path]) -> None:
    case = load_case(own_case())
    wires = case.dampings["initial"].model_copy(update={})
    only = type(wires).model_validate(
        {"trust": "primary", "source": "test", "contact_wire": {"mass_coefficient_1_s": 0.5}}
    )  # fmt: skip
    other = case.with_damping("only", only)
    assert other.line.damping.contact_wire.mass_coefficient_1_s == 0.5
    assert other.line.damping.messenger_wire == case.line.damping.messenger_wire
    assert other.line.damping.trust == "provisional"
    assert set(other.line.damping.source) >= {"test"}
    assert other.id.endswith("/only")


def test_digest_covers_the_damping_models_of_a_study() -> None:
    (study,) = select_cases(["vovan2015/contact-force"])
    assert replace(study, dampings={"initial": study.line.damping}).digest != study.digest
