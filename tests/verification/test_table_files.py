"""Tables of the documentation: every file has a program, and every page shows files that exist."""

import csv
import importlib.util
import re
from pathlib import Path

import pytest

from verification.tables.__main__ import PROGRAMS, TABLES, read_tables, write_tables

DOCS = Path(__file__).parents[2] / "docs"
OUTPUT = "first\n\n| a | b |\n| :-- | --: |\n| x | 1 |\n\ntext\n\n| a | b |\n|---|--:|\n| y | 2 |\n"


def test_every_table_has_a_program_is_shown_and_has_whole_rows() -> None:
    files = [name for program in PROGRAMS.values() for name in program.files]
    text = "\n".join(page.read_text("utf-8") for page in DOCS.glob("*.md"))
    shown = re.findall(r"^:file: tables/(.+)\.csv$", text, re.MULTILINE)
    assert sorted(files) == sorted(shown) == sorted(path.stem for path in TABLES.iterdir())
    modules = {f"verification.{program.module}" for program in PROGRAMS.values()}
    assert [module for module in modules if importlib.util.find_spec(module) is None] == []
    for path in TABLES.iterdir():
        with path.open(encoding="utf-8", newline="") as file:
            assert len({len(row) for row in csv.reader(file)}) == 1, path.name


def test_output_is_written_as_one_table_or_as_several(tmp_path: Path) -> None:
    assert read_tables(OUTPUT) == [[["a", "b"], ["x", "1"]], [["a", "b"], ["y", "2"]]]
    write_tables(OUTPUT, ["first", "second"], tmp_path)
    assert (tmp_path / "second.csv").read_text() == "a,b\ny,2\n"
    write_tables(OUTPUT, ["whole"], tmp_path)
    assert (tmp_path / "whole.csv").read_text() == "a,b\nx,1\ny,2\n"
    with pytest.raises(ValueError, match="2 tables in place of 3"):
        write_tables(OUTPUT, ["a", "b", "c"], tmp_path)
