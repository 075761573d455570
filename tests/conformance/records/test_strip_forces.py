"""Forces of the strips of a head: in records, in the embedded signals, and in the curves of a page."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.comparison.profile_grading import grade_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.assessed_record import AssessedRecord, load_assessed_record
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.evaluated_signals import pack_signals, unpack_signals
from pantocheck.conformance.records.record import STRIP_CHANNELS, Record, RecordInvalid
from pantocheck.conformance.records.record_reading import read_record, read_samples
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.records.traces import build_pantograph_traces


@pytest.fixture
def record(two_pantograph_record: Record) -> Record:
    """The front strips carry 60 % of the force, and a sine of their own."""
    plain = replace(two_pantograph_record, evaluated=(155.0, 165.0))
    front = 0.6 * plain.force + 5 * np.sin(40 * plain.time)
    return replace(plain, front_strip=front, rear_strip=plain.force - front)


@pytest.mark.parametrize("suffix", [".csv", ".h5"])
def test_forces_of_strips_survive_a_file(record: Record, tmp_path: Path, suffix: str) -> None:
    """Twelve digits are written."""
    found = read_record(write_record(tmp_path / f"record{suffix}", record))[0]
    for name in ("front_strip", "rear_strip"):
        np.testing.assert_allclose(getattr(found, name), getattr(record, name), rtol=1e-11, atol=1e-9)


def test_forces_that_do_not_add_up_are_refused(record: Record) -> None:
    """The graded force is the sum of both: 0.1 N is rounding, 0.2 N is not."""
    replace(record, rear_strip=record.rear_strip + 0.09)
    wrong = np.array(record.rear_strip)
    wrong[1, 6] += 0.2
    with pytest.raises(RecordInvalid, match=r"do not add up .* by 0.2 N at sample 7 of pantograph 2"):
        replace(record, rear_strip=wrong)
    for name, rest in zip(STRIP_CHANNELS, STRIP_CHANNELS[::-1], strict=True):
        with pytest.raises(RecordInvalid, match=f"{name}: missing") as error:
            replace(record, **{name: None})
        assert rest not in str(error.value)


def test_curves_and_embedded_signals_have_the_forces_of_both_strips(record: Record) -> None:
    signals = RecordSignals(record, Filter())
    packed = pack_signals(signals.pantographs, signals.line, record.time)
    assert packed is not None
    unpacked = unpack_signals(packed, Filter()).pantographs
    for pantographs in (signals.pantographs, unpacked):
        trace = build_pantograph_traces(pantographs, [])["1"]
        assert trace.strip_forces_N is not None
        np.testing.assert_allclose(np.sum(trace.strip_forces_N, axis=0), trace.force_N, rtol=1e-4, atol=1e-2)
        front = record.front_strip[0][signals.pantographs[1].inside]
        assert np.ptp(trace.strip_forces_N[0]) == pytest.approx(np.ptp(front), rel=1e-2)
    plain = RecordSignals(replace(record, front_strip=None, rear_strip=None), Filter())
    assert "strip_forces_N" not in build_pantograph_traces(plain.pantographs, [])["1"].model_dump()


LINE_RECORD = """\
schema = "pantocheck.record/1"
file = "run.csv"
speed_km_h = 180.0
pantographs = 1
filter_applied_Hz = "none"
evaluated_m = [100.0, 900.0]
"""


def write_passage(folder: Path, columns: dict[str, np.ndarray], sidecar: str = LINE_RECORD) -> Path:
    names, values = ",".join(columns), np.column_stack(list(columns.values()))
    np.savetxt(folder / "run.csv", values, fmt="%.12g", delimiter=",", header=names, comments="")
    (folder / "run.toml").write_text(sidecar, encoding="utf-8")
    return folder / "run.toml"


def strip_columns(time: np.ndarray) -> dict[str, np.ndarray]:
    """Strips in opposite phase at 1 Hz, which their sum does not show; content up to 35 Hz as a real force has."""
    high = sum(4 * np.sin(2 * np.pi * f * time) for f in (3.0, 12.0, 35.0))
    shared = 20 * np.sin(2 * np.pi * time)
    columns = {"front_strip_1_N": 70 + shared + high, "rear_strip_1_N": 50 - shared}
    return {"time_s": time, "position_1_m": 50 * time, **columns}


def assess(path: Path) -> AssessedRecord:
    return load_assessed_record(path, load_profile("acceptance-ac"), LineTable())


@pytest.mark.parametrize("uneven", [False, True])
def test_assessed_record_keeps_the_strips(tmp_path: Path, uneven: bool) -> None:
    """Uneven samples are interpolated by cubics: at 35 Hz and 2 ms, their error is below 4 N (h w)^2 / 8 = 0.1 N."""
    time = np.arange(0, 20, 0.002)
    columns = strip_columns(time + (0.0003 * np.sin(time) if uneven else 0.0))
    found = assess(write_passage(tmp_path, columns))
    assert found.prepared is not None
    signals = found.prepared.pantographs[1]
    even = (signals.position / 50)[signals.inside]
    expected = strip_columns(even)
    for force, name in zip(signals.strip_forces, ("front_strip_1_N", "rear_strip_1_N"), strict=True):
        np.testing.assert_allclose(force, expected[name], atol=0.1 if uneven else 1e-8)
    # The graded force is the sum: RMS of three sines of 4 N; the filter takes that of 35 Hz and 2 % of that of 12 Hz.
    assert found.values.values[1]["std_force_N"] == pytest.approx(4.0, abs=0.05)
    result = grade_record(found, load_profile("acceptance-ac"), "secondary")
    assert result.signals is not None
    assert result.signals.pantographs["1"].front_strip_N is not None
    assert len(result.traces["1"].strip_forces_N or ()) == 2


def test_measured_strips_must_add_up_to_the_force(tmp_path: Path) -> None:
    columns = strip_columns(np.arange(0, 20, 0.002))
    columns["force_1_N"] = columns["front_strip_1_N"] + columns["rear_strip_1_N"]
    assess(write_passage(tmp_path, columns))
    columns["force_1_N"] += np.where(columns["time_s"] == columns["time_s"][4000], 0.3, 0.0)
    with pytest.raises(InputError, match=r"do not add up .* by 0.3 N at sample 4001 of pantograph 1"):
        assess(write_passage(tmp_path, columns))
    with pytest.raises(InputError, match="rear_strip: missing"):
        assess(write_passage(tmp_path, {name: value for name, value in columns.items() if "rear" not in name}))


def test_strip_with_gaps_is_left_out_with_a_warning(tmp_path: Path) -> None:
    columns = strip_columns(np.arange(0, 20, 0.002))
    columns["force_1_N"] = columns["front_strip_1_N"] + columns["rear_strip_1_N"]
    columns["front_strip_1_N"][6000] = np.nan
    found = assess(write_passage(tmp_path, columns))
    assert found.prepared is not None
    assert not found.prepared.pantographs[1].strip_forces
    assert any("strips of pantograph 1 are missing" in warning for warning in found.warnings)


def test_sensors_of_each_strip_give_its_force(tmp_path: Path) -> None:
    """Two sensors below the front strip and one below the rear one, with 2 kg that accelerate by 3 m/s2 above it."""
    time = np.arange(0, 20, 0.002)
    columns = strip_columns(time)
    measured = {
        "t": time, "x": 50 * time, "a": 0.3 * columns["front_strip_1_N"], "b": 0.7 * columns["front_strip_1_N"],
        "c": columns["rear_strip_1_N"] + 6.0, "acc": np.full(time.size, 3.0),
    }  # fmt: skip
    sidecar = f"""{LINE_RECORD}
    [columns]
    time_s = {{ column = "t", unit = "s" }}
    position_1_m = {{ column = "x", unit = "m" }}
    front_strip_1_N.sum = [{{ column = "a", unit = "N" }}, {{ column = "b", unit = "N" }}]
    [columns.rear_strip_1_N]
    sum = [{{ column = "c", unit = "N" }}]
    head = [{{ mass_kg = 2.0, acceleration = {{ column = "acc", unit = "m/s2" }} }}]
    """
    samples, _, _ = read_samples(write_passage(tmp_path, measured, sidecar))
    np.testing.assert_allclose(samples.rear_strip[0], columns["rear_strip_1_N"], atol=1e-8)
    np.testing.assert_allclose(samples.force[0], columns["front_strip_1_N"] + columns["rear_strip_1_N"], atol=1e-8)
