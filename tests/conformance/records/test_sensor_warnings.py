"""Warnings on sums of force sensors: `check`, `assess` and `run` state a missing correction and sensors left out."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from helpers.toml_edit import edit_toml
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.runs.record_folder import RecordFolder

NO_HEAD = "force_2_N is a sum of sensors without head"
LEFT_OUT = "further columns of force are not used: "
HEAD = [{"mass_kg": 6.0, "acceleration": {"column": "a", "unit": "m/s2"}}]


@pytest.fixture
def sidecar(two_pantograph_record: Record, tmp_path: Path) -> Path:
    """Two pantographs: the force of the second one from the sensors S1 and S2, the first one from a column."""
    record = two_pantograph_record
    channels = {
        "t [s]": record.time,
        "x [m]": record.position[0],
        "F1 [N]": record.force[0],
        "S1 [N]": 0.6 * record.force[1],
        "S2 [kN]": 0.4e-3 * record.force[1],
        "a": np.zeros(record.time.size),
    }
    path = write_record(tmp_path / "a.csv", record)
    write_csv_table(tmp_path / "a.csv", [*channels], np.column_stack([*channels.values()]), 9)
    section = [float(record.position[:, 0].max()), float(record.position[:, -1].min())]
    spacing = [float(record.position[0, 0] - record.position[1, 0])]
    return edit_toml(
        path,
        {"sha256": None, "support_position_m": None, "spacing_m": spacing, "evaluated_m": section},
    )


def columns(sensors: list[str], head: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "time_s": {"column": "t [s]"},
        "position_1_m": {"column": "x [m]"},
        "force_1_N": {"column": "F1 [N]"},
        "force_2_N": {"sum": [{"column": name} for name in sensors]} | ({"head": head} if head else {}),
    }


@pytest.mark.parametrize(
    ("sensors", "head", "expected"),
    [
        (["S1 [N]", "S2 [kN]"], HEAD, []),
        (["S1 [N]", "S2 [kN]"], [], [NO_HEAD]),
        (["S1 [N]"], HEAD, [f"{LEFT_OUT}S2 [kN]"]),
        (["S1 [N]"], [], [NO_HEAD, f"{LEFT_OUT}S2 [kN]"]),
    ],
)
def test_incomplete_sum_is_warned_of(sensors: list[str], head: Any, expected: list[str], sidecar: Path) -> None:
    edit_toml(sidecar, {"columns": columns(sensors, head)})
    checked = CliRunner().invoke(app, ["check", str(sidecar)])
    assert checked.exit_code == 0
    lines = " ".join(checked.stdout.split()).split("warning: ")[1:]
    profile = load_profile("acceptance-ac")
    warnings = load_assessed_record(sidecar, profile, LineTable()).warnings
    for shown in (lines, [text for text in warnings if "sensors" in text]):
        assert len(shown) == len(expected)
        assert all(text in line for text, line in zip(expected, shown, strict=True))


def test_run_of_a_case_warns_of_a_sum_without_head(sidecar: Path, case_250: Case) -> None:
    edit_toml(sidecar, {"columns": columns(["S1 [N]", "S2 [kN]"], [])})
    outcome = RecordFolder("logger", "", ((case_250.id, sidecar),)).run(case_250)
    assert [text.startswith(NO_HEAD) for text in outcome.warnings] == [True]
