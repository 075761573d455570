"""Facts of a mass-drop record: from file and sidecar, in every format, and written as they were read."""

import tomllib
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import pyuff

from helpers.drop_records import N, assert_same_record
from helpers.toml_edit import edit_toml
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn, parse_direction
from pantocheck.conformance.drops.drop_reading import assemble_drop_record, build_drop, build_line, read_drop_records
from pantocheck.conformance.drops.drop_record import DropDescription, DropRecord
from pantocheck.conformance.drops.drop_sidecar import DropSidecar
from pantocheck.conformance.drops.drop_writing import write_drop_csv, write_drop_hdf5, write_drop_uff
from pantocheck.conformance.results.identified_modes import MeasuredLine

WRITERS: dict[str, Callable[[DropRecord, Path], None]] = {
    "r.csv": write_drop_csv, "r.h5": lambda record, path: write_drop_hdf5((record,), path), "r.uff": write_drop_uff
}  # fmt: skip


def unknown_facts(record: DropRecord) -> DropRecord:
    """Record of which only the signals and the names of its sensors are known."""
    channels = tuple(replace(channel, wire="", position=None) for channel in record.channels)
    return replace(record, channels=channels, drop=DropDescription(), line=MeasuredLine())


@pytest.mark.parametrize("quantity", ["acceleration", "velocity", "displacement"])
@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("name", WRITERS)
def test_every_fact_reads_back(name: str, known: bool, quantity: Any, record: DropRecord, tmp_path: Path) -> None:
    """CSV has nine digits, the others doubles."""
    written = replace(record if known else unknown_facts(record), quantity=quantity)
    WRITERS[name](written, tmp_path / name)
    (read,) = read_drop_records(tmp_path / name)
    assert_same_record(read, written, 1e-8 if name == "r.csv" else 0.0)
    assert read.file == str((tmp_path / name).resolve())
    assert read.name == "T"
    assert read.warnings == ()


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_universal_file_alone_keeps_direction_and_unit(axis: Any, record: DropRecord, tmp_path: Path) -> None:
    """Without a sidecar, and without a position that an identification line could hold: the codes of the format."""
    channels = tuple(replace(channel, axis=axis, wire="", position=None) for channel in record.channels[:1])
    alone = replace(record, signals=record.signals[:, :1].copy(), channels=channels, quantity="velocity")
    write_drop_uff(alone, tmp_path / "r.uff")
    (tmp_path / "r.toml").unlink()
    (read,) = read_drop_records(tmp_path / "r.uff")
    assert (read.channels[0].axis, read.channels[0].sensor, read.quantity) == (axis, 1, "velocity")


@pytest.mark.parametrize("missing", ["mass", "wire", "position"])
def test_universal_file_states_a_drop_that_is_fully_known(missing: str, record: DropRecord, tmp_path: Path) -> None:
    drop = replace(record.drop, **{missing: "" if missing == "wire" else None})
    write_drop_uff(replace(record, drop=drop), tmp_path / "r.uff")
    (tmp_path / "r.toml").unlink()
    assert read_drop_records(tmp_path / "r.uff")[0].drop == DropDescription()


@pytest.mark.parametrize("changes", [{"position": None}, {"wire": ""}, {"name": "S1 z"}, {"name": "Sé_z"}])
def test_universal_file_names_channels_it_can_hold(changes: dict[str, Any], record: DropRecord, tmp_path: Path) -> None:
    """Otherwise the name is made of sensor and axis, as for a file of another program."""
    channels = (replace(record.channels[2], **changes), *record.channels[:2])
    write_drop_uff(replace(record, channels=channels), tmp_path / "r.uff")
    lines = [str(data_set["id3"]).strip() for data_set in pyuff.UFF(str(tmp_path / "r.uff")).read_sets()]
    assert lines == ["NONE", "S1_z CW at 12 m dir +z", "S1_y CW at 12 m dir +y"]
    (tmp_path / "r.toml").unlink()
    first, second, _ = read_drop_records(tmp_path / "r.uff")[0].channels
    assert (first.name, first.wire, first.position) == ("S2_z", "", None)
    assert second == record.channels[0]


@pytest.mark.parametrize(("length", "shown"), [(79, 79), (80, 80), (81, 80)])
def test_identification_line_has_eighty_characters(length: int, shown: int, record: DropRecord, tmp_path: Path) -> None:
    """The format has lines of 80 characters; the sidecar holds the whole name."""
    name = "T" * length
    write_drop_uff(replace(record, name=name), tmp_path / "r.uff")
    assert read_drop_records(tmp_path / "r.uff")[0].name == name
    (tmp_path / "r.toml").unlink()
    assert read_drop_records(tmp_path / "r.uff")[0].name == "T" * shown
    assert b"T" * 81 not in (tmp_path / "r.uff").read_bytes()


def test_record_is_named_after_its_file_and_knows_its_axes(record: DropRecord, tmp_path: Path) -> None:
    write_drop_csv(replace(record, name=""), tmp_path / "n.csv")
    assert read_drop_records(tmp_path / "n.csv")[0].name == "n.csv"
    assert (record.duration, record.time[-1]) == (N / 100, (N - 1) / 100)
    assert (record.along("z"), record.along("y"), record.along("x")) == ((0, 2), (1,), ())
    with pytest.raises(ValueError, match="read-only"):
        record.signals[0, 0] = 0.0
    write_drop_hdf5((record,), tmp_path / "r.h5")
    with h5py.File(tmp_path / "r.h5", "r+") as file:
        file["channels/position_m"][1] = np.nan
    assert [channel.position for channel in read_drop_records(tmp_path / "r.h5")[0].channels] == [12.0, None, 40.5]


def test_sidecar_has_the_keys_of_the_record_and_precedes_the_file(record: DropRecord, tmp_path: Path) -> None:
    write_drop_hdf5((record, record), tmp_path / "r.h5")
    write_drop_csv(record, tmp_path / "r.csv")
    edit_toml(tmp_path / "r.toml", {"drop.mass_kg": 31.0, "drop.wire": None, "test.name": "T9", "test.spans_m": [50.0]})
    runs = read_drop_records(tmp_path / "r.h5")
    assert [run.name for run in runs] == ["T9 run 1", "T9 run 2"]
    assert runs[1].drop == replace(record.drop, mass=31.0)
    assert runs[1].line == record.line.model_copy(update={"spans_m": (50.0,)})
    write_drop_csv(record, tmp_path / "r.csv")
    content = tomllib.loads((tmp_path / "r.toml").read_text())
    facts = {"sampling_rate_hz": 100.0, "trigger_nominal_s": 1.5, "n_channels": 3, "quantity": "acceleration"}
    assert content["record"] == facts
    assert [channel["column"] for channel in content["channel"]] == [1, 2, 3]
    place = {"sensor": 2, "wire": "MW", "position_m": 40.5, "direction": "+z", "unit": "m/s2"}
    assert content["channel"][2] == {"column": 3, "name": "S2_z"} | place


@pytest.mark.parametrize(
    "change",
    [
        lambda r: replace(r, rate=2 * r.rate),
        lambda r: replace(r, drop=DropDescription()),
        lambda r: replace(r, channels=r.channels[::-1]),
        lambda r: replace(r, quantity="velocity"),
    ],
)
def test_runs_of_different_tests_are_not_written_together(change: Any, record: DropRecord, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the runs differ in channels, rate, quantity or drop"):
        write_drop_hdf5((record, record, change(record)), tmp_path / "r.h5")
    assert not (tmp_path / "r.h5").exists()


@pytest.mark.parametrize("key", ["drop_mass_kg", "drop_position_m", "trigger_nominal_s"])
def test_fact_that_is_no_number_is_named(key: str) -> None:
    with pytest.raises(InputError) as caught:
        build_drop({key: "x" * 50}, "record 'r.h5'", 4.0)
    assert caught.value.where == f"record 'r.h5', attribute {key}"
    assert caught.value.found == f"'{'x' * 40}' is not a number"


def test_facts_of_a_line_are_numbers() -> None:
    attributes = {"spans_m": np.array([60.0, 54.0]), "cw_tension_n": 2e4, "mw_tension_n": "15000"}
    assert build_line(attributes, "here") == MeasuredLine(
        spans_m=(60.0, 54.0), contact_wire_tension_N=2e4, messenger_wire_tension_N=1.5e4
    )
    assert build_line({"spans_m": 55}, "here") == MeasuredLine(spans_m=(55.0,))
    assert build_line({}, "here") == MeasuredLine()
    for key in ("spans_m", "cw_tension_n", "mw_tension_n"):
        with pytest.raises(InputError, match=f"here, attribute {key}: 'a' is not a number"):
            build_line({key: "a"}, "here")


@pytest.mark.parametrize(("trigger", "refused"), [(3.99, False), (4.0, True), (None, False)])
def test_trigger_lies_within_the_record(trigger: float | None, refused: bool) -> None:
    refusal = pytest.raises(InputError, match=r"the planned release at 4 s is after the end of the record at 4 s")
    with refusal if refused else nullcontext():
        assert build_drop({"trigger_nominal_s": trigger}, "here", 4.0).trigger_nominal == trigger


@pytest.mark.parametrize(
    ("text", "expected"),
    [("+z", ("z", 1.0)), ("-z", ("z", -1.0)), (" Y ", ("y", 1.0)), ("-X", ("x", -1.0)), ("z", ("z", 1.0))],
)
def test_direction_is_an_axis_with_a_sign(text: str, expected: tuple[str, float]) -> None:
    assert parse_direction(text, "here") == expected
    with pytest.raises(InputError) as caught:
        parse_direction("u" * 50, "here")
    assert caught.value.found == f"has the unknown direction '{'u' * 40}'"


def build_table(values: Any, unit: str = "m/s2") -> MeasuredTable:
    array = np.asarray(values, dtype=float)
    column = TableColumn("A", unit=unit, sensor=1, direction="+z")
    return MeasuredTable("r.csv", array[:, None], (column,), rate=50.0)


NOISE = np.random.default_rng(6).normal(0, 1, 200)


@pytest.mark.parametrize(("samples", "enough"), [(15, False), (16, True)])
def test_record_has_at_least_sixteen_samples(samples: int, enough: bool) -> None:
    with nullcontext() if enough else pytest.raises(InputError, match="only 15 samples"):
        assert assemble_drop_record(build_table(NOISE[:samples]), None).signals.shape == (16, 1)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_missing_values_are_counted_and_placed(value: float) -> None:
    """Sample 31 at 50 Hz is at 0.6 s."""
    signal = NOISE.copy()
    signal[[30, 80]] = value
    with pytest.raises(InputError, match=r"channel 'A': has 2 values that are not finite, the first at 0\.6 s"):
        assemble_drop_record(build_table(signal), None)


@pytest.mark.parametrize(
    ("peak", "unit", "doubted"), [(499.0, "m/s2", False), (501.0, "m/s2", True), (60.0, "g", True)]
)
@pytest.mark.parametrize("sign", [-1, 1])
def test_acceleration_above_500_is_doubted(peak: float, unit: str, doubted: bool, sign: int) -> None:
    """The distance from the median counts: gravity is no motion."""
    signal = np.zeros(200)
    signal[100:103] = sign * peak * np.array([0.5, 1.0, 0.4])
    warnings = assemble_drop_record(build_table(signal + (0.0 if unit == "g" else 9.81), unit), None).warnings
    assert [text.endswith("check the unit") for text in warnings] == [True] * doubted
    assert assemble_drop_record(build_table(1e6 * signal, "mm"), None).warnings == ()


def test_quantities_and_clipping_of_several_channels_are_named() -> None:
    columns = tuple(TableColumn(unit, unit=unit, direction="+z") for unit in ("m/s2", "g", "mm"))
    mixed = MeasuredTable("r.csv", np.column_stack([NOISE] * 3), columns, rate=50.0)
    with pytest.raises(InputError, match="holds channels of acceleration and displacement"):
        assemble_drop_record(mixed, None)
    both = MeasuredTable("r.csv", np.column_stack([NOISE] * 2), columns[:2], rate=50.0)
    record = assemble_drop_record(both, None)
    assert record.quantity == "acceleration"
    assert record.signals[:, 1] == pytest.approx(9.80665 * record.signals[:, 0], rel=1e-15)
    # Two tops, at samples 20 to 25 and 60 to 65, at 50 Hz.
    signal = NOISE.copy()
    signal[20:26] = signal[60:66] = 9.0
    (text,) = assemble_drop_record(build_table(signal), None).warnings
    assert text == "record 'r.csv', channel 'A': clipped 2 times between 0.40 s and 1.32 s"


@pytest.mark.parametrize(("quantity", "refused"), [(None, False), ("acceleration", False), ("velocity", True)])
def test_quantity_of_the_sidecar_is_that_of_the_units(quantity: str | None, refused: bool) -> None:
    recording = {"sampling_rate_hz": 50.0} | ({} if quantity is None else {"quantity": quantity})
    channel = {"column": 1, "name": "A", "sensor": 1, "unit": "m/s2", "direction": "+z"}
    sidecar = DropSidecar.model_validate({"record": recording, "channel": [channel]})
    refusal = pytest.raises(
        InputError, match=r"key record\.quantity: found 'velocity', but the units are those of acceleration"
    )
    with refusal if refused else nullcontext():
        assert assemble_drop_record(build_table(NOISE), sidecar).quantity == "acceleration"
