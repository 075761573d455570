"""A folder of records as a system."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.toml_edit import edit_toml
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.table_sidecar import record_digest
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.runs.record_folder import find_other_case, find_record_mismatch, open_record_folder
from pantocheck.conformance.runs.system import Delivered, Errored, Skipped
from pantocheck.conformance.runs.system_choice import choose_system


def test_record_is_found_by_its_case_and_another_case_skipped(case_250: Case, wave: type[Wave], tmp_path: Path) -> None:
    write_record(tmp_path / "a.csv", wave().record(case_250), "another/case")
    assert open_record_folder(tmp_path).run(case_250) == Skipped("there is no record of this case")
    write_record(tmp_path / "deep" / "any name.h5", wave().record(case_250), case_250.id, run={"dt_s": 0.002})
    system = choose_system(f"record:{tmp_path}")
    assert (system.run(case_250).run.dt_s, system.name) == (0.002, tmp_path.name)


@pytest.mark.parametrize("changed", ["a.csv", "a.toml"])
def test_digest_is_that_of_two_files(two_pantograph_case: Case, wave: type[Wave], tmp_path: Path, changed: str) -> None:
    record = wave().record(two_pantograph_case)
    sidecar = write_record(tmp_path / "a.csv", record, two_pantograph_case.id)
    edit_toml(sidecar, {"sha256": None})
    outcome = open_record_folder(tmp_path).run(two_pantograph_case)
    facts = CaseEvaluation(two_pantograph_case, outcome).record_facts
    assert facts.digest == outcome.digest == record_digest(sidecar, tmp_path / "a.csv")
    with (tmp_path / changed).open("a") as file:
        file.write("\n")
    assert record_digest(sidecar, tmp_path / "a.csv") != facts.digest


def test_invalid_folder_is_refused(case_250: Case, wave: type[Wave], tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no sidecar in this folder names a case"):
        open_record_folder(tmp_path)
    with pytest.raises(InputError, match="there is no such folder"):
        open_record_folder(tmp_path / "none")
    for name in ("a.csv", "b.csv"):
        write_record(tmp_path / name, wave().record(case_250), case_250.id)
    with pytest.raises(InputError, match=r"b\.toml and a\.toml have the same case en50318-2002/250"):
        open_record_folder(tmp_path)


@pytest.mark.parametrize("text", ["builtins", "record:", "commands:python", ""])
def test_unknown_system_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="there is no such system"):
        choose_system(text)


@pytest.mark.parametrize(
    ("changes", "difference"),
    [
        ({}, None),
        ({"speed_km_h": 251.2}, None),
        ({"speed_km_h": 248.8}, None),
        ({"speed_km_h": 251.3}, "was made at 251.3 km/h, the case runs at 250 km/h"),
        ({"speed_km_h": 248.7}, "was made at 248.7 km/h, the case runs at 250 km/h"),
        ({"filter_cutoff_Hz": 20.01}, None),
        ({"filter_cutoff_Hz": 19.99}, None),
        ({"filter_cutoff_Hz": 20.03}, "has a filter of 20.03 Hz, the case requires 20 Hz"),
        ({"filter_cutoff_Hz": 19.97}, "has a filter of 19.97 Hz, the case requires 20 Hz"),
        ({"evaluated_m": [240.0, 360.0]}, None),
        ({"evaluated_m": [240.009, 359.991]}, None),
        ({"evaluated_m": [240.02, 360.0]}, "evaluates 240.02 m to 360 m, the case 240 m to 360 m"),
        ({"evaluated_m": [240.0, 359.98]}, "evaluates 240 m to 359.98 m, the case 240 m to 360 m"),
        ({"evaluated_m": [230.0, 360.0]}, "evaluates 230 m to 360 m, the case 240 m to 360 m"),
    ],
)
def test_summary_of_other_runs(case_250: Case, tmp_path: Path, changes: dict[str, Any], difference: str | None) -> None:
    """Half a percent of the speed, a thousandth of the cut-off, a centimetre of the section."""
    path = tmp_path / "a.toml"
    path.write_text((library_folder() / "en50318-2002" / "known-passing-code" / "250.toml").read_text())
    edit_toml(path, changes)
    outcome = open_record_folder(tmp_path).run(case_250)
    assert (
        isinstance(outcome, Delivered) if difference is None else outcome == Errored(f"the summary record {difference}")
    )


@pytest.mark.parametrize(
    ("systems", "name", "version"),
    [
        (({"name": "own code", "version": "3"}, {"name": "own code", "version": "3"}), "own code", "3"),
        (({"name": "own code", "version": "3"}, {"name": "own code", "version": "4"}), None, ""),
        (({"name": "own code", "version": "3"}, None), None, ""),
        ((None, None), None, ""),
    ],
)
def test_system_of_all_sidecars(
    case_250: Case, tmp_path: Path, systems: tuple[dict[str, str] | None, ...], name: str | None, version: str
) -> None:
    """Otherwise the folder gives the name. Other TOML files and records without a case are left out."""
    record = Wave().record(case_250)
    for number, system in enumerate(systems):
        write_record(tmp_path / f"{number}.csv", record, f"own/{number}", system)
    write_record(tmp_path / "without.csv", record)
    (tmp_path / "plan.toml").write_text('system = "builtin"\n')
    (tmp_path / "0-other.toml").write_text("schema = 3\n")
    folder = open_record_folder(tmp_path)
    assert (folder.name, folder.version) == (name or tmp_path.name, version)
    assert [case for case, _ in folder.sidecars] == ["own/0", "own/1"]


# Record against its case, on both sides of every tolerance of speed, section, number of pantographs and spacing.
def test_record_of_another_train_does_not_match(two_pantograph_case: Case, record: Record, case_250: Case) -> None:
    assert find_record_mismatch(two_pantograph_case, record) is None
    # A digest counts to its last character. A record that states none is not refused here.
    digest = case_250.digest
    other = digest[:-1] + ("0" if digest[-1] != "0" else "1")
    assert find_other_case(case_250, digest) is None
    assert find_other_case(case_250, None) is None
    assert f"its case_digest is {other}, that of the case is {digest}" in str(find_other_case(case_250, other))
    system = open_record_folder(Path("en50318-2002/known-passing-code"))
    reason = "the summary record has 1 pantograph, the case has 2"
    assert system.run(two_pantograph_case) == Errored(reason)


@pytest.mark.parametrize(("factor", "matches"), [(0.994, False), (0.996, True), (1.004, True), (1.006, False)])
def test_speed_to_half_a_percent(two_pantograph_case: Case, record: Record, factor: float, matches: bool) -> None:
    found = find_record_mismatch(two_pantograph_case, replace(record, speed=factor * record.speed))
    assert (found is None) is matches
    assert matches or "km/h, the case runs at 250 km/h" in str(found)


@pytest.mark.parametrize("shift", [(0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02), (9.0, 9.0), (-9.0, -9.0)])
def test_another_section_is_another_run(two_pantograph_case: Case, record: Record, shift: tuple[float, float]) -> None:
    start, end = record.evaluated
    found = find_record_mismatch(two_pantograph_case, replace(record, evaluated=(start + shift[0], end + shift[1])))
    assert found.startswith("the record evaluates")


@pytest.mark.parametrize("rows", [[0], [1], [0, 1, 1]])
def test_fewer_or_more_pantographs(two_pantograph_case: Case, record: Record, rows: list[int]) -> None:
    other = replace(
        record, position=record.position[rows], force=record.force[rows], contact_height=record.contact_height[rows]
    )
    found = find_record_mismatch(two_pantograph_case, other)
    number = "1 pantograph" if len(rows) == 1 else f"{len(rows)} pantographs"
    assert found == f"the record has {number}, the case has 2"


@pytest.mark.parametrize("shift", [-50.0, -2.0, 2.0, 50.0])
def test_another_spacing_is_another_train(two_pantograph_case: Case, record: Record, shift: float) -> None:
    found = find_record_mismatch(
        two_pantograph_case, replace(record, position=record.position + np.array([[0.0], [shift]]))
    )
    assert "in the record, 150 m in the case" in found


@pytest.mark.parametrize(("shift", "matches"), [(-0.6, False), (-0.4, True), (0.4, True), (0.6, False)])
@pytest.mark.parametrize("number", [2, 3])
def test_each_distance_in_a_train_of_three_counts(
    two_pantograph_case: Case, record: Record, number: int, shift: float, matches: bool
) -> None:
    """Distances of 150 m and 100 m; one pantograph and all behind it run closer or farther, tolerated to 0.5 m."""
    file = two_pantograph_case.file.model_copy(update={"spacing_m": (150.0, 100.0)})
    case = replace(two_pantograph_case, file=file, pantographs=two_pantograph_case.pantographs[:1] * 3)
    position = record.position[0] - np.array([[0.0], [150.0], [250.0]])
    position[number - 1 :] -= shift
    rows = [0, 1, 1]
    other = replace(record, position=position, force=record.force[rows], contact_height=record.contact_height[rows])
    found = find_record_mismatch(case, other)
    assert (found is None) is matches
    assert matches or f"pantograph {number} runs" in str(found)
