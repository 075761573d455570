"""Exported modes: a table and a universal file hold the modes of modes.json."""

import csv
from pathlib import Path

import numpy as np
import pytest
import pyuff

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.mode_export import select_mode_writer
from pantocheck.conformance.results.identified_modes import Mode, SensorShape

pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")  # pyuff leaves files to the garbage collector

FIRST = Mode(
    frequency_Hz=0.87654321,
    frequency_std_Hz=1e-5,
    damping_ratio=0.0056,
    damping_ratio_std=2e-6,
    group=1,
    record="north, 40 kg",
    sensor_shape=(
        SensorShape(sensor=1, wire="CW", position_m=195.75, re=1.0, im=0.0, std=1e-4),
        SensorShape(sensor=3, wire="MW", position_m=212.25, re=-0.25, im=0.03125, std=2e-4),
    ),
)
SECOND = FIRST.model_copy(
    update={
        "frequency_Hz": 1.75,
        "group": None,
        "lateral": True,
        "sensor_shape": (SensorShape(sensor=2, wire="CW", position_m=171.0, re=1.0, im=0.0),),
    }
)


def read_universal_file(path: Path) -> list[dict[str, object]]:
    return list(pyuff.UFF(str(path)).read_sets())


def test_universal_file_holds_nodes_and_complex_modes(tmp_path: Path) -> None:
    """Read back by pyuff; the format keeps six digits. The eigenvalue gives frequency and damping ratio back."""
    select_mode_writer(tmp_path / "modes.uff")((FIRST, SECOND), tmp_path / "modes.uff")
    units, nodes, *modes = read_universal_file(tmp_path / "modes.uff")
    assert (units["type"], units["length"], units["force"]) == (164, 1.0, 1.0)
    assert nodes["type"] == 15
    np.testing.assert_array_equal(nodes["node_nums"], [1, 2, 3])
    np.testing.assert_allclose(nodes["x"], [195.75, 171.0, 212.25])
    assert [(mode["type"], mode["analysis_type"], mode["mode_n"]) for mode in modes] == [(55, 3, 1), (55, 3, 2)]
    for mode, expected in zip(modes, (FIRST, SECOND), strict=True):
        eigenvalue = complex(mode["eig"])  # type: ignore[call-overload]
        assert abs(eigenvalue) / (2 * np.pi) == pytest.approx(expected.frequency_Hz, rel=1e-5)
        assert -eigenvalue.real / abs(eigenvalue) == pytest.approx(expected.damping_ratio, rel=2e-5)
    np.testing.assert_array_equal(modes[0]["node_nums"], [1, 3])
    np.testing.assert_allclose(modes[0]["r3"], [1.0, -0.25 + 0.03125j], rtol=1e-5)
    np.testing.assert_array_equal(modes[0]["r1"], 0)
    np.testing.assert_array_equal(modes[1]["node_nums"], [2])


def test_nodes_are_numbered_anew_by_sensor_and_wire_or_left_out(tmp_path: Path) -> None:
    """Two lines may both have a sensor 1. Their nodes are numbered anew, in the order of sensor and wire."""
    moved = SECOND.model_copy(
        update={"sensor_shape": (SensorShape(sensor=1, wire="CW", position_m=33.0, re=1.0, im=0.0),)}
    )
    select_mode_writer(tmp_path / "modes.unv")((FIRST, moved), tmp_path / "modes.unv")
    _, nodes, first, second = read_universal_file(tmp_path / "modes.unv")
    np.testing.assert_allclose(nodes["x"], [33.0, 195.75, 212.25])
    np.testing.assert_array_equal(first["node_nums"], [2, 3])
    np.testing.assert_array_equal(second["node_nums"], [1])
    unknown = SECOND.model_copy(update={"sensor_shape": (SensorShape(sensor=2, re=1.0, im=0.0),)})
    select_mode_writer(tmp_path / "modes.uff")((FIRST, unknown), tmp_path / "modes.uff")
    assert [data_set["type"] for data_set in read_universal_file(tmp_path / "modes.uff")] == [164, 55, 55]


def test_table_has_a_row_per_mode_and_three_columns_per_sensor(tmp_path: Path) -> None:
    """A mode has empty cells at the sensors of another line."""
    select_mode_writer(tmp_path / "modes.csv")((FIRST, SECOND), tmp_path / "modes.csv")
    with (tmp_path / "modes.csv").open(encoding="utf-8", newline="") as file:
        first, second = csv.DictReader(file)
    assert float(first["frequency_Hz"]) == 0.87654321
    assert (first["record"], first["group"], first["lateral"]) == ("north, 40 kg", "1", "no")
    assert (second["group"], second["lateral"], second["error"]) == ("", "yes", "")
    assert [first[f"sensor_3_MW_212.25_m_{part}"] for part in ("re", "im", "std")] == ["-0.25", "0.03125", "0.0002"]
    assert [second[f"sensor_3_MW_212.25_m_{part}"] for part in ("re", "im", "std")] == ["", "", ""]
    assert (second["sensor_2_CW_171_m_re"], second["sensor_2_CW_171_m_std"]) == ("1.0", "")


def test_other_suffixes_are_refused() -> None:
    with pytest.raises(InputError, match=r"\.csv, \.uff, \.unv"):
        select_mode_writer(Path("modes.xlsx"))
