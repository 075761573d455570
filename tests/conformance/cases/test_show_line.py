"""`pantocheck show`: the line at rest, and its drawing."""

import json
from pathlib import Path

import pytest

from helpers.command_line import pantocheck
from helpers.listed_spans import list_spans
from helpers.toml_edit import write_toml
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.runs.command_system import build_case_message


@pytest.mark.parametrize("suffix", ["svg", "pdf"])
def test_drawing_of_the_whole_line_is_written(tmp_path: Path, suffix: str) -> None:
    file = tmp_path / f"line.{suffix}"
    result = pantocheck("line", "draw", "vovan2015/mass-drop/printed", "--out", file)
    assert result.exit_code == 0, result.output
    assert file.read_bytes().startswith({"svg": b"<svg", "pdf": b"%PDF"}[suffix])


def test_drawing_in_another_format_or_of_several_lines_is_refused(tmp_path: Path) -> None:
    result = pantocheck("line", "draw", "en50318-2002/250", "--out", tmp_path / "line.png")
    assert result.exit_code == 2
    assert "format '.png' cannot be written" in result.output
    assert "Write .svg or .pdf." in result.output
    # The lines have files of the same name in different folders.
    file = tmp_path / "line.svg"
    result = pantocheck("line", "draw", "en50318-2018/*/static", "--out", file)
    assert result.exit_code == 2
    assert "the cases have different lines" in result.output
    assert not file.exists()


def test_line_is_drawn_without_a_case(tmp_path: Path) -> None:
    line = library_folder() / "en50318-2002" / "line.toml"
    alone, of_case = tmp_path / "alone.svg", tmp_path / "case.svg"
    result = pantocheck("line", "draw", line, "--out", alone)
    assert result.exit_code == 0, result.output
    assert result.output.strip().endswith("alone.svg")
    pantocheck("line", "draw", "en50318-2002/250", "--out", of_case)
    assert alone.read_bytes() == of_case.read_bytes()
    result = pantocheck("show", line, "--at-rest")
    assert result.exit_code == 2
    assert "is a line, not a case" in result.output


@pytest.mark.parametrize("command", [["show"], ["run"], ["simulate", "--out", "a.csv"]])
@pytest.mark.parametrize("kind", ["line", "pantograph"])
def test_file_of_another_kind_is_named_in_the_place_of_a_case(kind: str, command: list[str]) -> None:
    path = library_folder() / "en50318-2002" / f"{kind}.toml"
    result = pantocheck(*command, path, COLUMNS="200")
    assert result.exit_code == 2
    assert f"file '{kind}.toml': is a {kind}, not a case." in result.output
    assert f"pantocheck new case my-case.toml --{kind} {kind}.toml" in result.output
    assert "unknown key" not in result.output


def test_line_at_rest_and_apparent_mass_are_printed() -> None:
    result = pantocheck("show", "en50318-2002/250", "--at-rest")
    assert result.exit_code == 0, result.output
    for text in (
        "dropper_length_bending_m",
        "Elasticity along the span",
        "Apparent mass at the head",
        "doppler_factor",
    ):
        assert text in result.output
    assert "en50318-2002/300" not in result.output
    assert "Largest elasticity of every span" not in result.output


def test_elasticity_of_every_listed_span_is_printed(tmp_path: Path) -> None:
    tables = list_spans(read_toml(library_folder() / "en50318-2002" / "line.toml", "line"))
    tables["geometry"]["span_list"] = [{"length_m": length} for length in (60.0, 57.5, 60.0)]
    write_toml(tmp_path / "line.toml", tables)
    file = write_toml(tmp_path / "case.toml", {"id": "own", "title": "own", "line": "line.toml"})
    result = pantocheck("show", file, "--at-rest", COLUMNS="150")
    assert result.exit_code == 0, result.output
    table = result.output.split("Largest elasticity of every span")[1]
    assert [row.split()[:2] for row in table.splitlines()[2:5]] == [["1", "60"], ["2", "57.5"], ["3", "60"]]


def test_listed_spans_and_supports_are_printed_line_by_line(tmp_path: Path) -> None:
    """Equal neighbours share a line; no Python table is printed."""
    tables = list_spans(read_toml(library_folder() / "en50318-2002" / "line.toml", "line"))
    short = {"length_m": 54.0, "droppers": {"x_m": [9.0, 45.0]}}
    tables["geometry"]["span_list"] = [{"length_m": 60.0}] * 3 + [short, {"length_m": 60.0}]
    tables["geometry"]["support"] = [{"number": 2, "encumbrance_m": 1.1, "steady_arm": {"length_m": 0.9}}]
    write_toml(tmp_path / "line.toml", tables)
    file = write_toml(tmp_path / "case.toml", {"id": "own", "title": "own", "line": "line.toml"})
    result = pantocheck("show", file, COLUMNS="150")
    assert result.exit_code == 0, result.output
    lines = [" ".join(line.split()) for line in result.output.splitlines()]
    first = next(i for i, line in enumerate(lines) if line.startswith("span_list"))
    assert lines[first].startswith("span_list 1-3: length_m = 60.0")
    further = ["4: length_m = 54.0, droppers = { x_m = [9.0, 45.0] }", "5: length_m = 60.0"]
    assert lines[first + 1 : first + 3] == further
    assert any("1: number = 2, encumbrance_m = 1.1, steady_arm = { length_m = 0.9 }" in line for line in lines)


def test_derived_values_are_printed_with_their_meaning() -> None:
    """Lists by span show the middle span; long lists show their ends."""
    result = pantocheck("show", "en50318-2002/250", "--derived", COLUMNS="250")
    assert result.exit_code == 0, result.output
    rows = {line.split()[0]: " ".join(line.split()) for line in result.output.splitlines() if line.strip()}
    assert rows["contact_wire.wave_speed_m_s"].startswith("contact_wire.wave_speed_m_s 121.716 speed of transverse")
    assert rows["droppers.position_m"].startswith("droppers.position_m 305.0, 310.5,")
    assert rows["start.place_m"].startswith("start.place_m 60.0 position of the last pantograph at the start")
    assert "242.5, 245.0, ... 24 values ..., 295.0" in rows["working_height_positions_m"]
    assert rows["evaluation.bands_Hz"].startswith("evaluation.bands_Hz 0.0, 5.0; 5.0, 20.0; 20.0, 50.0 ")


def test_request_is_the_one_case_that_a_program_receives(tmp_path: Path) -> None:
    file = tmp_path / "case.json"
    result = pantocheck("show", "en50318-2002/250", "--request", file)
    assert result.exit_code == 0, result.output
    (case,) = select_cases(["en50318-2002/250"])
    assert json.loads(file.read_text()) == build_case_message(case)
    result = pantocheck("show", "en50318-2002/*", "--request", tmp_path / "case.json")
    assert result.exit_code == 2
    assert "the pattern selects 2 cases" in " ".join(result.output.split())


def test_required_case_is_named_and_not_shown() -> None:
    result = pantocheck("show", "en50318-2018/ac-simple/275", "--json")
    assert result.exit_code == 0
    (case,) = json.loads(result.stdout)["result"]
    assert (case["id"], case["requires"]) == ("en50318-2018/ac-simple/275", ["en50318-2018/ac-simple/static"])
