"""Static records: units, positions and data of the sidecar; every refusal names the rows."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.static_records import read_unequal_line, write_static_record
from pantocheck.conformance.comparison.static_record import read_static_record
from pantocheck.conformance.core.hdf5_table import write_hdf5_table
from pantocheck.conformance.core.input_error import InputError

GEOMETRY = read_unequal_line().geometry
COLUMNS = {
    "position_m": np.array([30.0, 10.0, 20.0]),
    "elasticity_mm_N": np.array([0.5, 0.4, np.nan]),
    "contact_wire_height_m": np.array([-0.01, 0.0, -0.02]),
}


def test_rows_are_sorted_and_converted(tmp_path: Path) -> None:
    """Chainage from 100 km, heights from the rail; decimal conversions, rounded once."""
    columns = {
        "position_km": 100 + COLUMNS["position_m"] / 1000,
        "elasticity_mm_kN": 1000 * COLUMNS["elasticity_mm_N"],
        "contact_wire_height_mm": 5300 + 1000 * COLUMNS["contact_wire_height_m"],
    }
    record = read_static_record(write_static_record(tmp_path, columns, line_start_m=100e3, datum_m=5.3), GEOMETRY)
    assert record.position == pytest.approx([10, 20, 30], abs=1e-9)
    assert record.row.tolist() == [2, 3, 1]
    assert record.values["elasticity"] == pytest.approx([4e-4, np.nan, 5e-4], nan_ok=True, rel=1e-12)
    assert record.values["contact_wire_height"] == pytest.approx([0.0, -0.02, -0.01], abs=1e-12)
    columns = COLUMNS | {"position_m": 1000 - COLUMNS["position_m"]}
    path = write_static_record(tmp_path, columns, line_start_m=1000.0, positions="decreasing")
    record = read_static_record(path, GEOMETRY)
    assert record.position.tolist() == [10.0, 20.0, 30.0]
    assert record.row.tolist() == [2, 3, 1]


def test_tables_of_spreadsheets_hdf5_and_other_programs_are_read(tmp_path: Path) -> None:
    path = write_static_record(tmp_path, COLUMNS)
    text = path.read_text().replace(",", ";").replace(".", ",").replace("\n", "\r\n")
    path.write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert read_static_record(path, GEOMETRY).position.tolist() == [10.0, 20.0, 30.0]
    write_static_record(tmp_path, COLUMNS, file="measured.h5")
    write_hdf5_table(tmp_path / "measured.h5", {}, {name: values.tolist() for name, values in COLUMNS.items()})
    record = read_static_record(tmp_path / "measured.h5", GEOMETRY)
    assert record.position.tolist() == [10.0, 20.0, 30.0]
    assert record.values["elasticity"] == pytest.approx([4e-4, np.nan, 5e-4], nan_ok=True, rel=1e-12)
    # Heights in a column with a free name; a column that the sidecar does not name is ignored.
    columns = {"x": COLUMNS["position_m"], "z": 1000 * COLUMNS["contact_wire_height_m"], "note": np.ones(3)}
    names = {"position_m": "x", "contact_wire_height_mm": "z"}
    layout = {"separator": ",", "decimal": "."}
    record = read_static_record(write_static_record(tmp_path, columns, columns=names, table=layout), GEOMETRY)
    assert record.position.tolist() == [10.0, 20.0, 30.0]
    assert record.values["contact_wire_height"] == pytest.approx([0.0, -0.02, -0.01])


@pytest.mark.parametrize(
    ("columns", "sidecar", "message"),
    [
        ({"position_m": np.array([30.0, -1.0, 400.0])}, {}, "rows 2, 3: the position is not on the line: -1 m, 400 m"),
        ({"position_m": np.array([30.0, np.nan, 20.0])}, {}, "row 2: the position is missing"),
        ({"elasticity_mm_N": np.array([0.5, 0.0, -0.1])}, {}, "rows 2, 3: the elasticity is not positive"),
        ({"contact_wire_height_m": np.array([0, np.inf, 0])}, {}, "row 2: the contact wire height is infinite"),
        ({"elasticity_mm_N": np.full(3, np.nan)}, {}, "elasticity: the column holds no value"),
        ({"elasticity": np.ones(3)}, {}, r"'elasticity': unknown column.\n  .*did you mean elasticity_mm_N"),
        ({"elasticity_N_mm": np.ones(3)}, {}, "'elasticity_N_mm': unknown column"),
        ({"elasticity_m_N": np.ones(3)}, {}, "'elasticity_m_N': repeats elasticity"),
        ({}, {"force_N": None}, "key force_N: missing"),
        ({}, {"force_N": [100.0, 60.0]}, "key force_N: the second force is not greater"),
        ({}, {"force_N": [60.0, 60.0]}, "key force_N: the second force is not greater"),
        ({}, {"columns": {"x" * 90: "position_m"}}, "key columns.x{80}: unknown column"),
        ({}, {"evaluated_spans": [2, 7]}, "key evaluated_spans: span 7 does not exist"),
        ({}, {"evaluated_spans": [3, 2]}, "key evaluated_spans: .* are not a first and a last span"),
        ({}, {"largest_distance_m": 60.0}, "60 m is longer than the shortest span of 54 m"),
        ({}, {"file": "../measured.csv"}, "key file: found the path"),
        ({}, {"sha256": "0" * 64}, "does not agree with sha256"),
    ],
)
def test_record_that_cannot_be_compared_is_refused(
    tmp_path: Path, columns: dict[str, Any], sidecar: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        read_static_record(write_static_record(tmp_path, COLUMNS | columns, **sidecar), GEOMETRY)


@pytest.mark.parametrize(
    ("columns", "sidecar", "count"),
    [
        ({"position_m": np.array([1, 2, np.nan]), "elasticity_mm_N": np.array([-1, 1, np.inf])}, {"force_N": None}, 4),
        ({"position_m": np.array([1.0, 500.0, 2.0])}, {"evaluated_spans": [1, 9], "largest_distance_m": 99.0}, 3),
    ],
)
def test_all_problems_of_rows_and_sidecar_are_named_at_once(
    tmp_path: Path, columns: dict[str, Any], sidecar: dict[str, Any], count: int
) -> None:
    with pytest.raises(InputError) as caught:
        read_static_record(write_static_record(tmp_path, COLUMNS | columns, **sidecar), GEOMETRY)
    assert len(caught.value.problems) == count


def test_table_needs_positions_and_values_and_for_elasticities_a_force(tmp_path: Path) -> None:
    for name, message in (("position_m", "has no measured value"), ("elasticity_mm_N", "has no positions")):
        with pytest.raises(InputError, match=message):
            read_static_record(write_static_record(tmp_path, {name: COLUMNS[name]}), GEOMETRY)
    columns = {name: COLUMNS[name] for name in ("position_m", "contact_wire_height_m")}
    record = read_static_record(write_static_record(tmp_path, columns, force_N=None), GEOMETRY)
    assert list(record.values) == ["contact_wire_height"]
