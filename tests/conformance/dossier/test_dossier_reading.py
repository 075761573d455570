"""Dossiers: every problem of the dossier and of the files that it names is reported with its key."""

from pathlib import Path
from typing import Any

import pytest

from helpers.command_line import pantocheck
from helpers.example_dossier import EXAMPLE, copy_example
from helpers.toml_edit import edit_toml
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.dossier.dossier_reading import read_dossier

OTHER = {"name": "example line", "file": "line.toml"}


@pytest.mark.parametrize(
    ("changes", "key", "found"),
    [
        ({"line.0.file": "missing.toml"}, "line[1].file", "there is no file 'missing.toml'"),
        ({"line.0.file": "pantograph.toml"}, "line[1].file", "missing"),
        ({"pantograph.0.responses.1": "measured/none.csv"}, "pantograph[1].responses[2]", "there is no file"),
        ({"line.0.statics": "measured/none.csv"}, "line[1].statics", "there is no file"),
        ({"pair.1.measured.record": "none.csv"}, "pair[2].measured.record", "there is no file"),
        ({"pair.1.simulated.case": "none.toml"}, "pair[2].simulated.case", "No such file"),
        ({"pair.1.simulated.case": "en50318-2018/ac-simple/static"}, "pair[2].simulated.case", "one case with a train"),
        ({"reference.cases": ["en50318-2002/260"]}, "reference.cases", "there is no case with this id"),
        ({"line.1": OTHER}, "line[2].name", "occurs 2 times"),
        ({"pair.0.measured.line": "exampel line"}, "pair[1].measured.line", "there is no line"),
        ({"validity.pantographs": ["other"]}, "validity.pantographs[1]", "there is no pantograph"),
        ({"validity.speed_km_h": [200.0, 160.0]}, "validity.speed_km_h", "value, 200, is above the second, 160"),
        ({"line.0.tolerance.source": None}, "line[1].tolerance.source", "missing, although the trust"),
        ({"line.0.tolerance.elasticity_pct": 1e6}, "line[1].tolerance.elasticity_pct", "10000"),
        ({"pantograph.0.limit.0.source": None}, "pantograph[1].limit[1].source", "missing, although the trust"),
        ({"line_test.tolerance.0": {"quantity": "mean_force_N", "upper": 1}}, "line_test.tolerance[1]", "a tolerance"),
        ({"required": ["line_tests"]}, "required", "line_tests"),
        ({"pair.0.simulated": {"case": "run-160.toml"}}, "pair[1].simulated", "direction"),
        ({"sytem": "builtin"}, "sytem", "unknown key"),
    ],
)
def test_problem_is_reported_with_its_key(tmp_path: Path, changes: dict[str, Any], key: str, found: str) -> None:
    with pytest.raises(InputError) as error:
        read_dossier(copy_example(tmp_path, changes))
    messages = [problem.message for problem in error.value.problems]
    assert any(key in message and found in message for message in messages), messages


def test_problems_of_several_files_and_of_the_system_are_reported(tmp_path: Path) -> None:
    path = copy_example(tmp_path, {"line.0.statics": "none.csv", "reference.cases": ["none/*"]})
    edit_toml(tmp_path / "pantograph.toml", {"chain.masses_kg": [1.0]})
    with pytest.raises(InputError) as error:
        read_dossier(path)
    text = str(error.value)
    for key in ("pantograph[1].file", "line[1].statics", "reference.cases"):
        assert f"dossier 'dossier.toml', key {key}" in text
    result = pantocheck("validate", copy_example(tmp_path, {"system": "none"}), "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert "there is no such system" in result.stderr


MEASURED = sorted(path.name for path in (EXAMPLE / "measured").iterdir())


@pytest.mark.parametrize("name", MEASURED)
def test_missing_document_ends_check_and_validation_before_any_run(tmp_path: Path, name: str) -> None:
    """Every measured table and every sidecar of the example, removed in turn."""
    path = copy_example(tmp_path / "in")
    (path.parent / "measured" / name).unlink()
    for result in (pantocheck("check", path), pantocheck("validate", path, "--out", tmp_path / "out")):
        assert result.exit_code == 2
        assert "dossier 'dossier.toml', key" in result.stderr
        assert name in result.stderr
    assert not (tmp_path / "out").exists()


def test_folder_or_document_outside_is_no_table(tmp_path: Path) -> None:
    path = copy_example(tmp_path / "in", {"line.0.statics": "../measured/statics.csv"})
    (path.parent / "measured").rename(tmp_path / "measured")
    (path.parent / "measured").symlink_to(tmp_path / "measured")
    with pytest.raises(InputError, match="is outside the folder of the dossier") as error:
        read_dossier(path)
    assert len(error.value.problems) == 6


@pytest.mark.parametrize("name", ["statics.csv", "statics.toml"])
def test_folder_in_place_of_a_table_is_refused(tmp_path: Path, name: str) -> None:
    """Also if the dossier names the sidecar, which names the table."""
    path = copy_example(tmp_path, {"line.0.statics": f"measured/{name}"})
    (tmp_path / "measured" / "statics.csv").unlink()
    (tmp_path / "measured" / "statics.csv").mkdir()
    with pytest.raises(InputError, match=r"line\[1\].statics.*(there is no|not a regular) file"):
        read_dossier(path)


@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("response-70N.csv", "pantograph[1].responses[1]"),
        ("statics.csv", "line[1].statics"),
        ("run-200.csv", "pair[2].measured.record"),
    ],
)
def test_check_reads_every_document(tmp_path: Path, name: str, key: str) -> None:
    """A table that is no table of its kind is an error of `check`; `validate` states it in its step."""
    path = copy_example(tmp_path)
    assert pantocheck("check", path).exit_code == 0
    (tmp_path / "measured" / name).write_text("no table\n", encoding="utf-8")
    result = pantocheck("check", path)
    assert result.exit_code == 2
    assert f"key {key}: record '{name}'" in result.stderr
    assert read_dossier(path).file.title


def test_digest_changes_with_every_file(tmp_path: Path) -> None:
    """Of a line, a case, a sidecar and the dossier; titles and notes of a line do not count."""
    path = copy_example(tmp_path)
    digests = [read_dossier(path).digest]
    for name, changes in {
        "line.toml": {"contact_wire.tension_N": 18.1e3},
        "run-160.toml": {"speed_km_h": 161.0},
        "measured/statics.toml": {"largest_distance_m": 5.1},
        "dossier.toml": {"title": "Other"},
    }.items():
        edit_toml(tmp_path / name, changes)
        digests.append(read_dossier(path).digest)
    assert len(set(digests)) == len(digests)
    edit_toml(tmp_path / "line.toml", {"title": "Other"})
    assert read_dossier(path).digest == digests[-1]


@pytest.mark.parametrize(
    ("changes", "exit_code", "word"),
    [
        ({}, 0, "PASS"),
        ({"line.0.tolerance.height_mm": 0.1}, 1, "FAIL"),
        ({"line.0.statics": None}, 1, "SKIP"),
        ({"required": ["static_check", "limits_of_validity"]}, 1, "SKIP"),
    ],
)
def test_exit_code_and_files(tmp_path: Path, changes: dict[str, Any], exit_code: int, word: str) -> None:
    """Dossier of a static check alone, which takes no simulation of a train."""
    short = {"required": ["static_check"], "pair": None, "reference": None, "validity": None, "line.0.element_m": 1.0}
    path = copy_example(tmp_path / "in", {"reference.cases": []} | short | changes)
    options = ("--formats", "json,md,badge,junit", "--report-number", "R 1")
    result = pantocheck("validate", path, "--out", tmp_path / "out", *options)
    assert (result.exit_code, result.stderr) == (exit_code, "")
    assert result.stdout.startswith(word)
    if word == "FAIL":
        assert "contact wire height" in result.stdout
        assert "above the upper limit" in result.stdout
    names = sorted(file.name for file in (tmp_path / "out").iterdir())
    assert names == ["badge.svg", "junit.xml", "results.json", "summary.md"]
    assert '"report_number": "R 1"' in (tmp_path / "out" / "results.json").read_text(encoding="utf-8")
