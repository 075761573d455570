"""Contact force from sensors below a moving head: the inertia of the head is added again."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from helpers.command_line import pantocheck
from helpers.short_cases import shorten_case
from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.runs.case_run import list_start_forces, run_passage
from pantocheck.conformance.runs.record_folder import RecordFolder
from pantocheck.conformance.runs.uplift_tuning import build_pantographs
from pantocheck.model import Pantograph


def spring_force(pantograph: Pantograph, record: Record, row: int) -> np.ndarray:
    """Force of the frame on the head [N], from the recorded motion of the head only.

    The masses below the head move with the head as given motion; the second formulation here is an adaptive
    Runge-Kutta method on M z'' + C z' + K z = f with the row of the head left out.
    """
    head = int(np.argmax(pantograph.head))
    free = np.flatnonzero(np.arange(pantograph.head.size) != head)
    motion = CubicSpline(record.time, record.contact_height[row])
    mass, damping, stiffness = pantograph.mass, pantograph.damping, pantograph.stiffness
    inner = np.ix_(free, free)

    def derivative(t: float, state: np.ndarray) -> np.ndarray:
        z, v = np.split(state, 2)
        load = pantograph.force[free] - damping[free, head] * motion(t, 1) - stiffness[free, head] * motion(t)
        return np.concatenate([v, np.linalg.solve(mass[inner], load - damping[inner] @ v - stiffness[inner] @ z)])

    start_load = pantograph.force[free] - stiffness[free, head] * motion(record.time[0])
    start = np.concatenate([np.linalg.solve(stiffness[inner], start_load), np.zeros(free.size)])
    span = (record.time[0], record.time[-1])
    z, v = np.split(solve_ivp(derivative, span, start, t_eval=record.time, rtol=1e-7, atol=1e-9).y, 2)
    t = record.time
    own = damping[head, head] * motion(t, 1) + stiffness[head, head] * motion(t)
    return np.asarray(pantograph.force[head] - damping[head, free] @ v - stiffness[head, free] @ z - own)


def test_head_inertia_recovers_the_contact_force_up_to_20_hz(tmp_path: Path, case_250: Case) -> None:
    """Four sensors with unequal shares, and two accelerometers, one of which is mounted upside down: within 2 %."""
    # The standard deviation of the sensors alone is more than 30 % too small: the correction is needed.
    case = shorten_case(case_250, 250.0, 0.5, 2)
    steps = case.file.discretisation.model_copy(update={"time_step_s": 0.002})
    case = replace(case, file=case.file.model_copy(update={"discretisation": steps}))
    line = discretise_line(case.line, steps.element_m)
    run = run_passage(case, line, steps, list_start_forces(case))
    record = run.record
    pantographs = build_pantographs(case, line, run.uplift_forces)
    channels = {"time_s": record.time, "x": record.position[0]}
    columns: dict[str, Any] = {"time_s": {"column": "time_s"}, "position_1_m": {"column": "x", "unit": "m"}}
    for row, pantograph in enumerate(pantographs):
        force = spring_force(pantograph, record, row)
        acceleration = CubicSpline(record.time, record.contact_height[row])(record.time, 2)
        channels |= {f"S{row}{i}": share * force / 1000 for i, share in enumerate((0.3, 0.2, 0.27, 0.23))}
        channels |= {f"a{row}l": acceleration / 9.80665, f"a{row}r": -acceleration}
        head_mass = float(pantograph.head @ pantograph.mass @ pantograph.head)
        columns[f"force_{row + 1}_N"] = {
            "sum": [{"column": f"S{row}{i}", "unit": "kN"} for i in range(4)],
            "head": [
                {"mass_kg": 0.6 * head_mass, "acceleration": {"column": f"a{row}l", "unit": "g"}},
                {"mass_kg": 0.4 * head_mass, "acceleration": {"column": f"a{row}r", "unit": "m/s2", "scale": -1.0}},
            ],
        }
    sidecar = write_record(tmp_path / "a.csv", record)
    write_csv_table(tmp_path / "a.csv", list(channels), np.column_stack(list(channels.values())), 9)
    own = {"sha256": None, "spacing_m": [60.0], "support_position_m": None, "columns": columns}
    own["columns"]["time_s"]["unit"] = "s"
    edit_toml(sidecar, own)
    corrected = read_record(sidecar)[0]
    without = {key: {**value, "head": []} if "sum" in value else value for key, value in columns.items()}
    edit_toml(sidecar, {"columns": without})
    plain = read_record(sidecar)[0]
    low_pass = Filter()
    for number in (1, 2):
        true, found, bare = (
            RecordSignals(item, low_pass).pantographs[number].graded for item in (record, corrected, plain)
        )
        assert np.abs(found - true).max() < 0.02 * true.mean()
        assert found.std() == pytest.approx(true.std(), rel=0.02)
        assert bare.std() < 0.7 * true.std()


# Warnings on sums of force sensors: a missing correction, and sensors that are left out.


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
    keys = {"sha256": None, "support_position_m": None, "spacing_m": spacing, "evaluated_m": section}
    return edit_toml(path, keys)


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
    checked = pantocheck("check", sidecar)
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
