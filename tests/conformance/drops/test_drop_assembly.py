"""Mass-drop records in SI units: units, directions, clipping, dead channels, keys of other tools."""

from pathlib import Path

import pytest

from helpers.drop_records import RATE, assert_same_record
from helpers.toml_edit import edit_toml
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
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


def test_clipping_is_marked(tmp_path: Path, record: DropRecord) -> None:
    signals = record.signals.copy()
    signals[50:60, 0] = signals[:, 0].max()
    clipped = DropRecord(record.name, record.source, RATE, signals, record.channels, drop=record.drop, line=record.line)
    write_drop_csv(clipped, tmp_path / "r.csv")
    (read,) = read_drop_records(tmp_path / "r.csv")
    assert any("clipped" in text for text in read.warnings)


def test_dead_channel_is_refused(tmp_path: Path, record: DropRecord) -> None:
    signals = record.signals.copy()
    signals[:, 1] = 0.25
    dead = DropRecord(record.name, record.source, RATE, signals, record.channels, drop=record.drop)
    write_drop_csv(dead, tmp_path / "r.csv")
    with pytest.raises(InputError, match="is constant"):
        read_drop_records(tmp_path / "r.csv")


def test_unknown_keys_of_a_measuring_team_are_ignored(tmp_path: Path, record: DropRecord) -> None:
    write_drop_csv(record, tmp_path / "r.csv")
    edit_toml(tmp_path / "r.toml", {"weather": {"wind_m_s": 2.0}})
    assert_same_record(read_drop_records(tmp_path / "r.csv")[0], record, 1e-8)
