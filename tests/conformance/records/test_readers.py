"""A short fuzz of every reader; verification/attacks/fuzz.py runs the same rounds for any time."""

import logging
import os
import signal
import time
import warnings
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record_reading import open_record, read_samples
from pantocheck.conformance.runs.record_folder import open_record_folder
from verification.attacks import fuzz, fuzz_files, fuzz_uses

ROUNDS = 6

NAMES = (
    *("csv table", "csv sidecar", "csv table, digest known", "h5 table", "h5 sidecar", "h5 table, digest known"),
    *("logger: a.csv", "logger: a.h5", "logger: a.mat", "logger: a.uff", "logger: sidecar", "profile", "limits"),
    *("summary record", "failing summary record", "case: 250.toml", "case: line.toml", "case: pantograph.toml"),
    *("plan", "dossier", "results as baseline", "certificate", "modes", "answer of a program"),
    *("drop: a.csv", "drop: a.h5", "drop: binary.uff", "drop: ascii.uff", "drop: version_5.mat"),
    *("drop: version_7_3.mat", "drop: sidecar"),
)


@pytest.fixture(scope="module")
def targets(tmp_path_factory: pytest.TempPathFactory) -> dict[str, fuzz_files.Target]:
    """Readers under fuzz by name; the formats of extras belong to the campaign only."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fuzz_files, "OPTIONAL_FORMATS", {})
        return {target.name: target for target in fuzz_files.build_targets(tmp_path_factory.mktemp("sound"))}


def test_every_reader_is_fuzzed_and_a_false_pass_detected(
    targets: dict[str, fuzz_files.Target], tmp_path: Path
) -> None:
    assert sorted(targets) == sorted(NAMES)
    # A failing result whose verdict is set to pass is a falsehood.
    (tmp_path / "a.toml").write_bytes(targets["failing summary record"].files["a.toml"])
    results = run_cases(select_cases(["en50318-2002/250"]), open_record_folder(tmp_path))
    assert results.verdict == "fail"
    fuzz_uses.check(results)
    with pytest.raises(fuzz_uses.Falsehood):
        fuzz_uses.check(results.model_copy(update={"verdict": "pass"}))


@pytest.mark.parametrize("name", NAMES)
def test_damaged_file_is_read_or_refused(targets: dict[str, fuzz_files.Target], name: str, tmp_path: Path) -> None:
    """The sound file is read (or, with a wrong digest, reported); damaged ones end in one message or a result."""
    logging.getLogger("pypdf").setLevel(logging.CRITICAL)
    target = targets[name]
    for file, content in target.files.items():
        (tmp_path / file).write_bytes(content)
    with pytest.raises(fuzz_uses.Falsehood) if "digest" in name else nullcontext():
        target.use(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Libraries warn of damaged files.
        assert fuzz.fuzz_target(target, ROUNDS, 1, tmp_path / "input")["refused"]


def test_campaign_reports_traceback_crash_and_hang(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each kind of failure is counted, its smallest input kept, and the campaign goes on."""

    def crash(_: Path) -> None:
        os.kill(os.getpid(), signal.SIGKILL)

    def fail(folder: Path) -> None:
        if len((folder / "a").read_bytes()) > 3:
            raise KeyError("x")

    def hang(_: Path) -> None:
        time.sleep(30)

    def read(_: Path) -> None:
        pass

    uses = {"crash": crash, "fail": fail, "hang": hang, "read": read}
    monkeypatch.setattr(fuzz, "SLOWEST_S", 1)
    targets = [fuzz_files.Target(name, {"a": b"abc"}, "a", use) for name, use in uses.items()]
    assert fuzz.run_campaign(targets, 20, 1, tmp_path) == 3
    assert sorted(folder.name for folder in tmp_path.iterdir()) == ["crash", "fail", "hang"]
    assert len((tmp_path / "fail" / "a").read_bytes()) == 4
    assert "20 rounds without a failure, 3 of 4 readers failed" in capsys.readouterr().out


# Values near the limits of the case, the limits themselves, and a few far outside.
VALUES = {
    "mean_force_N": st.one_of(st.floats(100, 130), st.sampled_from([110.0, 120.0, -110.0, 1e9])),
    "std_force_N": st.one_of(st.floats(20, 35), st.sampled_from([26.0, 31.0, 0.0])),
    "statistical_max_N": st.floats(180, 220),
    "statistical_min_N": st.floats(10, 50),
    "max_force_N": st.floats(170, 220),
    "min_force_N": st.floats(40, 80),
    "contact_loss_pct": st.sampled_from([0.0, 1e-9, 100.0]),
}
INSIDE = {
    "mean_force_N": 115.0,
    "std_force_N": 28.0,
    "statistical_max_N": 200.0,
    "statistical_min_N": 30.0,
    "max_force_N": 190.0,
    "min_force_N": 60.0,
    "contact_loss_pct": 0.0,
}


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.fixed_dictionaries(VALUES), st.floats(40, 60))
@example(INSIDE, 50.0)
def test_summary_passes_if_every_value_is_inside(tmp_path: Path, values: dict[str, float], uplift: float) -> None:
    (case,) = select_cases(["en50318-2002/250"])
    path = tmp_path / "a.toml"
    path.write_bytes((library_folder() / "en50318-2002" / "known-passing-code" / "250.toml").read_bytes())
    edit_toml(path, {"pantograph": [values], "quantities": {"max_uplift_at_support_mm": uplift}})
    (result,) = run_cases([case], open_record_folder(tmp_path)).cases
    graded = {**values, "max_uplift_at_support_mm": uplift}
    inside = all(
        (limit.lower is None or limit.lower <= graded[limit.quantity])
        and (limit.upper is None or graded[limit.quantity] <= limit.upper)
        for limit in case.limits
    )
    assert (result.verdict == "unconfirmed") == inside  # nothing confirms a summary


SOUND = {"speed_km_h": 250.0, "pantographs": 1, "filter_applied_Hz": "none", "file": "a.csv"}


def find_refusal(read: Callable[[Path], object], path: Path) -> InputError | None:
    """Error with which a reader refuses a file; None if the file is read."""
    try:
        read(path)
    except InputError as error:
        return error
    return None


ANYTHING = st.recursive(
    st.one_of(st.booleans(), st.integers(), st.floats(), st.text(max_size=20), st.dates(), st.datetimes()),
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(st.text(max_size=8), inner, max_size=4)),
    max_leaves=6,
)
KEYS = st.sampled_from(
    ["case", "file", "sha256", "speed_km_h", "pantographs", "evaluated_m", "filter_applied_Hz", "start_m", "spacing_m",
     "support_position_m", "line", "system", "run", "filter_cutoff_Hz", "pantograph", "quantities", "trust", "source"]
)  # fmt: skip


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(["pantocheck.record/1", "pantocheck.summary/1"]), st.dictionaries(KEYS, ANYTHING, max_size=4))
def test_any_toml_is_a_record_or_refused_with_its_key(tmp_path: Path, schema: str, keys: dict[str, Any]) -> None:
    base = SOUND if schema == "pantocheck.record/1" else {}
    (tmp_path / "a.toml").write_text(tomli_w.dumps({"schema": schema, **base, **keys}), encoding="utf-8")
    refusal = find_refusal(open_record, tmp_path / "a.toml")
    if refusal is not None:
        assert refusal.where.startswith(("sidecar 'a.toml'", "summary record 'a.toml'", "record 'a.toml'"))
        assert refusal.hint


CELLS = st.one_of(st.floats().map(repr), st.integers().map(str), st.text(max_size=6), st.just(""))


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.lists(CELLS, min_size=3, max_size=3), max_size=6), st.sampled_from(["\n", "\r\n", "\r"]))
def test_any_text_is_a_table_or_refused(tmp_path: Path, rows: list[list[str]], end: str) -> None:
    sidecar = {"schema": "pantocheck.record/1", **SOUND}
    (tmp_path / "a.toml").write_text(tomli_w.dumps(sidecar))
    lines = ["time_s,position_1_m,force_1_N", *(",".join(row) for row in rows)]
    (tmp_path / "a.csv").write_bytes(end.join(lines).encode("utf-8", "surrogatepass"))
    refusal = find_refusal(read_samples, tmp_path / "a.toml")
    if refusal is not None:
        assert refusal.where.startswith("record 'a.csv'")
