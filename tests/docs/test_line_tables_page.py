"""The page on line tables: its commands run, and its tables name every key and column."""

import shlex
from functools import partial
from pathlib import Path

import pytest
from typer.testing import CliRunner

from helpers.docs_pages import list_blocks, read_page
from helpers.line_table_files import change_cell, export_tables
from helpers.static_records import LINE_PATH, measure_line, read_unequal_line, write_static_record
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.comparison.static_comparison import CRITERIA
from pantocheck.conformance.comparison.static_record import COLUMN_UNITS, read_static_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.core.units import find_key_units
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_columns import DROPPER_COLUMNS, SUPPORT_COLUMNS
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line

PAGE = read_page("line-tables.md")
blocks = partial(list_blocks, "line-tables.md")


def command(name: str) -> list[str]:
    """Arguments of the first command of the page with this name."""
    line, *_ = (line for text in blocks("sh") for line in text.splitlines() if line.startswith(f"pantocheck {name} "))
    return shlex.split(line)[1:]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Working folder with the line of the page, and a table computed with its model."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mass-drop-line.toml").write_bytes(LINE_PATH.read_bytes())
    columns = measure_line()
    columns["position_m"] = columns["position_m"] + 1000
    columns["contact_wire_height_m"] = columns["contact_wire_height_m"] + 5.3
    write_static_record(tmp_path, columns)
    (tmp_path / "measured.toml").write_text(blocks("toml")[0])
    return tmp_path


def test_workbooks_of_the_page_give_the_same_line(folder: Path) -> None:
    (block,) = (text for text in blocks("sh") if "--formats xlsx" in text)
    for line in block.splitlines():
        done = CliRunner().invoke(app, shlex.split(line)[1:])
        assert done.exit_code == 0, done.output
    line = read_model(folder / "from-sheets.toml", LineFile, "line")
    assert build_catenary(line) == build_catenary(read_unequal_line())


def test_export_and_import_give_the_same_line_and_overwrite_no_input(folder: Path) -> None:
    for name in ("line export", "line import"):
        done = CliRunner().invoke(app, command(name))
        assert done.exit_code == 0, done.output
    line = read_model(folder / "my-line.toml", LineFile, "line")
    assert build_catenary(line) == build_catenary(read_unequal_line())
    done = CliRunner().invoke(app, ["check", "my-line.toml"])
    assert done.exit_code == 0, done.output
    CliRunner().invoke(app, command("line export"))
    arguments = ["mass-drop-line.toml" if text == "my-line.toml" else text for text in command("line import")]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 2
    assert "is a file of the import" in done.output
    assert (folder / "mass-drop-line.toml").read_bytes() == LINE_PATH.read_bytes()


def test_tables_of_the_page_are_a_line(folder: Path) -> None:
    for name in ("number", "span"):
        (folder / f"{name}.csv").write_text(next(text for text in blocks("") if text.startswith(f"{name};")))
    tree = import_line(folder / "mass-drop-line.toml", folder / "number.csv", folder / "span.csv")
    line = LineFile.model_validate(tree)
    assert line.geometry.span_lengths == (63.0, 63.0, 58.5, 63.0)
    assert [limit.contact_wire_stagger for limit in line.layout.limits] == [0.0, -0.2, 0.2, -0.2, 0.0]
    assert line.steady_arm_at(line.layout.supports[1]).acts == "push"
    assert [len(schedule.x_m) for schedule in line.dropper_schedules] == [3, 2, 2, 1]
    assert line.dropper_schedules[0].presag_m == (0.0, 0.02, 0.0)


def test_message_of_the_page_is_the_one_that_is_printed(folder: Path) -> None:
    supports, droppers = export_tables(folder, read_unequal_line())
    change_cell(supports, 4, "encumbrance_m", "-1")
    with pytest.raises(InputError) as caught:
        import_line(LINE_PATH, supports, droppers)
    (message,) = (text for text in blocks("") if text.startswith("table "))
    assert str(caught.value).splitlines()[0] == message.strip()


def test_comparison_passes_and_is_informative_without_a_tolerance(folder: Path) -> None:
    done = CliRunner().invoke(app, command("line statics"))
    assert done.exit_code == 0, done.output
    assert {path.name for path in (folder / "statics").iterdir()} == {
        "static_comparison.json", "static_comparison.html", "static_comparison.pdf", "elasticity.csv",
        "contact_wire_height.csv",
    }  # fmt: skip
    assert "PASS" in done.output
    done = CliRunner().invoke(app, command("line statics")[:-2])
    assert done.exit_code == 3, done.output
    assert "INFO" in done.output


def test_excerpt_of_the_table_is_that_of_the_line(folder: Path) -> None:
    """The first rows of the page, to the four decimals that it shows."""
    (folder / "excerpt.csv").write_text(next(text for text in blocks("") if text.startswith("position_m")))
    (folder / "excerpt.toml").write_text(blocks("toml")[0].replace("measured.csv", "excerpt.csv"))
    geometry = read_unequal_line().geometry
    shown, full = (read_static_record(folder / f"{name}.csv", geometry) for name in ("excerpt", "measured"))
    for name, values in shown.values.items():
        scale = 1e3 if name == "elasticity" else 1.0
        assert scale * values == pytest.approx(scale * full.values[name][:3], abs=0.51e-4)


def test_page_names_every_column_and_criterion() -> None:
    for stem, unit in COLUMN_UNITS.items():
        for other in find_key_units(unit):
            assert f"`{stem}_{other}`" in PAGE or f"`_{other}`" in PAGE
    for name in (*SUPPORT_COLUMNS, *DROPPER_COLUMNS, *CRITERIA):
        assert f"`{name}`" in PAGE
