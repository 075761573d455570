"""Columns with other names, units and scales: the same samples and quantities as from a file with our own names."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.foreign_tables import FOREIGN_WRITERS
from helpers.toml_edit import edit_toml
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_reading import read_record, read_samples
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.records.record_writing import write_record

COLUMNS: dict[str, Any] = {
    "time_s": {"column": "time_s", "unit": "s"},
    "position_1_m": {"column": "km_vorn", "unit": "km"},
    "position_2_m": {"column": "km_hinten", "unit": "km"},
    "force_1_N": {"column": "Kraft_vorn", "unit": "kN"},
    "force_2_N": {"column": "Kraft_hinten", "unit": "N", "scale": 500.0, "offset": 20.0},
    "contact_height_1_m": {"column": "Hoehe_vorn", "unit": "mm"},
    "contact_height_2_m": {"column": "Hoehe_hinten", "unit": "cm"},
}


@pytest.fixture
def record(two_pantograph_record: Record) -> Record:
    """Record without the uplift; at rest in the first sample, so that a table begins with other numbers."""
    record = two_pantograph_record
    return Record(record.time, record.speed, record.position, record.force, (160.0, 200.0), None, record.contact_height)


@pytest.fixture
def foreign(record: Record, tmp_path: Path) -> Callable[[str], Path]:
    """Writer of the record under foreign names; the force of pantograph 2 in volts, 500 N/V, zero at 20 N."""

    def write(name: str) -> Path:
        channels = {
            "time_s": record.time,
            "Temperatur": np.linspace(12, 13, record.time.size),
            "km_vorn": record.position[0] / 1000,
            "km_hinten": record.position[1] / 1000,
            "Kraft_vorn": record.force[0] / 1000,
            "Kraft_hinten": (record.force[1] - 20) / 500,
            "Hoehe_vorn": record.contact_height[0] * 1000,
            "Hoehe_hinten": record.contact_height[1] * 100,
        }
        sidecar = write_record(tmp_path / f"{Path(name).stem}.csv", record)
        FOREIGN_WRITERS[name](tmp_path / name, channels)
        columns = {key: dict(value) for key, value in COLUMNS.items()}
        if name == "groups.h5":
            columns = {key: {**value, "column": f"daq/{value['column']}"} for key, value in columns.items()}
        if Path(name).suffix in {".uff", ".mf4"} or name.endswith(".mat"):
            del columns["time_s"]  # the file holds it beside its channels
        return edit_toml(sidecar, {"sha256": None, "file": name, "columns": columns})

    return write


@pytest.mark.parametrize("name", FOREIGN_WRITERS)
def test_every_format_gives_the_same_record(name: str, foreign: Callable[[str], Path], record: Record) -> None:
    """Fifteen digits in CSV, doubles elsewhere; two roundings by scale and offset change a value by 1e-15 of 200 N."""
    read, _ = read_record(foreign(name))
    for key in ("time", "position", "force", "contact_height"):
        assert_allclose(getattr(read, key), getattr(record, key), rtol=1e-12, atol=1e-12, err_msg=key)
    low_pass = Filter()
    expected, found = (RecordSignals(item, low_pass).evaluation for item in (record, read))
    assert expected.values[1].keys() >= {"mean_force_N", "std_force_N", "contact_height_range_mm"}
    for owner in (1, 2):
        for quantity, value in expected.values[owner].items():
            assert_allclose(found.values[owner][quantity], value, rtol=1e-9, atol=1e-9, err_msg=quantity)


def test_unused_columns_are_listed(foreign: Callable[[str], Path]) -> None:
    assert read_samples(foreign("a.csv"))[0].ignored == ("Temperatur",)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"force_1_N": {"column": "Kraft", "unit": "N"}}, r"columns.force_1_N.column: there is no column 'Kraft'"),
        ({"force_1_N": {"column": "Kraft_vorn", "unit": "mm"}}, r"columns.force_1_N.unit: 'mm' is not a unit of this"),
        ({"force_1_N": {"column": "Kraft_vorn"}}, r"columns.force_1_N.unit: missing; the file states no unit"),
        (
            {"force_1_N": {"column": "Kraft_vorn", "scale": 2.0}},
            r"force_1_N.unit: missing, but the value is scaled",
        ),
        ({"force_1_kN": {"column": "Kraft_vorn", "unit": "kN"}}, r"columns.force_1_kN: not a channel of a record"),
        ({"force_3_N": {"column": "Kraft_vorn", "unit": "kN"}}, r"columns.force_3_N: the sidecar has no pantograph 3"),
        ({"position_1_m": {"sum": [{"column": "a", "unit": "m"}]}}, r"sensors are summed to a force only"),
    ],
)
def test_wrong_mapping_names_its_key(change: dict[str, Any], message: str, foreign: Callable[[str], Path]) -> None:
    sidecar = foreign("a.csv")
    edit_toml(sidecar, {"columns": {**COLUMNS, **change}})
    with pytest.raises(InputError, match=message):
        read_record(sidecar)


def test_unit_of_the_file_is_used_and_a_contradiction_refused(tmp_path: Path, record: Record) -> None:
    """The unit stands in a line of units, or in brackets at the end of a name."""
    sidecar = write_record(tmp_path / "a.csv", record)
    rows = np.column_stack([record.time, record.position[0] / 1000, *(record.force / 1000)])
    lines = ["Zeit;Ort;F1 [kN];F2", "s;km;;kN", *(";".join(f"{value:.9f}" for value in row) for row in rows)]
    (tmp_path / "a.csv").write_text("\n".join(lines).replace(".", ","), encoding="cp1252")
    names = {"time_s": "Zeit", "position_1_m": "Ort", "force_1_N": "F1 [kN]", "force_2_N": "F2"}
    columns = {key: {"column": name} for key, name in names.items()}
    edit_toml(sidecar, {"sha256": None, "spacing_m": [100.0], "columns": columns})
    # Nine decimals of kilonewtons and kilometres.
    assert_allclose(read_record(sidecar)[0].force, record.force, atol=1e-6)
    assert_allclose(read_record(sidecar)[0].position, record.position, atol=1e-6)
    edit_toml(sidecar, {"columns": {**columns, "force_2_N": {"column": "F2", "unit": "N"}}})
    with pytest.raises(InputError, match="found 'N', but the file states 'kN' for 'F2'"):
        read_record(sidecar)


def test_unit_line_that_contradicts_an_own_name_is_refused(tmp_path: Path, record: Record) -> None:
    sidecar = write_record(
        tmp_path / "a.csv", Record(record.time, 60.0, record.position[:1], record.force[:1], (160, 200))
    )
    lines = (tmp_path / "a.csv").read_text().splitlines()
    (tmp_path / "a.csv").write_text("\n".join([lines[0], "s,m,kN", *lines[1:]]))
    edit_toml(sidecar, {"sha256": None})
    with pytest.raises(InputError, match="column 'force_1_N': has the unit 'kN' in the file, which is not that of its"):
        read_record(sidecar)


# Own names in every file format: the same record gives the same samples.


def list_channels(record: Record) -> dict[str, np.ndarray]:
    """Channels of a record by the names of columns."""
    rows = {
        "position_{}_m": record.position,
        "force_{}_N": record.force,
        "contact_height_{}_m": record.contact_height,
        "uplift_{}_m": record.support_uplift,
    }
    named = {name.format(i): row for name, array in rows.items() for i, row in enumerate(array, 1)}
    return {"time_s": record.time, **named}


@pytest.mark.parametrize("name", [name for name in FOREIGN_WRITERS if name != "groups.h5"])
def test_own_names_are_read_from_every_format(name: str, tmp_path: Path, two_pantograph_record: Record) -> None:
    """Fifteen digits in CSV, doubles elsewhere; an interval of a file gives the time to rounding."""
    sidecar = write_record(tmp_path / f"{Path(name).stem}.csv", two_pantograph_record)
    edit_toml(sidecar, {"sha256": None, "file": name})
    FOREIGN_WRITERS[name](tmp_path / name, list_channels(two_pantograph_record))
    record, _ = read_record(sidecar)
    for key in ("time", "position", "force", "contact_height", "support_uplift"):
        expected = getattr(two_pantograph_record, key)
        assert_allclose(getattr(record, key), expected, rtol=1e-12, atol=1e-14, err_msg=key)


def test_stated_layout_is_used_for_a_text_table_only(tmp_path: Path, two_pantograph_record: Record) -> None:
    sidecar = write_record(tmp_path / "a.csv", two_pantograph_record)
    text = (tmp_path / "a.csv").read_text()
    (tmp_path / "a.csv").write_text("train 7,3,1\n" + text)
    edit_toml(sidecar, {"sha256": None, "table": {"header_lines": 1, "separator": ","}})
    assert read_record(sidecar)[0].force.shape == two_pantograph_record.force.shape
    FOREIGN_WRITERS["a.mat"](tmp_path / "a.mat", list_channels(two_pantograph_record))
    edit_toml(sidecar, {"file": "a.mat"})
    with pytest.raises(
        InputError, match=r"key table: states the layout of a text table, but \.mat is not a text table"
    ):
        read_record(sidecar)
