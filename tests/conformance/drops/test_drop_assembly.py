"""Mass-drop records in SI units: units, directions, clipping, dead channels, keys of other tools."""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.drop_records import RATE, assert_same_record
from helpers.toml_edit import edit_toml
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
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


def test_sidecar_describes_the_columns() -> None:
    assert describe_columns(table(*NAMELESS), sidecar()) == [
        (1, TableColumn("A", 1, "g", 4, "CW", 1.5, "-z")),
        (2, TableColumn("B", 1, "mm/s2", 5, "", None, "+y")),
    ]


def test_sidecar_may_leave_columns_out_and_state_them_in_any_order() -> None:
    one = sidecar({**CHANNELS[0], "column": 3}, {**CHANNELS[1], "column": 2})
    described = describe_columns(table(*NAMELESS, TableColumn("A", unit="g")), one)
    assert [(number, column.name) for number, column in described] == [(3, "A"), (2, "B")]
    assert one.channel_names == ("B", "A")


def test_file_without_a_sidecar_describes_every_column() -> None:
    columns = (TableColumn("A", 1, "g", 4, "CW", 1.5, "-z"), TableColumn("B", unit="g", direction="+x"))
    assert describe_columns(table(*columns), None) == [(1, columns[0]), (2, columns[1])]
    for number in range(2):
        incomplete = [*columns]
        incomplete[number] = TableColumn("C", unit="g")
        with pytest.raises(InputError, match=r"r\.csv': has neither descriptions of its columns nor a sidecar"):
            describe_columns(table(*incomplete), None)


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
        (
            sidecar(CHANNELS[0], {**CHANNELS[1], "column": 3}),
            r"has 2 columns, but the sidecar describes column 3 \(B missing\)",
        ),
    ],
)
def test_columns_are_described_once_and_exist(described: DropSidecar, message: str | None) -> None:
    with nullcontext() if message is None else pytest.raises(InputError, match=message):
        assert len(describe_columns(table(*NAMELESS), described)) == 2


def test_first_six_missing_channels_are_listed() -> None:
    channels = [{**CHANNELS[0], "column": number, "name": f"C{number}"} for number in range(1, 10)]
    with pytest.raises(InputError, match=r"describes column 9 \(C3, C4, C5, C6, C7, C8 missing\)"):
        describe_columns(table(*NAMELESS), sidecar(*channels))
