"""Simulated drops as records: decimation, content of the record, and files."""

import shutil
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.command_line import pantocheck
from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropDescription
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


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"mass_drop.rate_Hz": 30.0}, "mass_drop.rate_Hz"),
        ({"mass_drop.rate_Hz": 10.0}, "mass_drop.highest_Hz"),
        ({"mass_drop.drop.0.x_m": 126.0}, "mass_drop.drop[1].x_m"),
        ({"mass_drop.sensor.3.x_m": 400.0}, "mass_drop.sensor[4].x_m"),
        ({"mass_drop.drop.2.mass_kg": -1.0}, "mass_drop.drop[3].mass_kg"),
        ({"mass_drop.drop.2.mass_kg": None, "mass_drop.drop.2.mass_kN": 20.0}, "mass_drop.drop[3].mass"),
        ({"mass_drop.drop.1.wire": "MW"}, "mass_drop.drop[2].wire"),
        ({"mass_drop.compared.initial": "vovan2015/damping/none.toml"}, "damping model 'initial'"),
        ({"speed_km_h": 300.0}, "mass_drop"),
    ],
)
def test_impossible_drops_are_refused_with_their_key(drop_case: DropCase, changes: dict[str, Any], key: str) -> None:
    with pytest.raises(InputError) as refused:
        load_case(drop_case(changes))
    assert key in str(refused.value)


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
