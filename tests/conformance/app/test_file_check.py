"""Check of input files: the kind is recognised, valid files give one line, and all problems of all files are listed."""

import shutil
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.case_fixtures import EditedCase
from helpers.command_line import pantocheck
from helpers.drop_records import build_drop_record
from helpers.line_table_files import change_cell, export_tables
from helpers.listed_spans import list_spans
from helpers.static_records import read_unequal_line, write_static_record
from helpers.toml_edit import edit_toml, write_toml
from pantocheck.conformance.app.file_check import recognise_json, recognise_toml
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.drops.drop_writing import write_drop_csv, write_drop_sidecar
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record

check = partial(pantocheck, "check", COLUMNS="400")


def test_kinds_of_the_library_are_recognised() -> None:
    for name, kind in {
        "en50318-2002/250.toml": "case", "en50318-2002/line.toml": "line", "en50318-2018/pantograph.toml": "pantograph",
        "mass-drop-line/line.toml": "line", "vovan2015/damping/updated.toml": "damping",
        "profiles/line-test.toml": "profile", "en50318-2002/known-passing-code/250.toml": "summary",
        "converged/en50318-2002/250.toml": "converged", "model_uncertainty.toml": "model-uncertainty",
        "resolving-power/en50318-2002/250.toml": "resolving-power",
        "conditions/en50318-2002/250.toml": "conditions",
    }.items():  # fmt: skip
        assert recognise_toml(read_toml(library_folder() / name, "file"), name) == kind


def test_named_rule_of_a_pantograph_is_checked(tmp_path: Path) -> None:
    path = tmp_path / "pantograph.toml"
    shutil.copy(library_folder() / "pantographs" / "dsa250.toml", path)
    edit_toml(path, {"force_law": {"kind": "mean_force_rule", "profile": "acceptance-ac"}})
    assert check(path).exit_code == 0
    edit_toml(path, {"force_law.profile": "acceptance-dc"})
    result = check(path)
    assert result.exit_code == 2
    assert "key force_law.profile: no profile 'acceptance-dc' of the library has a formula" in result.stderr


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ('[[limit]]\nquantity = "mean_force_N"\nupper = 130.0\n', "limits"),
        ('system = "builtin"\ncases = ["en50318-2002/250"]\n', "plan"),
        ('schema = "pantocheck.record/1"\nspeed_km_h = 250.0\n', "record"),
        ('schema = "pantocheck.summary/1"\nspeed_km_h = 250.0\n', "summary"),
        ('schema = "pantocheck.static/1"\nforce_N = [100.0]\n', "static"),
        ("[record]\nsampling_rate_hz = 100.0\n[[channel]]\ncolumn = 1\n", "mass-drop"),
        ('id = "own/a"\nlin = "line.toml"\nspeed_kmh = 250.0\n', "case"),
        ('title = "T"\n[geometry]\nspan_m = 60.0\n[damping]\n', "line"),
    ],
)
def test_kind_of_an_incomplete_file_is_recognised(text: str, kind: str, tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(text)
    assert recognise_toml(read_toml(tmp_path / "a.toml", "file"), "a.toml") == kind


def test_valid_files_give_one_line_each(edited_case: EditedCase) -> None:
    folder = edited_case("250.toml", {}).parent
    result = check(folder / "250.toml", folder / "line.toml", folder / "pantograph.toml")
    assert (result.exit_code, result.stderr) == (0, "")
    assert [line.removeprefix(f"{folder}/") for line in result.stdout.splitlines()[1:]] == [
        "250.toml: valid case en50318-2002/250: 250 km/h, 1 pantograph; line: 10 spans, 600 m",
        "line.toml: valid line: 10 spans, 600 m",
        "pantograph.toml: valid pantograph file",
    ]


def test_speed_near_the_wave_speed_is_warned_of_and_positions_are_checked(edited_case: EditedCase) -> None:
    """The waves of the contact wire run at 438 km/h; a warning starts at 70 % of it."""
    assert "warning" not in check(edited_case("250.toml", {"speed_km_h": 306.0})).stdout
    result = check(edited_case("250.toml", {"speed_km_h": 307.0}))
    assert result.exit_code == 0
    assert "\n  warning: speed: 307 km/h is 70.1 % of the wave speed" in result.stdout
    result = check(edited_case("250.toml", {"start_m": 240.0, "run_out_m": 240.0}))
    assert "key start_m: the last pantograph starts at 240 m" in result.stderr
    assert "key run_out_m: the first pantograph would run to 600 m" in result.stderr


@pytest.mark.parametrize("name", ["250.toml", "limits.toml"])
def test_limit_that_does_not_count_is_warned_of(name: str, edited_case: EditedCase) -> None:
    limit = {"quantity": "std_force_N", "upper": 60.0}
    path = edited_case("250.toml", {}).with_name(name)
    for source, warned in ({}, True), ({"trust": "primary", "source": "requirement 12"}, False):
        tables = read_toml(path, "file") if path.is_file() else {}
        write_toml(path, tables | {"limit": [limit | source]})
        result = check(path)
        assert result.exit_code == 0
        assert ("\n  warning: the limit of std_force_N does not count. Give it trust" in result.stdout) is warned


def test_problems_of_all_files_of_a_case_are_listed(edited_case: EditedCase) -> None:
    path = edited_case("250.toml", {"speed_km_h": 900.0, "filter.order": 5})
    edit_toml(path.with_name("line.toml"), {"geometry.span_m": 600.0, "messenger_wire.number": 2})
    edit_toml(path.with_name("pantograph.toml"), {"chain.masses_kg": [-1.0, 7.0]})
    result = check(path)
    assert result.exit_code == 2
    assert result.stdout == "5 problems in 1 of 1 file\n"
    messages = result.stderr.splitlines()
    assert [line.partition(":")[0] for line in messages[::2]] == [
        "case '250.toml', key speed_km_h", "case '250.toml', key filter.order", "line 'line.toml', key geometry.span_m",
        "line 'line.toml', key messenger_wire.number", "pantograph 'pantograph.toml', key chain.masses_kg[1]",
    ]  # fmt: skip


def test_faulty_files_and_empty_folders_hide_no_valid_file(edited_case: EditedCase, tmp_path: Path) -> None:
    folder = edited_case("line.toml", {"contact_wire.tension_N": -1.0}).parent
    result = check(folder / "pantograph.toml", folder / "none.toml", folder / "line.toml")
    assert result.exit_code == 2
    assert result.stdout.splitlines() == [
        "2 problems in 2 of 3 files",
        f"{folder}/pantograph.toml: valid pantograph file",
    ]
    assert "file 'none.toml': cannot be read" in result.stderr
    assert "key contact_wire.tension_N: -1 must be at least 500.0" in result.stderr
    assert "Allowed: a number at least 500, at most 200000." in result.stderr
    folder = edited_case("250.toml", {}).parent
    (tmp_path / "empty").mkdir()
    (tmp_path / "empty" / "other.csv").write_text("name,price\na,1\n")
    result = check(tmp_path / "empty", folder / "line.toml")
    assert result.exit_code == 2
    assert result.stdout.splitlines() == [
        "1 problem in 1 of 2 files",
        f"{folder}/line.toml: valid line: 10 spans, 600 m",
    ]
    assert "there is no input file in it" in result.stderr


def test_folder_of_records_is_checked(tmp_path: Path, two_pantograph_record: Record) -> None:
    write_record(tmp_path / "a.csv", two_pantograph_record)
    write_record(tmp_path / "b.h5", two_pantograph_record)
    (tmp_path / "pyproject.toml").write_text("[tool.other]\n")
    result = check(tmp_path)
    assert result.exit_code == 0
    assert result.stdout.splitlines() == [
        "2 files checked, all valid",
        *(
            f"{tmp_path}/{name}.toml: valid record: 400 samples of 2 pantographs in {name}.{suffix}, 216 km/h"
            for name, suffix in (("a", "csv"), ("b", "h5"))
        ),
    ]
    edit_toml(tmp_path / "a.toml", {"spacing_m": [1.0, 2.0], "pantographs": 0})
    (tmp_path / "b.h5").unlink()
    result = check(tmp_path)
    assert result.exit_code == 2
    assert "key pantographs: 0 must be at least 1" in result.stderr
    assert "record 'b.h5': cannot be read" in result.stderr


def test_record_that_cannot_be_assessed_gives_a_warning(tmp_path: Path, two_pantograph_record: Record) -> None:
    """The second pantograph runs behind the first one, so that it ends before a section at the end of its track."""
    write_record(tmp_path / "a.csv", two_pantograph_record)
    first, second = two_pantograph_record.position
    edit_toml(tmp_path / "a.toml", {"evaluated_m": [float(first[0]), float(first[-1])]})
    result = check(tmp_path / "a.toml")
    assert result.exit_code == 0
    assert f"criteria of pantograph 2: its record from {second[0]:g} to {second[-1]:g} m does not" in result.stdout
    assert "criteria of pantograph 1" not in result.stdout
    edit_toml(tmp_path / "a.toml", {"evaluated_m": None})
    warning = "warning: `assess` skips every criterion: the analysis section is not stated"
    assert warning in check(tmp_path / "a.toml").stdout


def test_mass_drop_record_is_checked(tmp_path: Path) -> None:
    write_drop_csv(build_drop_record(), tmp_path / "drop.csv")
    write_drop_sidecar(build_drop_record(), tmp_path / "drop.toml")
    for path in (tmp_path / "drop.csv", tmp_path / "drop.toml"):
        assert "valid mass-drop record: 1 run in drop.csv" in check(path).stdout
    shutil.copy(tmp_path / "drop.csv", tmp_path / "drop.txt")
    edit_toml(tmp_path / "drop.toml", {"file": "drop.txt"})
    assert "valid mass-drop record: 1 run in drop.txt" in check(tmp_path / "drop.toml").stdout
    assert "key file: found 'drop.txt', but the record is 'drop.csv'" in check(tmp_path / "drop.csv").stderr
    changes = {"record.sampling_rate_hz": -1.0, "channel.0.column": 0, "drop.mas_kg": 40.0, "file": None}
    edit_toml(tmp_path / "drop.toml", changes)
    result = check(tmp_path / "drop.csv")
    assert result.exit_code == 2
    assert "sidecar 'drop.toml', key drop.mas_kg: unknown key.\n  Did you mean mass_kg ?" in result.stderr
    assert "key record.sampling_rate_hz: -1 must be greater than 0" in result.stderr
    assert "key channel[1].column: 0 must be at least 1" in result.stderr


def test_kind_is_recognised_or_stated(tmp_path: Path) -> None:
    (tmp_path / "modes.json").write_text("[{}]")
    result = check(tmp_path / "modes.json")
    assert result.exit_code == 2
    assert "file 'modes.json', key [1].frequency_Hz: field required" in result.stderr
    shutil.copy(library_folder() / "en50318-2002" / "line.toml", tmp_path / "a.toml")
    assert check(tmp_path / "a.toml", "--kind", "line").exit_code == 0
    assert "unknown key" in check(tmp_path / "a.toml", "--kind", "pantograph").stderr
    assert "Did you mean line or limits ?" in check(tmp_path / "a.toml", "--kind", "lime").stderr
    with pytest.raises(InputError, match="--kind with one of case, line, pantograph"):
        recognise_toml({"tool": {}}, "a.toml")
    with pytest.raises(InputError, match=r"Known are pantocheck\.results/1"):
        recognise_json({"schema": "other"}, "a.json")


@pytest.mark.parametrize("name", [".venv", "env", "build", "node_modules", "__pycache__"])
def test_folders_of_tools_are_skipped(name: str, tmp_path: Path) -> None:
    line = library_folder() / "en50318-2002" / "line.toml"
    (tmp_path / "lines").mkdir()
    (tmp_path / name / "lib").mkdir(parents=True)
    (tmp_path / name / "lib" / "plan.toml").write_text("cases = 3\n")
    (tmp_path / "env" / "pyvenv.cfg").parent.mkdir(exist_ok=True)
    (tmp_path / "env" / "pyvenv.cfg").write_text("")
    shutil.copy(line, tmp_path / "lines" / "line.toml")
    result = check(tmp_path)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.splitlines()[:1] == ["1 file checked, all valid"]
    assert check(tmp_path / name).exit_code == 2


@pytest.mark.parametrize("suffix", [".csv", ".toml"])
def test_static_record_is_checked_with_its_table(tmp_path: Path, suffix: str) -> None:
    columns = {"position_m": np.array([1.0, 2.0]), "elasticity_mm_N": np.array([0.4, 0.5])}
    table = write_static_record(tmp_path, columns)
    result = check(table.with_suffix(suffix))
    assert result.exit_code == 0, result.output
    assert "static record: 2 positions with elasticity in measured.csv" in result.output
    write_static_record(tmp_path, columns | {"elasticity_mm_N": np.array([0.4, -0.5])}, force_N=None)
    result = check(table.with_suffix(suffix))
    assert result.exit_code == 2
    assert "2 problems in 1 of 1 file" in result.output


@pytest.mark.parametrize("names", [(".",), ("supports.csv", "droppers.csv")])
def test_tables_of_a_line_are_recognised_and_checked(tmp_path: Path, names: tuple[str, ...]) -> None:
    """By their names, and in a folder."""
    supports, droppers = export_tables(tmp_path, read_unequal_line())
    result = check(*(tmp_path / name for name in names))
    assert result.exit_code == 0, result.output
    assert "table of 7 supports and ends" in result.output
    assert "table of 53 droppers" in result.output
    change_cell(supports, 3, "span_m", "58 m")
    change_cell(supports, 4, "encumbrance_m", "?")
    change_cell(droppers, 9, "x_m", "x")
    result = check(*(tmp_path / name for name in names))
    assert result.exit_code == 2
    for place in ("row 3, column 'span_m'", "row 4, column 'encumbrance_m'", "row 9, column 'x_m'"):
        assert place in result.output


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"geometry.encumbrance_m": 0.05}, "dropper 5: the wires cross at the dropper at x = "),
        ({"droppers.presag_m": [0.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 0.0]}, "a dropper cannot push"),
    ],
)
def test_line_without_equilibrium_is_refused(changes: dict[str, Any], message: str, edited_case: EditedCase) -> None:
    path = edited_case("line.toml", changes)
    for file in (path, path.with_name("line.toml")):
        result = check(file)
        assert result.exit_code == 2
        assert message in result.stderr


def test_dropper_that_would_push_is_named(edited_case: EditedCase) -> None:
    """The second dropper of span 4 holds the wire 0.3 m too high, so that the first one would have to push."""
    path = edited_case("line.toml", {}).with_name("line.toml")
    tables = list_spans(read_toml(path, "line"))
    own = {"x_m": tables["droppers"]["x_m"], "contact_wire_height_m": [0.0, 0.3, *[0.0] * 7]}
    tables["geometry"]["span_list"] = [{"length_m": 60.0} | ({"droppers": own} if n == 4 else {}) for n in range(1, 6)]
    write_toml(path, tables)
    result = check(path)
    assert result.exit_code == 2
    assert "is impossible at rest: span 4, dropper 1: the dropper at x = 185 m would have to push" in result.stderr
    assert "contact_wire_height_m of supports and droppers count from the same datum" in result.stderr


def test_all_wrong_columns_of_a_record_are_listed(tmp_path: Path, two_pantograph_record: Record) -> None:
    sidecar = write_record(tmp_path / "a.csv", two_pantograph_record)
    edit_toml(sidecar, {"sha256": None})
    text = (tmp_path / "a.csv").read_text()
    head, first, rest = text.split("\n", 2)
    cells = first.split(",")
    cells[head.split(",").index("force_2_N")] = "1e300"
    head = head.replace("force_1_N", "force_1_lbf").replace("uplift_2_m", "lift_2_m")
    (tmp_path / "a.csv").write_text("\n".join([head, ",".join(cells), rest]))
    result = check(sidecar)
    assert result.exit_code == 2
    for place in ("column 'force_1_lbf': unknown column", "column 'lift_2_m': unknown column"):
        assert place in result.stderr
    assert "force_2_N: sample 1 has the impossible value 1e+300" in result.stderr
    assert "3 problems in 1 of 1 file" in result.stdout
