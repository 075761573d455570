"""Mass-drop records in SI units: units, directions, clipping, dead channels, sidecars."""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.drop_records import RATE, assert_same_record
from helpers.toml_edit import edit_toml
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.files import file_digest
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord, find_sampling_rate
from pantocheck.conformance.drops.drop_sidecar import DropSidecar, describe_columns
from pantocheck.conformance.drops.drop_writing import write_drop_csv


def test_units_and_directions_become_si_and_upward(tmp_path: Path, record: DropRecord) -> None:
    write_drop_csv(record, tmp_path / "r.csv")
    edit_toml(tmp_path / "r.toml", {"channel.0.direction": "-z", "channel.0.unit": "g"})
    (read,) = read_drop_records(tmp_path / "r.csv")
    assert read.signals[:, 0] == pytest.approx(-9.80665 * record.signals[:, 0], rel=1e-6)
    assert read.signals[:, 2] == pytest.approx(record.signals[:, 2], rel=1e-6)


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        *(("m/s2", 1.0), ("mm/s2", 0.001), ("g", 9.80665), ("mg", 0.00980665)),
        *(("m/s", 1.0), ("mm/s", 0.001), ("km/h", 1 / 3.6), ("m", 1.0), ("cm", 0.01), ("mm", 0.001)),
    ],
)
def test_every_unit_of_a_sensor_becomes_si(tmp_path: Path, record: DropRecord, unit: str, factor: float) -> None:
    """The factors are definitions, the standard acceleration of gravity included; nine digits are written."""
    write_drop_csv(record, tmp_path / "r.csv")
    changes = {f"channel.{column}.unit": unit for column in range(3)}
    edit_toml(tmp_path / "r.toml", changes | {"record.quantity": None})
    (read,) = read_drop_records(tmp_path / "r.csv")
    assert read.signals == pytest.approx(factor * record.signals, rel=1e-7, abs=1e-8 * factor)


def test_dead_channel_is_refused_and_an_unknown_key_ignored(tmp_path: Path, record: DropRecord) -> None:
    signals = record.signals.copy()
    signals[:, 1] = 0.25
    dead = DropRecord(record.name, record.source, RATE, signals, record.channels, drop=record.drop)
    write_drop_csv(dead, tmp_path / "r.csv")
    with pytest.raises(InputError, match="is constant"):
        read_drop_records(tmp_path / "r.csv")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"drop.position_mm": 2500.0}, r"key drop\.position_mm: unknown key\.\n.*did you mean position_m = 2\.5"),
        ({"weather": {"wind_m_s": 2.0}}, "key weather: unknown key"),
        ({"file": "other.csv"}, r"record 'other\.csv': cannot be read"),
        ({"file": "../r.csv"}, r"key file: found the path '\.\./r\.csv'"),
        ({"file": "copy.csv"}, r"key file: found 'copy\.csv', but the record is 'r\.csv'"),
        ({"file": "r.csv", "sha256": 64 * "0"}, "the content does not agree with sha256"),
        ({"sha256": 64 * "0"}, "key file: missing, although sha256 is given"),
    ],
)
def test_wrong_keys_and_other_tables_are_refused(
    tmp_path: Path, record: DropRecord, changes: dict[str, Any], message: str
) -> None:
    """An ignored key would hide a misspelt position, which changes the mode shapes."""
    write_drop_csv(record, tmp_path / "r.csv")
    (tmp_path / "copy.csv").write_bytes((tmp_path / "r.csv").read_bytes())
    edit_toml(tmp_path / "r.toml", changes)
    with pytest.raises(InputError, match=message):
        read_drop_records(tmp_path / "r.csv")


def test_sidecar_may_name_its_table(tmp_path: Path, record: DropRecord) -> None:
    write_drop_csv(record, tmp_path / "r.csv")
    edit_toml(tmp_path / "r.toml", {"file": "r.csv", "sha256": file_digest(tmp_path / "r.csv"), "test.synthetic": True})
    for path in (tmp_path / "r.csv", tmp_path / "r.toml"):
        assert_same_record(read_drop_records(path)[0], record, 1e-8)


# Columns of a mass-drop record: file and sidecar agree in number, name and unit.
CHANNELS = [
    {"column": 1, "name": "A", "sensor": 4, "wire": "CW", "position_m": 1.5, "unit": "g", "direction": "-z"},
    {"column": 2, "name": "B", "sensor": 5, "unit": "mm/s2", "direction": "+y"},
]


def sidecar(*channels: dict[str, Any], declared: int | None = None) -> DropSidecar:
    record: dict[str, Any] = {"sampling_rate_hz": 50.0}
    if declared is not None:
        record["n_channels"] = declared
    return DropSidecar.model_validate({"record": record, "channel": channels or CHANNELS})


def table(*columns: TableColumn) -> MeasuredTable:
    return MeasuredTable("r.csv", np.zeros((20, len(columns))), columns)


NAMELESS = (TableColumn(), TableColumn())


def test_sidecar_or_file_describes_the_columns() -> None:
    assert describe_columns(table(*NAMELESS), sidecar()) == [
        (1, TableColumn("A", 1, "g", 4, "CW", 1.5, "-z")),
        (2, TableColumn("B", 1, "mm/s2", 5, "", None, "+y")),
    ]
    one = sidecar({**CHANNELS[0], "column": 3}, {**CHANNELS[1], "column": 2})
    described = describe_columns(table(*NAMELESS, TableColumn("A", unit="g")), one)
    assert [(number, column.name) for number, column in described] == [(3, "A"), (2, "B")]
    assert one.channel_names == ("B", "A")
    columns = (TableColumn("A", 1, "g", 4, "CW", 1.5, "-z"), TableColumn("B", unit="g", direction="+x"))
    assert describe_columns(table(*columns), None) == [(1, columns[0]), (2, columns[1])]
    for number in range(2):
        incomplete = [*columns]
        incomplete[number] = TableColumn("C", unit="g")
        with pytest.raises(InputError, match=r"r\.csv': has neither descriptions of its columns nor a sidecar"):
            describe_columns(table(*incomplete), None)
    channels = [{**CHANNELS[0], "column": number, "name": f"C{number}"} for number in range(1, 10)]
    with pytest.raises(InputError, match=r"describes column 9 \(C3, C4, C5, C6, C7, C8 missing\)"):
        describe_columns(table(*NAMELESS), sidecar(*channels))


@pytest.mark.parametrize(
    ("column", "message"),
    [
        (TableColumn("A"), None),
        (TableColumn(" A "), None),
        (TableColumn("A", unit="g"), None),
        (TableColumn("A", unit=" gn "), None),
        (TableColumn("A", unit=""), None),
        (TableColumn("B"), "column 1: is named 'B', but the sidecar names it 'A'"),
        (TableColumn("x" * 70), f"column 1: is named '{'x' * 60}', but the sidecar names it 'A'"),
        (TableColumn(unit="mg"), "channel 'A': has the unit mg in the file, but g in the sidecar"),
        (TableColumn("A", unit="m/s"), "channel 'A': has the unit m/s in the file, but g in the sidecar"),
        (TableColumn("A", unit="V"), "has the unknown unit 'V'"),
    ],
)
def test_name_and_unit_of_the_file_agree_with_the_sidecar(column: TableColumn, message: str | None) -> None:
    """A unit that differs scales every amplitude; another quantity differs by the square of the frequency."""
    columns = table(column, TableColumn())
    with nullcontext() if message is None else pytest.raises(InputError, match=message):
        assert describe_columns(columns, sidecar())[0][1].unit == "g"


@pytest.mark.parametrize(
    ("described", "message"),
    [
        (sidecar(declared=2), None),
        (sidecar(declared=3), "sidecar of record 'r.csv': states n_channels = 3, but describes 2 channels"),
        (sidecar(declared=1), "states n_channels = 1, but describes 2 channels"),
        (sidecar(CHANNELS[0], {**CHANNELS[1], "column": 1}), "describes column 1 twice"),
        (sidecar(CHANNELS[1], CHANNELS[0], {**CHANNELS[0], "column": 2}), "describes column 2 twice"),
        (sidecar(CHANNELS[0], {**CHANNELS[1], "column": 3}), r"the sidecar describes column 3 \(B missing\)"),
    ],
)
def test_columns_are_described_once_and_exist(described: DropSidecar, message: str | None) -> None:
    with nullcontext() if message is None else pytest.raises(InputError, match=message):
        assert len(describe_columns(table(*NAMELESS), described)) == 2


# Sampling rate: its sources agree to a thousandth, and no sample is missing from its time.


HZ, SAMPLES = 400.0, 1200


def timed_table(time: RealArray | None = None, rate: float | None = None) -> MeasuredTable:
    size = SAMPLES if time is None else time.size
    return MeasuredTable("r.csv", np.zeros((size, 1)), (TableColumn(name="S1_z"),), time, rate)


def rate_sidecar(rate: float) -> DropSidecar:
    channel = {"column": 1, "name": "S1_z", "sensor": 1, "unit": "mg", "direction": "+z"}
    return DropSidecar.model_validate({"record": {"sampling_rate_hz": rate}, "channel": [channel]})


@pytest.mark.parametrize(
    ("factor", "agrees"),
    [(0.98, False), (0.9989, False), (0.9991, True), (1.0009, True), (1.0011, False), (1.02, False)],
)
@pytest.mark.parametrize("source", ["the file", "the time column"])
def test_sources_agree_to_a_thousandth(source: str, factor: float, agrees: bool) -> None:
    """Every frequency is proportional to the rate: 2 % is five times the scatter of an identified frequency."""
    other = factor * HZ
    table = timed_table(rate=other) if source == "the file" else timed_table(time=np.arange(SAMPLES) / other)
    if agrees:
        assert find_sampling_rate(table, rate_sidecar(HZ)) == HZ
        assert find_sampling_rate(table, None) == pytest.approx(other, rel=1e-9)
    else:
        expected = f"the sidecar states a sampling rate of 400 Hz, but {source} {other:g} Hz"
        with pytest.raises(InputError, match=expected):
            find_sampling_rate(table, rate_sidecar(HZ))


@pytest.mark.parametrize("sample", [1, 2, 600, SAMPLES - 3])
@pytest.mark.parametrize("missing", [1, 2])
def test_missing_sample_is_found_anywhere(sample: int, missing: int) -> None:
    """One sample of 1200 changes the rate by less than a thousandth: the gap itself shows it."""
    time = np.delete(np.arange(SAMPLES) / HZ, slice(sample, sample + missing))
    with pytest.raises(InputError, match="the time increases by"):
        find_sampling_rate(timed_table(time), None)


@pytest.mark.parametrize("digits", [3, 4, 6])
def test_printed_times_are_even(digits: int) -> None:
    """A step of 2.5 ms, printed to a millisecond, is 2 ms or 3 ms: less than half a step from the mean."""
    time = np.round(np.arange(SAMPLES) / HZ, digits)
    assert find_sampling_rate(timed_table(time), None) == pytest.approx(HZ, rel=1e-3)


@pytest.mark.parametrize(
    ("time", "message"),
    [
        (np.where(np.arange(SAMPLES) == 700, np.nan, np.arange(SAMPLES) / HZ), "the time of sample 701 is not finite"),
        (np.where(np.arange(SAMPLES) >= 700, np.inf, np.arange(SAMPLES) / HZ), "the time of sample 701 is not finite"),
        (np.zeros(SAMPLES), "the time column does not increase"),
        (-np.arange(SAMPLES) / HZ, "the time column does not increase"),
    ],
)
def test_time_increases_and_has_no_missing_value(time: RealArray, message: str) -> None:
    with pytest.raises(InputError, match=message):
        find_sampling_rate(timed_table(time), None)


@pytest.mark.parametrize("shift", [-0.49, 0.49, -0.51, 0.51])
def test_sample_is_displaced_by_less_than_half_a_step(shift: float) -> None:
    """A step of 2.5 ms; a sample 1.275 ms late is followed by a short step."""
    time = np.arange(SAMPLES) / HZ
    time[600] += shift / HZ
    refusal = pytest.raises(InputError, match=r"s after 1\.\d+ s, but by 0\.0025 s on average")
    with nullcontext() if abs(shift) < 0.5 else refusal:
        assert find_sampling_rate(timed_table(time), None) == pytest.approx(HZ, rel=1e-12)


@pytest.mark.parametrize("start", [0.0, 10.0, -3.0])
def test_time_may_begin_anywhere(start: float) -> None:
    assert find_sampling_rate(timed_table(start + np.arange(SAMPLES) / HZ), None) == pytest.approx(HZ, rel=1e-9)


@pytest.mark.parametrize(("rate", "possible"), [(0.1, True), (0.099, False), (1e6, True), (1.01e6, False)])
def test_rate_lies_between_a_tenth_and_a_million_hertz(rate: float, possible: bool) -> None:
    with nullcontext() if possible else pytest.raises(InputError, match=r"Give a rate from 0\.1 to 1e\+06 Hz"):
        assert find_sampling_rate(timed_table(rate=rate), None) == rate


def test_every_source_is_checked() -> None:
    """The second and the third source of the rate, where the first is right."""
    with pytest.raises(InputError, match="the file states a sampling rate of 0 Hz"):
        find_sampling_rate(timed_table(rate=0.0), rate_sidecar(HZ))
    time = np.arange(SAMPLES) / (1.01 * HZ)
    with pytest.raises(InputError, match="the sidecar states a sampling rate of 400 Hz, but the time column 404 Hz"):
        find_sampling_rate(timed_table(time, HZ), rate_sidecar(HZ))
    with pytest.raises(InputError, match="states no sampling rate"):
        find_sampling_rate(timed_table(), None)
    assert find_sampling_rate(timed_table(np.arange(SAMPLES) / HZ, 1.0005 * HZ), None) == 1.0005 * HZ
