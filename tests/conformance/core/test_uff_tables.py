"""Universal files of other programs: direction and unit from the codes of the format, identification lines, faults."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
from numpy.testing import assert_allclose

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import MeasuredTable, read_tables

SAMPLES = np.random.default_rng(5).standard_normal((2, 40))


def write(path: Path, *changes: dict[str, Any], interval_s: tuple[float, float] = (0.02, 0.02)) -> Path:
    """File with one data set 58 per table of changes, as a program writes it that does not know the suite."""
    sets = []
    for row, change in enumerate(changes):
        fields: dict[str, Any] = {
            "binary": 1, "func_type": 1, "rsp_node": 7 + row, "rsp_dir": 3, "ref_node": 0, "ref_dir": 0,
            "ord_data_type": 4, "num_pts": 40, "data": SAMPLES[row], "x": np.arange(40) * interval_s[row],
            "abscissa_spacing": 1, "abscissa_min": 0.0, "abscissa_inc": interval_s[row], "abscissa_spec_data_type": 17,
            "ordinate_spec_data_type": 12, "ordinate_axis_units_lab": "NONE", "orddenom_spec_data_type": 0,
            "z_axis_spec_data_type": 0, **{f"id{line}": "NONE" for line in range(1, 6)},
        }  # fmt: skip
        sets.append(pyuff.prepare_58(**(fields | change)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)  # pyuff leaves its files to the garbage collector
        pyuff.UFF(str(path)).write_sets(sets, mode="add")
    return path


def read(path: Path, names: tuple[str, ...] = ()) -> MeasuredTable:
    (table,) = read_tables(path, names, 1000)
    return table


@pytest.mark.parametrize(("code", "direction"), [(1, "+x"), (2, "+y"), (3, "+z"), (-1, "-x"), (-2, "-y"), (-3, "-z")])
def test_direction_is_that_of_the_code(code: int, direction: str, tmp_path: Path) -> None:
    """Codes of the format: 1, 2, 3 for the translations along x, y, z."""
    (column,) = read(write(tmp_path / "r.uff", {"rsp_dir": code})).columns
    assert (column.name, column.sensor, column.direction) == (f"S7_{direction[1]}", 7, direction)
    assert (column.wire, column.position) == ("", None)


@pytest.mark.parametrize(("code", "unit"), [(8, "m"), (11, "m/s"), (12, "m/s2")])
@pytest.mark.parametrize("label", ["NONE", "none", ""])
def test_unit_without_a_label_is_that_of_the_code(code: int, unit: str, label: str, tmp_path: Path) -> None:
    """Codes of the format: 8 displacement, 11 velocity, 12 acceleration."""
    change = {"ordinate_spec_data_type": code, "ordinate_axis_units_lab": label}
    assert read(write(tmp_path / "r.uff", change)).columns[0].unit == unit


def test_label_of_a_unit_precedes_the_code(tmp_path: Path) -> None:
    assert read(write(tmp_path / "r.uff", {"ordinate_axis_units_lab": "mm/s2"})).columns[0].unit == "mm/s2"


def test_identification_lines_describe_channel_and_drop(tmp_path: Path) -> None:
    lines = {"id1": "T3", "id2": "40.5 kg on CW at 33 m, trigger at 1.25 s", "id3": "A4 MW at -12.5 m dir -y"}
    table = read(write(tmp_path / "r.uff", lines, {}))
    column = table.columns[0]
    assert (column.name, column.wire, column.position, column.direction) == ("A4", "MW", -12.5, "-y")
    assert table.columns[1].name == "S8_z"
    assert table.rate == pytest.approx(50.0, rel=1e-9)  # the interval is stored with nine digits or more
    drop = {"drop_mass_kg": "40.5", "drop_wire": "CW", "drop_position_m": "33", "trigger_nominal_s": "1.25"}
    assert table.attributes == {"test": "T3"} | drop
    attributes = read(write(tmp_path / "q.uff", {"id2": "40 kg on MW at 5 m"})).attributes
    assert (attributes["drop_wire"], attributes["trigger_nominal_s"]) == ("MW", None)
    assert read(write(tmp_path / "s.uff", {"id1": "T3", "id2": "a mass"})).attributes == {"test": "T3"}


@pytest.mark.parametrize(("line", "name"), [("A4 MW at 1 m dir -y", "A4"), ("NONE", None)])
def test_channel_with_a_sidecar_has_name_and_unit_for_comparison(line: str, name: str | None, tmp_path: Path) -> None:
    change = {"id3": line, "ordinate_axis_units_lab": "g"}
    (column,) = read(write(tmp_path / "r.uff", change), ("A4",)).columns
    assert (column.name, column.unit, column.direction) == (name, "g", None)


def test_functions_of_frequency_are_left_out(tmp_path: Path) -> None:
    table = read(write(tmp_path / "r.uff", {"func_type": 4}, {}))
    assert [column.sensor for column in table.columns] == [8]
    assert_allclose(table.values[:, 0], SAMPLES[1], rtol=0)
    with pytest.raises(InputError, match="holds no time response"):
        read(write(tmp_path / "s.uff", {"func_type": 4}))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (({}, {"rsp_dir": 4}), "r.uff', data set 2: states no direction"),
        (({}, {"ordinate_spec_data_type": 0}), "r.uff', data set 2: states no unit"),
        (({"rsp_dir": 0}, {}), "r.uff', data set 1: states no direction"),
        (({}, {"data": SAMPLES[1, :39], "num_pts": 39}), "has channels of different length"),
    ],
)
def test_faulty_data_set_is_refused(changes: tuple[dict[str, Any], ...], message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        read(write(tmp_path / "r.uff", *changes))


@pytest.mark.parametrize(
    ("interval_s", "message"),
    [
        ((0.02, 0.01), r"r\.uff': has channels with different sampling intervals \(0\.01, 0\.02 s\)"),
        ((0.0, 0.0), r"r\.uff': states a sampling interval of 0 s"),
        ((-0.02, -0.02), r"r\.uff': states a sampling interval of -0\.02 s"),
    ],
)
def test_channels_share_a_positive_interval(interval_s: tuple[float, float], message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        read(write(tmp_path / "r.uff", {}, {}, interval_s=interval_s))


def test_samples_are_counted_and_truncated_data_named(tmp_path: Path) -> None:
    path = write(tmp_path / "r.uff", {}, {})
    first, second, third = path.read_bytes().split(b"         4        40")
    path.write_bytes(first + b"         4        40" + second + b"         4        41" + third)
    with pytest.raises(InputError, match=r"r\.uff', data set 2: holds 40 samples, but its head states 41"):
        read(path)
    path = write(tmp_path / "whole.uff", {}, {})
    assert read_tables(path, (), 80)[0].values.size == 80
    with pytest.raises(InputError, match="more than 79 numbers"):
        read_tables(path, (), 79)
